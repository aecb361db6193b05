"""`drive`: the arrow keys drive the robot, through motion with all sensors on; let go, and it stops."""

from __future__ import annotations

import asyncio
import math

from pluto_bt.gateway.async_client import AsyncClient
from pluto_bt.gateway.client import Element
from pluto_bt.gateway.shell.codes import DONE
from pluto_bt.gateway.shell.driving import driving, side_by_side
from pluto_bt.gateway.shell.face import Face
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.stick import Real, Stick

TTL_S = 2.0  # a shell that hangs while a key is held must not drive on
PERIOD_S = 0.1
STATUS_HZ = 20.0
VELOCITY_ALL_SENSORS = 30  # cmdFlags = 10 * A + T: both sensors, velocity
HELP = "arrows drive, space stops, q leaves"


class _Drive:
    """One spell of driving: the stick, what the drive says, what is shown."""

    def __init__(self, client: AsyncClient, max_speed_mps: float) -> None:
        self._client = client
        self._now_s = asyncio.get_running_loop().time
        self._stick = Stick(max_speed_mps)
        self._real: Real | None = None
        self._trouble = ""
        self._is_moving = False

    def hear(self, value: Element) -> None:
        """A `drive/status`."""
        speed, turn, *_ = map(float, (value.findtext("data") or "0 0").split())
        self._real = Real(speed, turn, self._now_s() - float(value.get("age", "0")))
        first = value.find("status")
        name = "" if first is None else first.get("name", "")
        self._trouble = "" if name in ("normal", "command-timeout") else f"drive: {name}"

    def hit(self, key: str) -> None:
        """A key."""
        refused = self._stick.hit(key, self._now_s(), self._real)
        self._trouble = refused or self._trouble

    async def command(self) -> None:
        """Ask for what the keys say; zero velocity once when they are let go, and nothing while nobody drives."""
        wanted = self._stick.velocity(self._now_s())
        is_moving = wanted != (0.0, 0.0)
        if is_moving or self._is_moving:
            self._is_moving = is_moving
            await self._client.command("motion", VELOCITY_ALL_SENSORS, velocity=wanted)

    def shown(self) -> str:
        """The line that the driver sees."""
        real = self._real
        if real is None:
            return f"drive: no word of the drive yet   ({HELP})"
        age_s = self._now_s() - real.heard_s
        age = f", {age_s:.1f} s old" if age_s > 0.5 else ""
        turn_dps = math.degrees(real.turn_radps)
        return f"drive: {real.speed_mps:+.2f} m/s {turn_dps:+.0f} °/s{age}   {self._trouble}   ({HELP})"


async def drive(robot: Robot, face: Face, max_speed_mps: float) -> int:
    """Drive by the arrow keys until `q`."""
    async with driving(robot, TTL_S) as client:
        spell = _Drive(client, max_speed_mps)
        async with face.keys(spell.shown) as keys, side_by_side() as group:
            tasks = [group.create_task(_hear(client, spell)), group.create_task(_command(spell))]
            async for key in keys:
                if key == "q":
                    break
                spell.hit(key)
            spell.hit("q")
            await spell.command()
            for task in tasks:
                task.cancel()
    return DONE


async def _hear(client: AsyncClient, spell: _Drive) -> None:
    async with client.stream("subscribe", topic="drive/status", max_rate_hz=STATUS_HZ) as values:
        async for value in values:
            spell.hear(value)


async def _command(spell: _Drive) -> None:
    while True:
        await spell.command()
        await asyncio.sleep(PERIOD_S)
