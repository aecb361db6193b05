"""`stop`, `estop` and `release`."""

from __future__ import annotations

from pluto_bt.gateway.shell import asking
from pluto_bt.gateway.shell.codes import DONE
from pluto_bt.gateway.shell.driving import driving
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot


async def stop(robot: Robot, face: Face, module: str | None) -> int:
    """`stop` alone is the stop; with a name it stops a module."""
    if module is not None:
        return await asking.module("stop")(robot, face, module)
    await robot.stop()
    face.say("stopped")
    return DONE


async def estop(robot: Robot, face: Face, words: tuple[str, ...]) -> int:
    """Stop, and stay stopped until somebody releases it."""
    await robot.request("estop", reason=" ".join(words))
    face.say("emergency stop; `release` takes it back")
    return DONE


async def release(robot: Robot, face: Face) -> int:
    """Take the emergency stop back; nothing moves by that."""
    async with driving(robot) as client:
        await client.request("release", what="estop")
    face.say("released; nothing moves until it is commanded")
    return DONE
