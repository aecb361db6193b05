"""Reads a script into terms.

    script      = [ statement { ";" | statement } ]
    statement   = conditional [ (":=" | "=" | "+=" | "-=" | "*=" | "/=") statement ]
    conditional = or [ "?" statement ":" conditional ]
    or → and → comparison → "| ^" → "&" → "+ - .." → "* /" → "- ~ !" → atom
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final

from pluto_bt.trees.script.terms import Assignment, Chain, Choice, Comparison, Env, Literal, Name, Term, Unary
from pluto_bt.trees.script.tokens import ScriptSyntaxError, Token, tokens_of

MAX_DEPTH: Final = 50
MAX_CHARACTERS: Final = 100_000
KEPT_CHARACTERS: Final = 1000
ASSIGNMENTS: Final = (":=", "=", "+=", "-=", "*=", "/=")
COMPARISONS: Final = ("==", "!=", "<", ">", "<=", ">=")
LEVELS: Final = (("||",), ("&&",), COMPARISONS, ("|", "^"), ("&",), ("+", "-", ".."), ("*", "/"))
LEVEL_OF: Final = {sign: level for level, signs in enumerate(LEVELS) for sign in signs}


@dataclass(frozen=True, slots=True)
class Program:
    """A script that was read; running it gives the value of its last statement (None for an empty script)."""

    text: str
    statements: tuple[Term, ...]

    def run(self, env: Env) -> Any:
        """Run all statements."""
        value: Any = None
        for statement in self.statements:
            value = statement.value(env)
        return value


def parse_script(text: str) -> Program:
    """The program of a script. Raises ScriptSyntaxError with the position."""
    return _kept(text) if len(text) <= KEPT_CHARACTERS else _program(text)


@lru_cache(maxsize=512)
def _kept(text: str) -> Program:
    """A program is fifty times as large as its text, and strangers may have theirs checked: only some short ones are kept."""
    return _program(text)


def _program(text: str) -> Program:
    if text == "":
        return Program(text, ())
    if len(text) > MAX_CHARACTERS:
        raise ScriptSyntaxError(MAX_CHARACTERS, "the script is too long", expected=f"at most {MAX_CHARACTERS} characters", found=str(len(text)))
    return Program(text, tuple(_Parser(text).script()))


class _Parser:
    """One reading: the tokens, and how far it has come."""

    def __init__(self, text: str) -> None:
        self._tokens = tokens_of(text)
        self._at = 0
        self._depth = 0

    def script(self) -> Iterator[Term]:
        first = self._tokens[0]
        if first.kind == "end":
            raise ScriptSyntaxError(0, "the script is blank", expected="a statement", found="blanks")
        if first.kind == "sign" and first.text == ";":
            raise ScriptSyntaxError(first.position, "a script cannot begin with ';'", expected="a statement", found=";")
        while self._now.kind != "end":
            yield self._statement()
            while self._take(";"):
                pass

    @property
    def _now(self) -> Token:
        return self._tokens[self._at]

    def _take(self, *signs: str) -> str:
        """The sign that stands here, taken, or ""."""
        token = self._now
        if token.kind == "sign" and token.text in signs:
            self._at += 1
            return token.text
        return ""

    def _need(self, sign: str) -> None:
        if not self._take(sign):
            raise ScriptSyntaxError(self._now.position, f"'{sign}' is missing", expected=sign, found=self._now.shown())

    def _deeper(self, read: Callable[[], Term]) -> Term:
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise ScriptSyntaxError(self._now.position, "the script is nested too deeply", expected=f"at most {MAX_DEPTH} levels")
        term = read()
        self._depth -= 1
        return term

    def _statement(self) -> Term:
        position = self._now.position
        left = self._conditional()
        sign = self._take(*ASSIGNMENTS)
        if not sign:
            return left
        if not isinstance(left, Name):
            raise ScriptSyntaxError(position, f"only an entry can stand left of '{sign}'", expected="a name")
        return Assignment(left, sign, self._deeper(self._statement))

    def _conditional(self) -> Term:
        condition = self._binary(0)
        if not self._take("?"):
            return condition
        then = self._deeper(self._statement)
        self._need(":")
        return Choice(condition, then, self._deeper(self._conditional))

    def _binary(self, lowest: int) -> Term:
        """Operators of level `lowest` and above, by precedence climbing; equal ones in a row make one chain."""
        left = self._prefix()
        while (level := LEVEL_OF.get(self._now.text, -1)) >= lowest and self._now.kind == "sign":
            rest: list[tuple[str, Term]] = []
            while sign := self._take(*LEVELS[level]):
                rest.append((sign, self._binary(level + 1)))
            left = Comparison(left, tuple(rest)) if LEVELS[level] is COMPARISONS else Chain(left, tuple(rest))
        return left

    def _prefix(self) -> Term:
        sign = self._take("-", "~", "!")
        return Unary(sign, self._deeper(self._prefix)) if sign else self._atom()

    def _atom(self) -> Term:
        token = self._now
        if self._take("("):
            inner = self._deeper(self._statement)
            self._need(")")
            return inner
        self._at += 1
        if token.kind == "integer":
            return Literal(int(token.text, 16) if token.text[:2] in ("0x", "0X") else int(token.text))
        if token.kind == "real":
            return Literal(float(token.text))
        if token.kind == "boolean":
            return Literal(1.0 if token.text == "true" else 0.0)
        if token.kind == "text":
            return Literal(token.text)
        if token.kind == "name":
            return Name(token.text, token.position)
        raise ScriptSyntaxError(token.position, "an operand is missing", expected="a name, a number, a 'text' or (", found=token.shown())
