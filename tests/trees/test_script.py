"""The script language of bt_xml.md, section 9."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.trees.scopes import Board
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.script.parser import KEPT_CHARACTERS
from pluto_bt.trees.script.terms import Env
from pluto_bt.trees.script.values import ScriptError

ENUMS = {"RED": 1, "GREEN": 2}


def run(text: str, **entries: Any) -> tuple[Any, dict[str, Any]]:
    """The value of a script, and the entries afterwards."""
    board = Board()
    for key, value in entries.items():
        board.root.declare(key, None).put(value)  # as scripts themselves make them: open
    value = parse_script(text).run(Env(board.root, ENUMS))
    return value, {key: entry.value for key, entry in board.root.entries.items()}


VALUES = [
    ("1", 1), ("0x1F", 31), ("1.5", 1.5), ("1e3", 1000.0), ("1.5e-2", 0.015), ("true", 1.0), ("false", 0.0), ("'a b'", "a b"),
    ("1 + 2 * 3", 7.0), ("(1 + 2) * 3", 9.0), ("10 - 2 - 3", 5.0), ("7 / 2", 3.5), ("1 / 0", math.inf), ("-1 / 0", -math.inf), ("-2 * -3", 6.0),
    ("6 & 3", 2.0), ("6 | 3", 7.0), ("6 ^ 3", 5.0), ("~0", -1.0), ("!0", 1.0), ("!2", 0.0), ("1 | 2 & 2", 3.0), ("1 + 1 & 2", 2.0),
    ("4 & 6 == 4", 1.0), ("1 < 2", 1.0), ("2 <= 1", 0.0), ("1 < 2 < 3", 1.0), ("1 < 3 < 2", 0.0), ("3 > 2 > 1", 1.0), ("1 != 2", 1.0),
    ("0.1 + 0.2 == 0.3", 1.0), ("1 == 1.0000001", 1.0), ("1 == 1.000001", 0.0),
    ("'a' < 'b'", 1.0), ("'Z' < 'a'", 1.0), ("'1' == 1", 1.0), ("'true' == 1", 1.0), ("'RED' == 1", 1.0), ("RED == 1", 1.0), ("GREEN + RED", 3.0),
    ("1 && 0", 0.0), ("1 || 0", 1.0), ("0.5 && 1", 1.0), ("1 == 1 && 2 == 2", 1.0), ("0 && 0 || 1", 1.0),
    ("1 ? 2 : 3", 2), ("0 ? 2 : 3", 3), ("0 ? 1 : 0 ? 2 : 3", 3), ("1 < 2 ? 'yes' : 'no'", "yes"),
    ("'a' + 'b'", "ab"), ("'a' .. 'b'", "ab"), ("'a' .. 1", "a1"), ("1 .. 'a'", "1a"), ("'a' .. 1.5", "a1.500000"), ("65..'a'", "65a"),
    ("1; 2; 3", 3), ("1 2 3", 3), ("1;;2;", 2), ("1\n2", 2), ("  1", 1),
]  # fmt: skip


@pytest.mark.parametrize(("text", "value"), VALUES)
def test_value(text: str, value: Any) -> None:
    found, _ = run(text)
    assert found == value and type(found) is type(value)


ASSIGNMENTS = [
    # entries before      script                  entries after
    ({}, "x := 5", {"x": 5}),
    ({}, "x := 5.0", {"x": 5.0}),
    ({}, "x := 2 + 3", {"x": 5.0}),
    ({}, "x := 'a'", {"x": "a"}),
    ({}, "a := b := 1", {"b": 1, "a": 1}),
    ({}, "x := true", {"x": 1.0}),
    ({"x": 1}, "x = 7", {"x": 7}),
    ({"x": 1}, "x = 7.0", {"x": 7}),
    ({"x": 1.5}, "x = 7", {"x": 7.0}),
    ({"x": 5}, "x += 2", {"x": 7}),
    ({"x": 5}, "x -= 2", {"x": 3}),
    ({"x": 5}, "x *= 2", {"x": 10}),
    ({"x": 6}, "x /= 2", {"x": 3}),
    ({"x": 5.0}, "x /= 2", {"x": 2.5}),
    ({"x": "a"}, "x += 'b'", {"x": "ab"}),
    ({"x": "a"}, "x = 'b'", {"x": "b"}),
    ({"x": 5}, "x = '7'", {"x": 7.0}),
    ({"x": 5}, "x := '7.5'", {"x": 7.5}),
    ({}, "x := 1; x > 0 ? (y := 2) : (z := 3)", {"x": 1, "y": 2}),
]


@pytest.mark.parametrize(("before", "text", "after"), ASSIGNMENTS)
def test_assignment(before: dict[str, Any], text: str, after: dict[str, Any]) -> None:
    _, entries = run(text, **before)
    assert {key: (value, type(value)) for key, value in entries.items()} == {key: (value, type(value)) for key, value in after.items()}


FAILURES = [
    # entries        script                 what it says
    ({}, "x", "unknown name 'x'"),
    ({}, "1 || x", "unknown name 'x'"),
    ({}, "0 && x", "unknown name 'x'"),
    ({}, "x = 1", "entry 'x' does not exist; ':=' would create it"),
    ({}, "x += 1", "entry 'x' does not exist; ':=' would create it"),
    ({}, "'a' + 1", "'+' cannot be used between text 'a' and number 1"),
    ({}, "1 .. 2", "'..' joins texts, not number 1 and number 2"),
    ({}, "1.5 & 1", "'&' needs whole numbers, not number 1.5"),
    ({}, "!'a'", "'!' needs a number, not text 'a'"),
    ({}, "2 && 1", "the left side of '&&' is number 2: expected true or false (0 or 1)"),
    ({}, "'abc' == 1", "text 'abc' is no number"),
    ({}, "9007199254740993 + 1", "left of '+': 9007199254740993 is too large to be exact"),
    ({"x": 5}, "x /= 2", "'x' holds whole numbers and cannot take number 2.5"),
    ({"x": 5}, "x := 5.5", "'x' holds whole numbers and cannot take number 5.5"),
    ({"x": "a"}, "x := 1", "'x' is text 'a' and cannot take number 1"),
    ({"x": "a"}, "x -= 'a'", "'-=' cannot be used between text 'a' and text 'a'"),
    ({"x": 5}, "x = 'abc'", "text 'abc' is no number"),
    ({"x": [1]}, "x + 1", "'+' cannot be used between a list and number 1"),
]


@pytest.mark.parametrize(("before", "text", "message"), FAILURES)
def test_failure_while_running(before: dict[str, Any], text: str, message: str) -> None:
    with pytest.raises(ScriptError) as caught:
        run(text, **before)
    assert str(caught.value) == message


SYNTAX = [
    # script         position  what it says
    ("1 +", 3, "an operand is missing"),
    (" ", 0, "the script is blank"),
    ("; 1", 0, "a script cannot begin with ';'"),
    ("1 % 2", 2, "unexpected character '%'"),
    ('x == "a"', 5, "unexpected character '\"'"),
    ("'abc", 0, "a text is never closed"),
    ("1.", 0, "'1.' is no number"),
    ("3foo", 0, "'3foo' is no number"),
    ("0x", 0, "'0x' is no number"),
    ("1e", 0, "'1e' is no number"),
    (".5", 0, "unexpected character '.'"),
    ("(1 + 2", 6, "')' is missing"),
    ("1 ? 2", 5, "':' is missing"),
    ("1 := 2", 0, "only an entry can stand left of ':='"),
    ("a.b", 1, "unexpected character '.'"),
    ("99999999999999999999", 0, "the number is too large"),
    ("(" * 500 + "1" + ")" * 500, 51, "the script is nested too deeply"),
    ("-" * 5000 + "1", 51, "the script is nested too deeply"),
]


@pytest.mark.parametrize(("text", "position", "message"), SYNTAX)
def test_syntax_error(text: str, position: int, message: str) -> None:
    with pytest.raises(ScriptSyntaxError) as caught:
        parse_script(text)
    assert (caught.value.position, caught.value.message) == (position, message)


def test_an_empty_script_does_nothing() -> None:
    assert run("") == (None, {})


def test_a_very_long_chain_is_no_deep_recursion() -> None:
    assert run("+".join(["1"] * 9_999))[0] == 9_999.0


@given(st.text(alphabet="ab1.=:+-*/&|^~!<>?() ;'\n@_x0", max_size=40))
def test_any_text_is_either_read_or_refused_with_a_position(text: str) -> None:
    try:
        program = parse_script(text)
    except ScriptSyntaxError as error:
        assert 0 <= error.position <= len(text)
        return
    try:
        program.run(Env(Board().root, ENUMS))
    except ScriptError as error:
        assert str(error)


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6).filter(bool), st.sampled_from("+-*/"))
def test_arithmetic_is_that_of_doubles(a: float, b: float, sign: str) -> None:
    expected = {"+": a + b, "-": a - b, "*": a * b, "/": a / b}[sign]
    assert run(f"x {sign} y", x=a, y=b)[0] == expected


@pytest.mark.parametrize(("characters", "is_kept"), [(KEPT_CHARACTERS, True), (KEPT_CHARACTERS + 1, False)])
def test_short_scripts_are_read_once_and_long_ones_are_not_kept(characters: int, is_kept: bool) -> None:
    text = "a := 1; b := 2".ljust(characters)
    assert (parse_script(text) is parse_script(text)) == is_kept
