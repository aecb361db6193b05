"""The screen while a command goes on: which keys are for it, which for the next prompt."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import suppress

import pytest

pytest.importorskip("prompt_toolkit", reason="a conversation needs prompt_toolkit (extra shell)")

from prompt_toolkit.application.current import create_app_session
from prompt_toolkit.input.typeahead import get_typeahead
from prompt_toolkit.output import DummyOutput

from pluto_bt.gateway.shell.busy import BusyScreen
from pluto_bt.gateway.ssh_keyboard import Keyboard

CTRL_C, CTRL_D = "\x03", "\x04"


class Desk:
    """A screen, its keyboard, and what came of the keys."""

    def __init__(self) -> None:
        self.keyboard = Keyboard()
        self.did: list[str] = []
        with create_app_session(input=self.keyboard, output=DummyOutput()):
            self.screen = BusyScreen(lambda: "", self._stop, lambda: self.did.append("left"), 0.05, has_signals=False)

    def _stop(self) -> None:
        self.did.append("stopped")
        self.screen.end()

    async def command(self, typed: str, typed_at_its_end: str = "") -> None:
        """A command that goes on until it is ended, and needs a while to end."""
        self.keyboard.type(typed)
        try:
            await asyncio.Event().wait()
        finally:
            self.keyboard.type(typed_at_its_end)
            while self.keyboard._at < len(self.keyboard._unread):
                await asyncio.sleep(0)

    def run(self, typed: str, typed_at_its_end: str = "") -> str:
        """What the next prompt finds typed."""

        async def work() -> int:
            await self.command(typed, typed_at_its_end)
            return 0

        async def one() -> None:
            with create_app_session(input=self.keyboard, output=DummyOutput()), suppress(asyncio.CancelledError):
                await self.screen.watch(work())

        asyncio.run(one())
        return "".join(key.data for key in get_typeahead(self.keyboard))


@pytest.fixture
def desk() -> Iterator[Desk]:
    one = Desk()
    yield one
    get_typeahead(one.keyboard)


def test_ctrl_d_leaves_a_command(desk: Desk) -> None:
    assert desk.run(CTRL_D) == "" and desk.did == ["left"]


def test_what_is_typed_meanwhile_is_for_the_prompt_and_ctrl_c_forgets_it(desk: Desk) -> None:
    assert desk.run("go" + CTRL_D) == "" and desk.did == ["left"]
    assert desk.run("stop" + CTRL_C) == "" and desk.did == ["left", "stopped"]


def test_ctrl_d_after_ctrl_c_is_for_the_prompt_also_while_the_command_is_ending(desk: Desk) -> None:
    assert desk.run(CTRL_C, "quit" + CTRL_D) == "quit" + CTRL_D and desk.did == ["stopped"]


def test_ctrl_c_is_heard_while_the_command_is_ending(desk: Desk) -> None:
    assert desk.run(CTRL_C, "x" + CTRL_C + CTRL_D) == CTRL_D and desk.did == ["stopped", "stopped"]
