"""The screen of two lines while a command goes on: how it goes, and the bottom line. It hears Ctrl-C, Ctrl-D, and the keys that the command wants."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager, suppress
from typing import Any

from prompt_toolkit.application import Application
from prompt_toolkit.application.current import get_app_session
from prompt_toolkit.input.typeahead import get_typeahead, store_typeahead
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent
from prompt_toolkit.key_binding.key_processor import KeyPress
from prompt_toolkit.layout import HSplit, Layout, Window
from prompt_toolkit.layout.controls import FormattedTextControl

KEYS_AHEAD = 4096
"""As many as a line discipline holds; what is typed or pasted beyond them while a command goes on is forgotten."""
HINT = "Ctrl-C stops the robot, Ctrl-D leaves"


class BusyScreen:
    """Shows one command after the other.

    Args:
        bottom: the bottom line.
        stop: called at Ctrl-C; it stops the robot, then calls `end`.
        left: called when the person leaves a command.
        has_signals: SIGINT means this screen, for the terminal is this process's own.
    """

    def __init__(self, bottom: Callable[[], str], stop: Callable[[], None], left: Callable[[], None], refresh_s: float, *, has_signals: bool) -> None:
        self._stop, self._left, self._has_signals = stop, left, has_signals
        self._text = ""
        self._shown: Callable[[], str] | None = None  # by a command that wants the keys
        self._keys: asyncio.Queue[str] = asyncio.Queue()
        self._ahead: list[KeyPress] = []  # typed while a command went on: the next prompt takes it up
        self._is_ending = False
        self._work: asyncio.Task[int] | None = None
        lines = HSplit([
            Window(FormattedTextControl(self._line), height=1),
            Window(FormattedTextControl(bottom), height=1, style="class:bottom-toolbar"),
        ])  # fmt: skip
        self._app: Application[None] = Application(Layout(lines), key_bindings=self._bindings(), erase_when_done=True, refresh_interval=refresh_s)

    def progress(self, text: str) -> None:
        """How the command goes on."""
        self._text = text
        self._app.invalidate()

    @asynccontextmanager
    async def keys(self, shown: Callable[[], str]) -> AsyncIterator[AsyncIterator[str]]:
        """The keys as they are hit, for the command, which says what is shown meanwhile."""
        self._keys, self._shown = asyncio.Queue(), shown
        try:
            yield self._hits()
        finally:
            self._shown = None

    async def watch(self, work: Coroutine[Any, Any, int]) -> None:
        """Do the work, until it is over or ended. Raises: what the work raises."""
        self._text, self._shown, self._is_ending = "", None, False
        self._work = asyncio.create_task(work)
        self._work.add_done_callback(self._over)
        try:
            if not self._work.done():
                await self._app.run_async(handle_sigint=self._has_signals)
        finally:
            keyboard = get_app_session().input
            store_typeahead(keyboard, self._ahead + get_typeahead(keyboard))  # the screen, closing, put there what it had not taken up
            self._ahead = []
            self._work.cancel()
            with suppress(asyncio.CancelledError):
                await self._work

    def end(self) -> None:
        """End the command; what was typed ahead is forgotten, what is typed from now on is for the prompt."""
        self._ahead, self._is_ending = [], True
        if self._work is not None:
            self._work.cancel()

    def _over(self, work: asyncio.Task[int]) -> None:
        with suppress(Exception):  # the screen is closed already
            self._app.exit()

    def _line(self) -> str:
        return self._shown() if self._shown is not None else f"{self._text}   ({HINT})".lstrip()

    async def _hits(self) -> AsyncIterator[str]:
        while True:
            yield await self._keys.get()

    def _keep(self, event: KeyPressEvent) -> None:
        """For the next prompt."""
        if len(self._ahead) < KEYS_AHEAD:
            self._ahead += event.key_sequence

    def _bindings(self) -> KeyBindings:
        bindings = KeyBindings()

        @bindings.add("c-c")
        @bindings.add("<sigint>")
        def stop(event: KeyPressEvent) -> None:
            self._stop()

        @bindings.add("c-d")
        def leave(event: KeyPressEvent) -> None:
            if self._is_ending:
                self._keep(event)
            elif self._shown is not None:
                self._keys.put_nowait("q")
            else:
                self.end()
                self._left()

        @bindings.add("<any>")
        def hit(event: KeyPressEvent) -> None:
            key = event.key_sequence[0].key
            if self._shown is not None and not self._is_ending:
                self._keys.put_nowait("space" if key == " " else str(getattr(key, "value", key)))
            else:
                self._keep(event)

        return bindings
