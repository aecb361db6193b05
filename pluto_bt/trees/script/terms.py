"""The terms that a script is made of; each knows how to give its value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.script.values import ScriptError, assign, combine, compare, is_number, number, number_of_text, shown, update


class Env(NamedTuple):
    """Where names are looked up: enums first, then the blackboard scope."""

    scope: Scope
    enums: Mapping[str, int]


class Term(Protocol):
    """Anything that has a value."""

    def value(self, env: Env) -> Any:
        """The value here and now; raises ScriptError."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A number or a text."""

    content: int | float | str

    def value(self, env: Env) -> Any:
        """Itself."""
        return self.content


@dataclass(frozen=True, slots=True)
class Name:
    """An enum, else an entry."""

    name: str
    position: int

    def value(self, env: Env) -> Any:
        """The entry's value, EMPTY if it was declared but never written."""
        if self.name in env.enums:
            return float(env.enums[self.name])
        entry = env.scope.find(self.name)
        if entry is None:
            raise ScriptError(f"unknown name {self.name!r}")
        return entry.value


@dataclass(frozen=True, slots=True)
class Unary:
    """`-x`, `~x`, `!x`."""

    sign: str
    operand: Term

    def value(self, env: Env) -> Any:
        """A double."""
        value = self.operand.value(env)
        if value is EMPTY or not is_number(value):
            raise ScriptError(f"'{self.sign}' needs a number, not {'an entry without value' if value is EMPTY else shown(value)}")
        real = number(value, f"right of '{self.sign}'")
        if self.sign == "-":
            return -real
        if self.sign == "!":
            return float(not real)
        if not -(2.0**63) <= real <= 2.0**63:
            raise ScriptError("'~' needs a number of 64 bits")
        return float(~int(real))


@dataclass(frozen=True, slots=True)
class Chain:
    """`a + b - c …`: operators of one precedence, from left to right."""

    first: Term
    rest: tuple[tuple[str, Term], ...]

    def value(self, env: Env) -> Any:
        """Both sides of every operator are always evaluated, also of && and ||."""
        value = self.first.value(env)
        for sign, term in self.rest:
            value = combine(sign, value, term.value(env))
        return value


@dataclass(frozen=True, slots=True)
class Comparison:
    """`a < b <= c …`: true if each neighbouring pair holds; stops at the first that does not."""

    first: Term
    rest: tuple[tuple[str, Term], ...]

    def value(self, env: Env) -> Any:
        """1.0 or 0.0."""
        left = self.first.value(env)
        for sign, term in self.rest:
            right = term.value(env)
            if not compare(sign, left, right, env.enums):
                return 0.0
            left = right
        return 1.0


@dataclass(frozen=True, slots=True)
class Choice:
    """`condition ? then : otherwise`; only the chosen branch is evaluated."""

    condition: Term
    then: Term
    otherwise: Term

    def value(self, env: Env) -> Any:
        """The value of the branch."""
        value = self.condition.value(env)
        if value is EMPTY or not (is_number(value) or isinstance(value, str)):
            raise ScriptError("the condition of '?' is no number")
        real = number_of_text(value, {}) if isinstance(value, str) else number(value, "the condition of '?'")
        return (self.then if real != 0.0 else self.otherwise).value(env)


@dataclass(frozen=True, slots=True)
class Assignment:
    """`name := x` creates or assigns; `=` and the others need an entry."""

    target: Name
    sign: str
    right: Term

    def value(self, env: Env) -> Any:
        """The value that the entry has afterwards."""
        key = self.target.name
        entry = env.scope.find(key)
        if entry is None:
            if self.sign != ":=":
                raise ScriptError(f"entry {key!r} does not exist; ':=' would create it")
            entry = env.scope.declare(key, None)
        value = self.right.value(env)
        return assign(key, entry, value, env.enums) if self.sign in (":=", "=") else update(key, entry, self.sign, value)
