"""Broken inputs as tables: what is wrong, and what must be told of it."""
