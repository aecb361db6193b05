"""Raw commands into the chain, as the keyboard interfaces of the Pluto manual gave them: `cmdFlags` and vectors to one link.

A link takes them only while the thread of the one above is stopped; it says so otherwise.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Sequence
from contextlib import suppress

from pluto_bt.gateway.shell.codes import DONE, FAILED
from pluto_bt.gateway.shell.driving import Act, driving
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot

REPEAT_S = 1.0  # the drive gives up four seconds after the last command
ALL_SENSORS = {"drive": 10, "avoidance": 30, "motion": 30}  # tens of cmdFlags; the drive knows sonar alone
MAX_TURN_RADPS = math.radians(45.0)
RELEASE, REACHED, STUCK = -1, 1, 2


def velocity(target: str) -> Act:
    """T = 0: speed and turn rate for so long, then rest."""

    async def act(robot: Robot, face: Face, speed_mps: float, turn_dps: float, for_s: float) -> int:
        return await _hold(robot, face, target, ALL_SENSORS[target], for_s, velocity=(speed_mps, math.radians(turn_dps)))

    return act


def heading(target: str) -> Act:
    """T = 1: the regulator holds an angle and a speed; the angle is that of the map for avoidance and motion, of the odometry for the drive."""

    async def act(robot: Robot, face: Face, speed_mps: float, angle_deg: float, for_s: float) -> int:
        flags = ALL_SENSORS[target] + 1
        return await _hold(robot, face, target, flags, for_s, position=(0.0, math.radians(angle_deg)), velocity=(speed_mps, 0.0))

    return act


def goto(target: str) -> Act:
    """T = 2: to a place of the map; over when `element[1]` says reached or stuck."""

    async def act(robot: Robot, face: Face, x_m: float, y_m: float, speed_mps: float, force: float) -> int:
        vectors = {"position": (x_m, y_m), "velocity": (speed_mps, MAX_TURN_RADPS), "force": (force,)}
        async with driving(robot) as client, client.stream("subscribe", topic=f"{target}/status", max_rate_hz=10.0) as statuses:
            await client.command(target, ALL_SENSORS[target] + 2, **vectors)
            await asyncio.sleep(0.3)  # what still speaks of the command before is over by then
            statuses.waiting.clear()
            while True:
                element = [int(word) for word in ((await statuses.next()).findtext("element") or "").split()]
                face.progress(f"element {' '.join(map(str, element))}")
                if len(element) > 1 and element[1] in (REACHED, STUCK):
                    face.say("reached" if element[1] == REACHED else "stuck")
                    return DONE if element[1] == REACHED else FAILED

    return act


def wall(target: str) -> Act:
    """T = 3: along the wall on the left, for so long."""

    async def act(robot: Robot, face: Face, speed_mps: float, for_s: float) -> int:
        return await _hold(robot, face, target, ALL_SENSORS[target] + 3, for_s, velocity=(speed_mps, MAX_TURN_RADPS))

    return act


def release(target: str) -> Act:
    """cmdFlags −1: the link's thread stops, and who is below it can be commanded."""

    async def act(robot: Robot, face: Face) -> int:
        async with driving(robot) as client:
            await client.command(target, RELEASE)
        face.say(f"{target} released; `start` starts it again")
        return DONE

    return act


async def _hold(robot: Robot, face: Face, target: str, flags: int, for_s: float, **vectors: Sequence[float]) -> int:
    """Keep a command in force for so long, then come to rest."""
    async with driving(robot) as client:
        with suppress(TimeoutError):
            async with asyncio.timeout(for_s):
                while True:
                    await client.command(target, flags, **vectors)
                    face.progress(f"cmdFlags {flags} to {target}")
                    await asyncio.sleep(REPEAT_S)
        await client.command(target, ALL_SENSORS[target], velocity=(0.0, 0.0))
    face.say("at rest")
    return DONE
