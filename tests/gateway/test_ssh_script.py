"""A script that comes by ssh, cut into lines; what waits for the line before it is bounded."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.gateway.ssh_script import LINE_CHARACTERS, UNREAD_CHARACTERS, Script, TooMuchError


@given(st.lists(st.text("ab \n", max_size=20), max_size=8))
def test_it_comes_out_as_it_went_in_line_by_line(pieces: list[str]) -> None:
    async def read() -> list[str]:
        script = Script()
        for piece in pieces:
            script.add(piece)
        script.end()
        return [line async for line in script.lines()]

    assert asyncio.run(read()) == "".join(pieces).splitlines(keepends=True)


def test_what_waits_is_bounded_and_what_was_read_counts_no_more() -> None:
    async def story() -> None:
        script, line = Script(), "x" * 1023 + "\n"
        lines = script.lines()
        for _ in range(2 * UNREAD_CHARACTERS // len(line)):  # a long script whose lines are done as they come
            script.add(line)
            assert await anext(lines) == line
        script.add(line * (UNREAD_CHARACTERS // len(line)))
        with pytest.raises(TooMuchError, match=f"found {UNREAD_CHARACTERS + 2}"):
            script.add("x\n")

    asyncio.run(story())


def test_a_line_is_bounded() -> None:
    script = Script()
    script.add("x" * LINE_CHARACTERS)
    with pytest.raises(TooMuchError, match="lines of at most 65536"):
        script.add("x")
