"""The words of a script, each with its position."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, Literal

TokenKind = Literal["integer", "real", "boolean", "text", "name", "sign", "end"]

INT64_MAX: Final = 2**63 - 1
_BLANKS = re.compile(r"[ \t\r\n]*")
_WORD = re.compile(r"[A-Za-z_@][A-Za-z0-9_]*")
_HEX = re.compile(r"0[xX][0-9a-fA-F]+")
_NUMBER = re.compile(r"\d+(\.\d+)?([eE][+-]?\d+)?", re.ASCII)
_GARBAGE = re.compile(r"[A-Za-z0-9_@.]*")
_SIGN = re.compile(r"\.\.|&&|\|\||==|!=|<=|>=|:=|\+=|-=|\*=|/=|[-+*/&|^~!<>=?:();]")


class ScriptSyntaxError(ValueError):
    """A script that cannot be read; `position` counts characters from 0."""

    def __init__(self, position: int, message: str, expected: str = "", found: str = "") -> None:
        self.position, self.message, self.expected, self.found = position, message, expected, found
        super().__init__(f"{message} at character {position + 1}")


@dataclass(frozen=True, slots=True)
class Token:
    """One word; `text` is without quotes for texts."""

    kind: TokenKind
    text: str
    position: int

    def shown(self) -> str:
        """For the "found" of a fault."""
        return "the end of the script" if self.kind == "end" else f"'{self.text}'" if self.kind == "text" else self.text


def tokens_of(script: str) -> list[Token]:
    """All tokens, with an end token last. Raises ScriptSyntaxError."""
    tokens: list[Token] = []
    at = _skip_blanks(script, 0)
    while at < len(script):
        token, at = _token(script, at)
        tokens.append(token)
        at = _skip_blanks(script, at)
    tokens.append(Token("end", "", len(script)))
    return tokens


def _skip_blanks(script: str, at: int) -> int:
    blanks = _BLANKS.match(script, at)
    return blanks.end() if blanks else at


def _token(script: str, at: int) -> tuple[Token, int]:
    first = script[at]
    if first == "'":
        end = script.find("'", at + 1)
        if end < 0:
            raise ScriptSyntaxError(at, "a text is never closed", expected="'", found="the end of the script")
        return Token("text", script[at + 1 : end], at), end + 1
    if first in "0123456789":
        return _number(script, at)
    if word := _WORD.match(script, at):
        return Token("boolean" if word[0] in ("true", "false") else "name", word[0], at), word.end()
    if sign := _SIGN.match(script, at):
        return Token("sign", sign[0], at), sign.end()
    mend = "write a text in single quotes" if first == '"' else ""
    raise ScriptSyntaxError(at, f"unexpected character {first!r}", expected=mend or "a name, a number, a 'text' or an operator", found=first)


def _number(script: str, at: int) -> tuple[Token, int]:
    found = _HEX.match(script, at) or _NUMBER.match(script, at)
    assert found is not None  # the caller saw a digit
    end = found.end()
    is_concat = script.startswith("..", end)  # "65..x" joins; "65." and "65.x" are no numbers
    if end < len(script) and not is_concat and (script[end] == "." or _WORD.match(script, end)):
        rest = _GARBAGE.match(script, end)
        word = script[at : rest.end() if rest else end]
        raise ScriptSyntaxError(at, f"{word!r} is no number", expected="digits, like 12, 0x1F, 1.5 or 1e3", found=word)
    if found.re is _HEX or (found[1] is None and found[2] is None):
        if end - at > 20 or int(found[0], 0 if found.re is _HEX else 10) > INT64_MAX:
            raise ScriptSyntaxError(at, "the number is too large", expected=f"at most {INT64_MAX}", found=found[0][:40])
        return Token("integer", found[0], at), end
    return Token("real", found[0], at), end
