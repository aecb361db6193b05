"""The line at the prompt: what is typed or pasted beyond its length is left out, and told once."""

from __future__ import annotations

import asyncio

import pytest

pytest.importorskip("prompt_toolkit")

from prompt_toolkit import PromptSession
from prompt_toolkit.application.current import create_app_session
from prompt_toolkit.key_binding import KeyBindings
from prompt_toolkit.output import DummyOutput

from pluto_bt.gateway.shell.short_line import LONGEST, keep_short
from pluto_bt.gateway.ssh_keyboard import Keyboard

PASTE, END = "\x1b[200~", "\x1b[201~"


@pytest.mark.parametrize(
    ("typed", "line", "n_told"),
    [
        ("goto 1 2", "goto 1 2", 0),
        ("x" * LONGEST, "x" * LONGEST, 0),
        ("x" * (LONGEST + 500), "x" * LONGEST, 1),
        (f"{PASTE}{'y' * 100_000}{END}", "y" * LONGEST, 1),
        (f"ab{PASTE}{'y' * 100_000}{END}zz", "ab" + "y" * (LONGEST - 2), 1),
        ("x" * (LONGEST + 5) + "\x15stop", "stop", 1),  # Ctrl-U: begin anew
        (f"{PASTE}pose\r\nwhy{END}", "pose\nwhy", 0),
    ],
)
def test_a_line_is_no_longer_than_a_line(typed: str, line: str, n_told: int) -> None:
    told: list[str] = []

    async def talk() -> str:
        keyboard, bindings = Keyboard(), KeyBindings()
        with create_app_session(input=keyboard, output=DummyOutput()):
            prompt: PromptSession[str] = PromptSession(key_bindings=bindings)
            keep_short(prompt.default_buffer, bindings, told.append)
            keyboard.type(typed + "\r")
            return await prompt.prompt_async()

    assert asyncio.run(talk()) == line
    assert len(told) == n_told
