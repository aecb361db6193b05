"""Anything may be thrown at the readers: they answer with faults, in time, and what they accept keeps its meaning.

FUZZ_FACTOR=30 python -m pytest tests/fuzz    looks longer, and elsewhere each time. What was found once stays in found/ and in the tables.
"""
