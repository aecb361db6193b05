"""The keys of a visitor by ssh: none is lost or turned round, a paste holds up nobody, Ctrl-C goes before all."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("prompt_toolkit")

from pluto_bt.gateway.ssh_keyboard import SLICE_CHARACTERS, UNREAD_CHARACTERS, Keyboard


def heard(story: Callable[[Keyboard], object], turns: int) -> list[str]:
    """What is read within so many turns of the loop."""
    read: list[str] = []

    async def play() -> None:
        keyboard = Keyboard()
        with keyboard.attach(lambda: read.append("".join(key.data for key in keyboard.read_keys()))):
            story(keyboard)
            for _ in range(turns):
                await asyncio.sleep(0)

    asyncio.run(play())
    return read


@given(st.lists(st.text("ab \r", max_size=3 * SLICE_CHARACTERS), max_size=8))
def test_every_key_is_read_once_and_in_order_a_few_at_a_time(texts: list[str]) -> None:
    def type_all(keyboard: Keyboard) -> None:
        assert all(keyboard.type(text) for text in texts)

    read = heard(type_all, turns=40)
    assert "".join(read) == "".join(texts)
    assert all(len(piece) <= SLICE_CHARACTERS for piece in read)


@pytest.mark.parametrize("before", ["x" * 200_000, "\x1b[200~never ends", "\x1b[", "\x03\x03"])
def test_ctrl_c_forgets_what_waits_before_it(before: str) -> None:
    def paste_and_interrupt(keyboard: Keyboard) -> None:
        keyboard.type(before)
        keyboard.read_keys()
        keyboard.type("more\x03help\r")

    assert heard(paste_and_interrupt, turns=3)[0] == "\x03help\r"


def test_more_than_anybody_types_is_not_taken_but_ctrl_c_is() -> None:
    keyboard = Keyboard()
    assert keyboard.type("x" * UNREAD_CHARACTERS)
    assert not keyboard.type("x")
    assert keyboard.type("\x03")


def test_what_comes_while_nobody_listens_waits_for_the_next_who_does() -> None:
    async def play() -> None:
        keyboard = Keyboard()
        outer: list[str] = []
        inner: list[str] = []

        def into(read: list[str]) -> Callable[[], None]:
            return lambda: read.extend(key.data for key in keyboard.read_keys())

        with keyboard.attach(into(outer)):
            with keyboard.attach(into(inner)):
                keyboard.type("a")
                await asyncio.sleep(0)
            with keyboard.detach():
                keyboard.type("b")
                await asyncio.sleep(0)
            await asyncio.sleep(0)
        keyboard.type("c")
        await asyncio.sleep(0)
        with keyboard.attach(into(inner)):
            await asyncio.sleep(0)
        assert (outer, inner) == (["b"], ["a", "c"])

    asyncio.run(play())
