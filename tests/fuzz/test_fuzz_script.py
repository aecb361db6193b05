"""The script language: any text is a program or a fault with a place; any program runs or says why not."""

from __future__ import annotations

import contextlib
import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pluto_bt.trees.scopes import Board, Scope
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.script.names import names_used
from pluto_bt.trees.script.terms import Env
from pluto_bt.trees.script.values import ScriptError
from pluto_bt.trees.values import PortProblem
from tests.fuzz.effort import effort

PIECES = [
    "a", "b", "@c", "_d", "RED", "1", "0", "2.5", "1e3", "0x1F", "9223372036854775807", "'t'", "''", "true", "false", ":=", "=", "+=", "-=", "*=",
    "/=",
    "+", "-", "*", "/", "..", "&", "|", "^", "~", "!", "&&", "||", "==", "!=", "<", "<=", ">", ">=", "?", ":", "(", ")", ";", " ", "\n", "'", ".",
    "%",
]  # fmt: skip
WORDS = st.sampled_from(PIECES)
CORPUS = ["a := 1; b = a * 2", "a < b <= 3 && !_d", "_d ? 'x' .. @c : a", "a += 0x1F & ~2 | 1 ^ b", "c == 't' || RED != 1.5e3"]


def scope() -> Scope:
    board = Board()
    for key, value in (("a", 1), ("b", 2.5), ("c", "text"), ("_d", True)):
        board.root.write(key, value)
    return board.root


@given(st.one_of(st.lists(WORDS, max_size=14).map(" ".join), st.lists(WORDS, max_size=14).map("".join), st.text(max_size=30)))
@example("a?b:c?d:1")
@example("1e400")
@example("a := ~b")
@example("-9223372036854775807 * 9223372036854775807")
@effort(800)
def test_any_text_is_a_program_or_a_fault_with_a_place(text: str) -> None:
    survives(text)


def survives(text: str) -> None:
    """Read and run: a value, or one of the errors that are promised."""
    try:
        program = parse_script(text)
    except ScriptSyntaxError as error:
        assert 0 <= error.position <= len(text) and error.message
        return
    uses = names_used(text)
    assert all(text[use.position :].startswith(use.name) for use in uses)
    with contextlib.suppress(ScriptError, PortProblem):
        value = program.run(Env(scope(), {"RED": 1}))
        assert value is None or isinstance(value, (int, float, str, bool))


@given(st.lists(st.tuples(st.sampled_from(["+", "-", "*", "/", "<", "==", "&&"]), st.integers(0, 9)), max_size=6), st.integers(0, 9))
@effort(200)
def test_numbers_come_out_as_python_reckons_them(rest: list[tuple[str, int]], first: int) -> None:
    """Chains of arithmetic alone, where both languages agree."""
    rest = [(sign, number) for sign, number in rest if sign in "+-*"]
    text = str(first) + "".join(f" {sign} {number}" for sign, number in rest)
    value = parse_script(text).run(Env(scope(), {}))
    assert math.isclose(value, eval(text))  # the text is made of digits and + - *


@pytest.mark.parametrize("text", ["(" * 5000, "-" * 5000 + "1", "a := " * 5000 + "1", "1 ? " * 5000, "!(" * 3000, "1;" * 20_000, "x" * 90_000])
def test_long_and_deep_scripts_end(text: str) -> None:
    with contextlib.suppress(ScriptSyntaxError):
        names_used(text)
