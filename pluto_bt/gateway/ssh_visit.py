"""One visit by ssh: a conversation on a terminal, one command, or a script from a pipe."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TextIO, cast

import asyncssh

from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.shell.codes import FAILED, USAGE, UsageError
from pluto_bt.gateway.shell.face import PlainFace
from pluto_bt.gateway.shell.main import stop_by_key
from pluto_bt.gateway.shell.obey import obey, split
from pluto_bt.gateway.shell.robot import NAME, Robot
from pluto_bt.gateway.shell.script import play
from pluto_bt.gateway.ssh_script import Script, TooMuchError
from pluto_bt.gateway.ssh_stream import Stream

if TYPE_CHECKING:
    from prompt_toolkit.application.current import AppSession

    from pluto_bt.gateway.ssh_keyboard import Keyboard

INTERRUPT, END_OF_INPUT = "\x03", "\x04"
ROWS, COLUMNS = 24, 80


class Visit(asyncssh.SSHServerSession[str]):
    """From the request of a session to its end. However it ends, what it drove stops."""

    def __init__(self, gateway: Address, name: str, leave: Callable[[], None]) -> None:
        self._robot = Robot(gateway, f"{NAME} {name}")
        self._leave = leave
        self._channel: asyncssh.SSHServerChannel[str]
        self._has_terminal = False
        self._command: str | None = None
        self._face: PlainFace
        self._script = Script()
        self._work: asyncio.Task[int] | None = None
        self._ending: asyncio.Task[None] | None = None
        self._stopping: asyncio.Task[int] | None = None
        self._keyboard: Keyboard | None = None
        self._app_session: AppSession | None = None

    # asyncssh's calls --------------------------------------------------------------------------------------------
    def connection_made(self, chan: asyncssh.SSHServerChannel[str]) -> None:
        """A channel."""
        self._channel = chan

    def pty_requested(self, term_type: str, term_size: tuple[int, int, int, int], term_modes: Any) -> bool:
        """A terminal at the other end."""
        self._has_terminal = True
        return True

    def shell_requested(self) -> bool:
        """A conversation, or a script."""
        return True

    def exec_requested(self, command: str) -> bool:
        """One command."""
        self._command = command
        return True

    def session_started(self) -> None:
        """Begin."""
        out, errors = (cast(TextIO, Stream(self._channel, is_error=is_error, is_terminal=self._has_terminal)) for is_error in (False, True))
        self._face = PlainFace(out, errors, may_read_files=False)
        self._work = asyncio.create_task(self._serve(out))
        self._ending = asyncio.create_task(self._end(self._work))

    def data_received(self, data: str, datatype: int | None) -> None:
        """Keys, or the lines of a script."""
        if self._keyboard is not None:
            if not self._keyboard.type(data):
                self._face.complain("more keys came than a person types; a script comes through a pipe, without a terminal")
                self._cancel()
        elif self._has_terminal:
            if INTERRUPT in data:
                self._interrupt()
            elif END_OF_INPUT in data:
                self._cancel()
        elif self._command is None:
            try:
                self._script.add(data)
            except TooMuchError as error:
                self._face.complain(str(error))
                self._cancel()

    def eof_received(self) -> bool:
        """The script is whole, or the terminal is closed."""
        if self._keyboard is not None:
            self._keyboard.type(END_OF_INPUT)
        else:
            self._script.end()
        return True

    def break_received(self, msec: int) -> bool:
        """As Ctrl-C."""
        self._interrupt()
        return True

    def signal_received(self, signal: str) -> None:
        """INT is Ctrl-C; anything else ends the visit."""
        if signal == "INT":
            self._interrupt()
        else:
            self._cancel()

    def terminal_size_changed(self, width: int, height: int, pixwidth: int, pixheight: int) -> None:
        """Draw anew."""
        app = self._app_session.app if self._app_session is not None else None
        if app is not None and app.is_running:
            app._on_resize()

    def connection_lost(self, exc: Exception | None) -> None:
        """Gone: what goes on is cancelled, and with it what it drives is stopped."""
        self._cancel()
        self._leave()

    # our own -----------------------------------------------------------------------------------------------------
    async def _serve(self, out: TextIO) -> int:
        if self._command is not None:
            try:
                words = split(self._command)
                if not words:
                    raise UsageError("expected a command, found nothing; `help` lists them")
            except UsageError as error:
                self._face.complain(str(error))
                return USAGE
            return await obey(self._robot, self._face, words)
        if self._has_terminal:
            return await self._talk(out)
        return await play(self._robot, self._face, self._script.lines())

    async def _talk(self, out: TextIO) -> int:
        """The conversation, on the client's terminal."""
        from prompt_toolkit.application.current import create_app_session
        from prompt_toolkit.data_structures import Size
        from prompt_toolkit.output.vt100 import Vt100_Output

        from pluto_bt.gateway.shell.console import Console, history_of
        from pluto_bt.gateway.ssh_keyboard import Keyboard

        def size() -> Size:
            width, height, *_ = self._channel.get_terminal_size()
            return Size(rows=height or ROWS, columns=width or COLUMNS)

        keyboard = Keyboard()
        output = Vt100_Output(out, size, term=self._channel.get_terminal_type())
        with create_app_session(input=keyboard, output=output) as self._app_session:
            console = Console(self._robot, history_of("ssh_history"), may_read_files=False, has_signals=False)
            self._keyboard = keyboard
            try:
                return await console.talk()
            finally:
                self._keyboard = None

    async def _end(self, work: asyncio.Task[int]) -> None:
        """The exit code to the client, and nothing left behind."""
        code = FAILED
        try:
            code = await work
        except asyncio.CancelledError:
            if self._stopping is not None:
                code = await self._stopping
        except Exception as error:  # told to the one who asked, not to the terminal of the run
            self._face.complain(f"internal: {type(error).__name__}: {error}")
        finally:
            await self._robot.close()
            with suppress(OSError):
                self._channel.exit(code)
            self._channel.close()

    def _interrupt(self) -> None:
        """Ctrl-C: the robot stops, then the command ends."""
        if self._stopping is None:
            self._stopping = asyncio.create_task(stop_by_key(self._robot, self._face))
            self._cancel()

    def _cancel(self) -> None:
        if self._work is not None:
            self._work.cancel()
