"""What the bottom line shows: pose, speed, mission, active leaf, each as old as it is; and the events as they come."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from contextlib import suppress

from pluto_bt.gateway.async_client import AsyncClient
from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.shell.driving import side_by_side
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.telling import event_line
from pluto_bt.gateway.subscriptions import ALIASES

OLD_S = 1.0
HISTORY_S = 10.0
RETRY_S = 0.5
SHOWN_HZ = 4.0
SHOWN = ("Localization/Pose", "drive/status", "mission")


class Live:
    """Listens to the robot as long as the shell is open, over a connection of its own: what commands subscribe to is another matter."""

    def __init__(self, robot: Robot, on_event: Callable[[str, str], None]) -> None:
        """`on_event` is given each event as a line, and its level."""
        self._robot = robot
        self._on_event = on_event
        self._now_s = asyncio.get_running_loop().time
        self._values: dict[str, tuple[Element, float]] = {}  # topic → value, when it was true by our clock
        self._is_linked = False
        self._lost_s = self._now_s()
        self.names: dict[str, dict[str, str]] = {}  # by kind (topic, module, mission, param, node, goal, `port NODE`): names with their meanings
        self._keeping = asyncio.create_task(self._keep())

    def line(self) -> str:
        """The bottom line."""
        now_s = self._now_s()
        if not self._is_linked:
            return f" NO LINK to {self._robot.address} for {now_s - self._lost_s:.0f} s: what the robot does is not known here"
        return " " + "  |  ".join((self._pose(now_s), self._speed(now_s), self._mission()))

    async def close(self) -> None:
        """Listen no more."""
        self._keeping.cancel()
        with suppress(asyncio.CancelledError):
            await self._keeping

    def _pose(self, now_s: float) -> str:
        value, age = self._newest("Localization/Pose", now_s)
        if value is None:
            return "pose unknown"
        x_m, y_m, _, theta_rad, *_ = map(float, (value.findtext("pose") or "").split())
        return f"x {x_m:.2f} m  y {y_m:.2f} m  {math.degrees(theta_rad):.0f}°{age}"

    def _speed(self, now_s: float) -> str:
        value, age = self._newest("drive/status", now_s)
        if value is None:
            return "speed unknown"
        speed_mps, turn_radps, *_ = map(float, (value.findtext("data") or "").split())
        first = value.find("status")
        name = "" if first is None else first.get("name", "")
        return f"{speed_mps:.2f} m/s  {math.degrees(turn_radps):.0f} °/s{f'  {name}' if name != 'normal' else ''}{age}"

    def _mission(self) -> str:
        value, _ = self._newest("mission", 0.0)  # written when it changes: it cannot grow old
        if value is None:
            return "no mission"
        part = {child.tag: child.text or "" for child in value}
        reason, step = part.get("reason"), part.get("step")
        return f"{part.get('name') or 'mission'}: {part.get('state')}{f' ({reason})' if reason else ''}{f' at {step}' if step else ''}"

    def _newest(self, topic: str, now_s: float) -> tuple[Element | None, str]:
        """The value, and how old it is if that must be said."""
        value, true_s = self._values.get(topic, (None, 0.0))
        age_s = now_s - true_s
        return value, f"  {age_s:.0f} s OLD" if age_s > OLD_S else ""

    # listening ---------------------------------------------------------------------------------------------------
    async def _keep(self) -> None:
        """One connection after the other, each begun anew: behind the next one may be another run, or another robot."""
        while True:
            with suppress(GatewayError):
                client = await self._robot.connect()
                try:
                    await self._follow(client)
                except GatewayError as error:
                    self._on_event(f"connection lost: {error.code}: {error.text}", "error")
                finally:
                    self._is_linked, self._lost_s = False, self._now_s()
                    await client.close()
            await asyncio.sleep(RETRY_S)

    async def _follow(self, client: AsyncClient) -> None:
        """Listen until the connection is lost. Raises: GatewayError."""
        self._is_linked = True
        self._values.clear()
        async with side_by_side() as group:
            for topic in SHOWN:
                group.create_task(self._listen(client, topic))
            group.create_task(self._hear_events(client))
            with suppress(GatewayError):
                await self._learn(client)

    async def _listen(self, client: AsyncClient, topic: str) -> None:
        async with client.stream("subscribe", topic=topic, max_rate_hz=SHOWN_HZ) as values:
            async for value in values:
                self._values[topic] = (value, self._now_s() - float(value.get("age", "0")))

    async def _hear_events(self, client: AsyncClient) -> None:
        async with client.stream("subscribe", topic="events") as values:
            async for value in values:
                if float(value.get("age", "0")) < HISTORY_S:  # `events` shows the older ones
                    self._on_event(event_line(value), value.findtext("level") or "")

    async def _learn(self, client: AsyncClient) -> None:
        """What there is, for completion; a gateway that does not say so soon leaves us with what we know."""
        known: dict[str, dict[str, str]] = {"topic": dict.fromkeys(ALIASES, "")}
        for item in await client.request("describe"):
            kind, name = item.get("kind", ""), item.get("name", "")
            known.setdefault(kind, {})[name] = item.findtext("doc") or ""
            if kind == "node":
                inputs = [port for port in item.iter("field") if port.get("direction") != "out"]
                known[f"port {name}"] = {f"{port.get('name')}=": port.get("doc") or "" for port in inputs}
        known["module"] = {module.get("name", ""): module.get("state", "") for module in await client.request("modules")}
        known["mission"] = {mission.get("name", ""): "" for mission in (await client.request("mission", op="list")).iter("mission")}
        self.names = known
