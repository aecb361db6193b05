"""The conversation at a terminal: a prompt with completion and history, a bottom line, events above; Ctrl-C is STOP, whatever goes on."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from contextlib import suppress

from prompt_toolkit import PromptSession, print_formatted_text
from prompt_toolkit.formatted_text import FormattedText
from prompt_toolkit.history import FileHistory, History, InMemoryHistory
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent

from pluto_bt.gateway.shell.busy import BusyScreen
from pluto_bt.gateway.shell.codes import DONE, UsageError
from pluto_bt.gateway.shell.completer import TableCompleter
from pluto_bt.gateway.shell.face import Keys, printable
from pluto_bt.gateway.shell.live import Live
from pluto_bt.gateway.shell.main import stop_by_key
from pluto_bt.gateway.shell.obey import obey, split, subshell
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.short_line import keep_short
from pluto_bt.runtime.state_folder import state_folder

REFRESH_S = 0.25
STYLES = {"warning": "ansiyellow", "error": "ansired bold"}
GREETING = "Ctrl-C stops the robot, always. `help` lists the commands, Tab completes, Ctrl-D leaves."
LEFT = "left: a mission goes on by itself, what this command drove is stopped"


class Console:
    """One terminal. `talk` goes on until the person leaves; it is the `Face` of the commands."""

    def __init__(self, robot: Robot, history: History, *, may_read_files: bool, has_signals: bool) -> None:
        self.may_read_files = may_read_files
        self._robot = robot
        self._has_signals = has_signals
        self._live = Live(robot, self._event)
        self._completer = TableCompleter(lambda: self._live.names)
        self._busy = BusyScreen(self._live.line, self._stop, lambda: self.say(LEFT), REFRESH_S, has_signals=has_signals)
        self._stops: set[asyncio.Task[int]] = set()
        bindings = self._bindings()
        self._prompt: PromptSession[str] = PromptSession(
            completer=self._completer, history=history, key_bindings=bindings, bottom_toolbar=self._live.line, refresh_interval=REFRESH_S
        )
        keep_short(self._prompt.default_buffer, bindings, self.complain)

    # Face --------------------------------------------------------------------------------------------------------
    def say(self, text: str) -> None:
        """Above the prompt."""
        print_formatted_text(printable(text))

    def complain(self, text: str) -> None:
        """Above the prompt, too."""
        self.say(text)

    def progress(self, text: str) -> None:
        """In the line above the bottom line."""
        self._busy.progress(printable(text))

    def keys(self, shown: Callable[[], str]) -> Keys:
        """Keys for a command that goes on."""
        return self._busy.keys(shown)

    # talking -----------------------------------------------------------------------------------------------------
    async def talk(self) -> int:
        """Until Ctrl-D or `quit`."""
        try:
            self.say(GREETING)
            while True:
                shell = self._completer.shell
                try:
                    line = await self._prompt.prompt_async(f"{shell or 'pluto'}> ", handle_sigint=self._has_signals)
                except EOFError:
                    line = "back" if shell else "quit"
                if not await self._line(line):
                    return DONE
        finally:
            await self._live.close()
            await self._robot.close()

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
            self._completer.shell = ""
        elif opened := subshell(words):
            self._completer.shell = opened
        elif words:
            await self._obey(words)
        return True

    async def _obey(self, words: list[str]) -> None:
        try:
            await self._busy.watch(obey(self._robot, self, words, self._completer.shell))
        except Exception as error:  # a fault of one command must not take the one away who can stop the robot
            self.complain(f"internal: {type(error).__name__}: {error}")
        for stop in tuple(self._stops):
            await stop

    def _stop(self) -> None:
        """Ctrl-C: the robot stops, then what goes on ends."""
        task = asyncio.create_task(stop_by_key(self._robot, self))
        self._stops.add(task)
        task.add_done_callback(self._stops.discard)
        self._busy.end()

    def _bindings(self) -> KeyBindings:
        bindings = KeyBindings()

        @bindings.add("c-c")
        @bindings.add("<sigint>")
        def interrupt(event: KeyPressEvent) -> None:
            event.current_buffer.reset()
            self._stop()

        return bindings

    def _event(self, line: str, level: str) -> None:
        print_formatted_text(FormattedText([(STYLES.get(level, ""), printable(line))]))


def history_of(name: str) -> History:
    """What was typed before; forgotten where nothing can be written."""
    with suppress(OSError, RuntimeError):
        path = state_folder() / name
        if os.access(path if path.exists() else path.parent, os.W_OK):
            path.touch(mode=0o600)
            return FileHistory(str(path))
    return InMemoryHistory()


async def talk_here(robot: Robot) -> int:
    """A conversation at this process's own terminal."""
    return await Console(robot, history_of("shell_history"), may_read_files=True, has_signals=True).talk()
