"""The conversation at a terminal: a prompt with completion and history, a bottom line, events above; Ctrl-C is STOP, whatever goes on."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager, suppress
from typing import Any

from prompt_toolkit import PromptSession, print_formatted_text
from prompt_toolkit.application import Application
from prompt_toolkit.application.current import get_app, get_app_session
from prompt_toolkit.formatted_text import FormattedText
from prompt_toolkit.history import FileHistory, History, InMemoryHistory
from prompt_toolkit.input.typeahead import store_typeahead
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent
from prompt_toolkit.key_binding.key_processor import KeyPress
from prompt_toolkit.layout import HSplit, Layout, Window
from prompt_toolkit.layout.controls import FormattedTextControl

from pluto_bt.gateway.shell.codes import DONE, UsageError
from pluto_bt.gateway.shell.completer import TableCompleter
from pluto_bt.gateway.shell.face import printable
from pluto_bt.gateway.shell.live import Live
from pluto_bt.gateway.shell.main import stop_by_key
from pluto_bt.gateway.shell.obey import obey, split, subshell
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.runtime.state_folder import state_folder

REFRESH_S = 0.25
NAMED_KEYS = ("up", "down", "left", "right", "space", "q", "escape", "s-up", "s-down")
STYLES = {"warning": "ansiyellow", "error": "ansired bold"}
HINT = "Ctrl-C stops the robot, Ctrl-D leaves"
GREETING = "Ctrl-C stops the robot, always. `help` lists the commands, Tab completes, Ctrl-D leaves."


class Console:
    """One terminal. `talk` goes on until the person leaves; it is a `Face` for the commands."""

    def __init__(self, robot: Robot, history: History, *, may_read_files: bool, has_signals: bool) -> None:
        self.may_read_files = may_read_files
        self._robot = robot
        self._has_signals = has_signals
        self._live = Live(robot.address, self._event)
        self._completer = TableCompleter(lambda: self._live.names)
        self._shell = ""
        self._busy = ""  # what the middle line shows while a command goes on
        self._shown: Callable[[], str] | None = None
        self._keys: asyncio.Queue[str] = asyncio.Queue()
        self._ahead: list[KeyPress] = []  # typed while a command went on: the next prompt takes it up
        self._work: asyncio.Task[int] | None = None
        self._stops: set[asyncio.Task[int]] = set()
        self._prompt: PromptSession[str] = PromptSession(
            completer=self._completer, history=history, key_bindings=self._prompt_keys(), bottom_toolbar=self._live.line, refresh_interval=REFRESH_S
        )

    # Face --------------------------------------------------------------------------------------------------------
    def say(self, text: str) -> None:
        """Above the prompt."""
        print_formatted_text(printable(text))

    def complain(self, text: str) -> None:
        """Above the prompt, too."""
        self.say(text)

    def progress(self, text: str) -> None:
        """In the line above the bottom line."""
        self._busy = printable(text)
        get_app().invalidate()

    @asynccontextmanager
    async def keys(self, shown: Callable[[], str]) -> AsyncIterator[AsyncIterator[str]]:
        """Keys for a command that goes on."""
        self._keys, self._shown = asyncio.Queue(), shown
        try:
            yield self._hits()
        finally:
            self._shown = None

    async def _hits(self) -> AsyncIterator[str]:
        while True:
            yield await self._keys.get()

    # talking -----------------------------------------------------------------------------------------------------
    async def talk(self) -> int:
        """Until Ctrl-D or `quit`."""
        try:
            self.say(GREETING)
            while True:
                self._completer.shell = self._shell
                try:
                    line = await self._prompt.prompt_async(f"{self._shell or 'pluto'}> ", handle_sigint=self._has_signals)
                except EOFError:
                    if not self._shell:
                        return DONE
                    self._shell = ""
                    continue
                if not await self._line(line):
                    return DONE
        finally:
            self._live.close()
            self._robot.close()

    async def _line(self, line: str) -> bool:
        """Do one line; False if it means to leave."""
        try:
            words = split(line)
        except UsageError as error:
            self.complain(str(error))
            return True
        if words in (["quit"], ["exit"]):
            return False
        if words == ["back"]:
            self._shell = ""
        elif opened := subshell(words):
            self._shell = opened
        elif words:
            await self._watched(obey(self._robot, self, words, self._shell))
        return True

    async def _watched(self, work: Coroutine[Any, Any, int]) -> None:
        """Do the work behind a screen of two lines that hears Ctrl-C (and what the work listens to)."""
        self._busy, self._shown = "", None
        layout = Layout(HSplit([
            Window(FormattedTextControl(lambda: self._shown() if self._shown else f"{self._busy}   ({HINT})".lstrip()), height=1),
            Window(FormattedTextControl(self._live.line), height=1, style="class:bottom-toolbar"),
        ]))  # fmt: skip
        app: Application[None] = Application(layout, key_bindings=self._busy_keys(), erase_when_done=True, refresh_interval=REFRESH_S)
        self._work = asyncio.create_task(work)

        def over(task: asyncio.Task[int]) -> None:
            with suppress(Exception):  # the screen may be closed already
                app.exit()

        self._work.add_done_callback(over)
        try:
            if not self._work.done():
                await app.run_async(handle_sigint=self._has_signals)
        finally:
            self._work.cancel()
        try:
            await self._work
        except asyncio.CancelledError:
            pass
        except Exception as error:  # a fault of one command must not take the one away who can stop the robot
            self.complain(f"internal: {type(error).__name__}: {error}")
        for stop in tuple(self._stops):
            await stop
        store_typeahead(get_app_session().input, self._ahead)
        self._ahead = []

    def stop_now(self) -> None:
        """Ctrl-C: the robot stops, then what goes on ends."""
        task = asyncio.create_task(stop_by_key(self._robot, self))
        self._stops.add(task)
        task.add_done_callback(self._stops.discard)
        self._ahead = []
        if self._work is not None:
            self._work.cancel()

    def _prompt_keys(self) -> KeyBindings:
        bindings = KeyBindings()

        @bindings.add("c-c")
        @bindings.add("<sigint>")
        def interrupt(event: KeyPressEvent) -> None:
            event.current_buffer.reset()
            self.stop_now()

        return bindings

    def _busy_keys(self) -> KeyBindings:
        bindings = KeyBindings()

        @bindings.add("c-c")
        @bindings.add("<sigint>")
        def interrupt(event: KeyPressEvent) -> None:
            self.stop_now()

        @bindings.add("<any>")
        def other(event: KeyPressEvent) -> None:
            if self._shown is None:
                self._ahead += event.key_sequence
            key = event.key_sequence[0].key
            self._keys.put_nowait({" ": "space"}.get(key, str(getattr(key, "value", key))))

        @bindings.add("c-d")
        def leave(event: KeyPressEvent) -> None:
            self._keys.put_nowait("q")
            if self._work is not None and self._shown is None:
                self._work.cancel()
                self.say("left: a mission goes on by itself, what this command drove is stopped")

        return bindings

    def _event(self, line: str, level: str) -> None:
        print_formatted_text(FormattedText([(STYLES.get(level, ""), printable(line))]))


def history_of(name: str) -> History:
    """What was typed before; forgotten where nothing can be written."""
    with contextlib.suppress(OSError, RuntimeError):
        return FileHistory(str(state_folder() / name))
    return InMemoryHistory()


async def talk_here(robot: Robot) -> int:
    """A conversation at this process's own terminal."""
    return await Console(robot, history_of("shell_history"), may_read_files=True, has_signals=True).talk()
