"""How port types read text and other values: bt_xml.md, section 3, and the points and lists that are ours."""

from __future__ import annotations

import math
from enum import Enum
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.behaviours.ports import text_of
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.values import BOOL, DOUBLE, INT, STRING, UINT, PortProblem, literal_value


class Colour(Enum):
    """An enum of a leaf."""

    RED = 1
    GREEN = 2


class Angle:
    """A class that reads its own text."""

    def __init__(self, degrees: float) -> None:
        self.degrees = degrees

    @classmethod
    def from_text(cls, text: str) -> Angle:
        """Degrees."""
        return cls(float({"north": "90"}[text]) if text == "north" else float(text))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Angle) and other.degrees == self.degrees

    __hash__ = None  # type: ignore[assignment]


TEXTS = [
    # type                         text            value
    (int, "12", 12), (int, "-3", -3), (int, "10abc", 10), (int, "0.9", 0),
    (float, "1.5", 1.5), (float, "1e3", 1000.0), (float, "2.5m", 2.5), (float, "-.5", -0.5), (float, "inf", math.inf),
    (bool, "1", True), (bool, "False", False),
    (str, " any ", " any "),
    (list[int], "1;2;3", [1, 2, 3]), (list[int], "1;2;", [1, 2]), (list[int], "", []), (list[float], "1;2.5", [1.0, 2.5]),
    (list[str], "a; b", ["a", " b"]), (list[bool], "true;0", [True, False]), (list[int], "json:[1, 2]", [1, 2]),
    (tuple[float, float], "1;2", (1.0, 2.0)), (tuple[float, float], " 1 , 2 ", (1.0, 2.0)),
    (tuple[float, float, float], "1;2;-90", (1.0, 2.0, -90.0)),
    (list[tuple[float, float]], "1,2;3,4", [(1.0, 2.0), (3.0, 4.0)]),
    (Colour, "RED", Colour.RED), (Colour, "2", Colour.GREEN),
    (Literal["left", "right"], "left", "left"),
    (int | None, "5", 5), (float | str, "x", "x"), (Angle, "45", Angle(45.0)), (Any, "x", "x"),
]  # fmt: skip


@pytest.mark.parametrize(("data_type", "text", "value"), TEXTS)
def test_text(data_type: Any, text: str, value: Any) -> None:
    found = kind_of_type(data_type).convert(text)
    assert found == value and type(found) is type(value)


BAD_TEXTS = [
    (int, "+5"), (int, " 5"), (int, ""), (int, "x"), (int, "99999999999"), (float, "nan"), (float, "1e999"), (float, ""), (bool, "yes"),
    (int, "１０"), (float, "４.５"), (tuple[float, float], "４;３.５"),
    (bool, " true"),
    (list[int], "1;;2"), (list[int], "1; 2"), (list[int], "json:" + "[" * 100_000), (tuple[float, float], "1"), (tuple[float, float], "1;2;3"),
    (tuple[float, float], "1;2m"), (list[tuple[float, float]], "1;2"), (Colour, "BLUE"), (Literal["left", "right"], "up"), (Angle, "north-west"),
    (dict, "{}"), (int | float, "x"),
]  # fmt: skip


@pytest.mark.parametrize(("data_type", "text"), BAD_TEXTS)
def test_text_that_does_not_fit(data_type: Any, text: str) -> None:
    with pytest.raises(PortProblem):
        kind_of_type(data_type).convert(text)


CASTS = [
    (INT, 2.0, 2), (INT, True, 1), (UINT, 3, 3), (DOUBLE, 2, 2.0), (BOOL, 1, True), (BOOL, 0.5, True), (STRING, 3, "3"), (STRING, 2.5, "2.500000"),
    (STRING, True, "true"), (kind_of_type(list[float]), (1, 2), [1.0, 2.0]), (kind_of_type(tuple[float, float]), [1, 2], (1.0, 2.0)),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "value", "cast"), CASTS)
def test_cast(kind: Any, value: Any, cast: Any) -> None:
    found = kind.convert(value)
    assert found == cast and type(found) is type(cast)


@pytest.mark.parametrize(
    ("kind", "value"),
    [(INT, 2.5), (INT, 2**31), (UINT, -1), (DOUBLE, 2**53 + 1), (BOOL, 2), (STRING, [1]), (INT, [1]), (INT, math.inf), (INT, math.nan)],
)
def test_a_value_that_does_not_fit(kind: Any, value: Any) -> None:
    with pytest.raises(PortProblem):
        kind.convert(value)


@pytest.mark.parametrize(
    ("text", "value"),
    [("7", 7), ("007", 7), ("-4", -4), ("1e3", 1000.0), ("2.50", 2.5), ("true", "true"), ("1;2", "1;2"), ("", ""), (" 1", " 1"), ("inf", "inf"),
     ("5000000000", 5_000_000_000)],
)  # fmt: skip
def test_literals_on_subtree_tags(text: str, value: Any) -> None:
    found = literal_value(text)
    assert found == value and type(found) is type(value)


POINTS = st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))


@given(st.one_of(st.tuples(st.just(list[tuple[float, float]]), st.lists(POINTS, max_size=5)),
                 st.tuples(st.just(tuple[float, float]), POINTS),
                 st.tuples(st.just(list[int]), st.lists(st.integers(-(2**31), 2**31 - 1), max_size=5)),
                 st.tuples(st.just(bool), st.booleans())))  # fmt: skip
def test_a_value_written_as_text_reads_back(pair: tuple[Any, Any]) -> None:
    data_type, value = pair
    assert kind_of_type(data_type).convert(text_of(value)) == value
