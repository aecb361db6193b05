"""A script: one command a line, from a pipe; it stops at the first that fails, and says which."""

from __future__ import annotations

from collections.abc import AsyncIterator

from pluto_bt.gateway.shell.codes import DONE, USAGE, UsageError
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.obey import obey, split, subshell
from pluto_bt.gateway.shell.robot import Robot


async def play(robot: Robot, face: Face, lines: AsyncIterator[str]) -> int:
    """Do the lines one after the other; the exit code of the first that is not 0."""
    number, shell = 0, ""
    async for line in lines:
        number += 1
        code = DONE
        try:
            words = split(line)
        except UsageError as error:
            face.complain(str(error))
            words, code = [], USAGE
        if words and words[0] in ("quit", "exit"):
            return DONE
        if words == ["back"]:
            shell = ""
        elif opened := subshell(words):
            shell = opened
        elif words:
            code = await obey(robot, face, words, shell)
        if code != DONE:
            face.complain(f"line {number}: {line.strip()}: ended here, with exit code {code}")
            return code
    return DONE
