"""Which entries a script reads and writes, in the order in which it does so; found without running it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

from pluto_bt.trees.script.parser import parse_script
from pluto_bt.trees.script.terms import Assignment, Chain, Choice, Comparison, Name, Term, Unary

How = Literal["read", "write", "change"]


class NameUse(NamedTuple):
    """One use of a name. `change` is an assignment that needs an entry which is there already (`=`, `+=`, …)."""

    name: str
    position: int
    how: How


def names_used(text: str) -> tuple[NameUse, ...]:
    """All uses in a script; both branches of `?:` count as run. Raises ScriptSyntaxError."""
    return tuple(use for statement in parse_script(text).statements for use in uses_of(statement))


def uses_of(term: Term) -> Iterator[NameUse]:
    """All uses in one term."""
    if isinstance(term, Name):
        yield NameUse(term.name, term.position, "read")
    elif isinstance(term, Unary):
        yield from uses_of(term.operand)
    elif isinstance(term, (Chain, Comparison)):
        yield from uses_of(term.first)
        for _, right in term.rest:
            yield from uses_of(right)
    elif isinstance(term, Choice):
        for part in (term.condition, term.then, term.otherwise):
            yield from uses_of(part)
    elif isinstance(term, Assignment):
        yield from _assigned(term)


def _assigned(term: Assignment) -> Iterator[NameUse]:
    name, position = term.target.name, term.target.position
    if term.sign not in (":=", "="):
        yield NameUse(name, position, "read")
    yield from uses_of(term.right)
    yield NameUse(name, position, "write" if term.sign == ":=" else "change")
