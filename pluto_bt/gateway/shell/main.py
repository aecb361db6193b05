"""`pluto shell [HOST:PORT] [COMMAND ...]`: one command, a script from a pipe, or a conversation at a terminal."""

from __future__ import annotations

import asyncio
import contextlib
import re
import signal
import sys
import threading
from collections.abc import AsyncIterator, Coroutine, Sequence
from typing import TextIO

from pluto_bt.gateway.client import GatewayError
from pluto_bt.gateway.listen import Address, parse_address
from pluto_bt.gateway.shell.codes import DONE, FAILED, INTERRUPTED
from pluto_bt.gateway.shell.face import Face, PlainFace
from pluto_bt.gateway.shell.obey import obey
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.script import play
from pluto_bt.gateway.shell.table import help_text

_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:]+\]|[A-Za-z0-9.-]*):[0-9]{1,5}")


def main(words: Sequence[str], out: TextIO | None = None, errors: TextIO | None = None) -> int:
    """Run the shell with the words behind `pluto shell`; the exit code: 0 done, 1 failed, 2 not understood, 130 Ctrl-C after a stop."""
    out, errors = out or sys.stdout, errors or sys.stderr
    if words and words[0] in ("-h", "--help"):
        print(f"usage: pluto shell [HOST:PORT] [COMMAND ...]\n\n{help_text()}\n\nWithout a command it asks for commands, or reads them from a pipe. "
              f"HOST:PORT is {Address()} if it is not given.", file=out)  # fmt: skip
        return DONE
    rest = list(words)
    robot = Robot(parse_address(rest.pop(0)) if rest and _ADDRESS.fullmatch(rest[0]) else Address())
    face = PlainFace(out, errors)
    if rest:
        return asyncio.run(_stoppable(robot, face, obey(robot, face, rest)))
    if sys.stdin.isatty() and out.isatty():
        return asyncio.run(_talk(robot))
    return asyncio.run(_stoppable(robot, face, play(robot, face, _typed(sys.stdin))))


async def _stoppable(robot: Robot, face: Face, work: Coroutine[None, None, int]) -> int:
    """Do the work; Ctrl-C stops the robot first, then ends the work. A closed terminal, or a kill, ends the work as well."""
    task = asyncio.ensure_future(work)
    loop = asyncio.get_running_loop()
    stopping: list[asyncio.Task[int]] = []

    def interrupt() -> None:
        stopping.append(asyncio.create_task(stop_by_key(robot, face)))
        task.cancel()

    with contextlib.suppress(NotImplementedError, ValueError, RuntimeError):  # not in the main thread: a test, or a program that uses us
        loop.add_signal_handler(signal.SIGINT, interrupt)
        for number in (signal.SIGTERM, signal.SIGHUP):
            loop.add_signal_handler(number, task.cancel)
    try:
        return await task
    except asyncio.CancelledError:
        return await stopping[0] if stopping else FAILED
    finally:
        await robot.close()


async def stop_by_key(robot: Robot, face: Face) -> int:
    """Ctrl-C: whatever goes on, the robot stops."""
    try:
        await robot.stop()
    except GatewayError as error:
        face.complain(f"NOT STOPPED: {error.code}: {error.text}")
        return FAILED
    face.say("stopped")
    return INTERRUPTED


async def _typed(stream: TextIO) -> AsyncIterator[str]:
    """The lines of a blocking stream; a thread of its own waits for them, so that Ctrl-C is heard meanwhile."""
    loop, lines = asyncio.get_running_loop(), asyncio.Queue[str]()

    def read() -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended before the stream
            for line in stream:
                loop.call_soon_threadsafe(lines.put_nowait, line)
            loop.call_soon_threadsafe(lines.put_nowait, "")

    threading.Thread(target=read, name="stdin", daemon=True).start()
    while line := await lines.get():
        yield line


async def _talk(robot: Robot) -> int:
    try:
        from pluto_bt.gateway.shell.console import talk_here
    except ImportError:
        mend = "pip install 'pluto_bt[shell]'; a single command works without it: pluto shell stop"
        print(f"pluto shell: a conversation needs prompt_toolkit: {mend}", file=sys.stderr)
        return FAILED
    return await talk_here(robot)
