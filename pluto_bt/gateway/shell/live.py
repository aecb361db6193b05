"""What the bottom line shows: pose, speed, mission, active leaf, each as old as it is; and the events as they come."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Coroutine
from contextlib import suppress
from typing import Any

from pluto_bt.gateway.client import Element, GatewayError
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.shell.link import Link
from pluto_bt.gateway.shell.robot import Robot
from pluto_bt.gateway.shell.telling import event_line
from pluto_bt.gateway.subscriptions import ALIASES

OLD_S = 1.0
HISTORY_S = 10.0
SHOWN_HZ = 4.0
SHOWN = ("Localization/Pose", "drive/status", "mission")


class Live:
    """Listens to the robot as long as the shell is open, over a connection of its own: what commands subscribe to is another matter."""

    def __init__(self, address: Address, on_event: Callable[[str, str], None]) -> None:
        """`on_event` is given each event as a line, and its level."""
        self._robot = Robot(address)
        self._on_event = on_event
        self._now_s = asyncio.get_running_loop().time
        self._values: dict[str, tuple[Element, float]] = {}  # topic → value, when it was true by our clock
        self._link: Link | None = None
        self._lost_s = self._now_s()
        self._listening: set[asyncio.Task[None]] = set()
        self.names: dict[str, dict[str, str]] = {}  # by kind (topic, module, mission, param, node, goal, `port NODE`): names with their meanings
        self._robot.on_open = self._opened
        self._keeping = asyncio.create_task(self._robot.keep())

    def line(self) -> str:
        """The bottom line."""
        now_s = self._now_s()
        if self._link is None or self._link.lost.is_set():
            return f" NO LINK to {self._robot.address} for {now_s - self._lost_s:.0f} s: what the robot does is not known here"
        return " " + "  |  ".join((self._pose(now_s), self._speed(now_s), self._mission()))

    def close(self) -> None:
        """Listen no more."""
        for task in (self._keeping, *self._listening):
            task.cancel()
        self._robot.close()

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
    def _opened(self, link: Link) -> None:
        self._link = link
        self._values.clear()
        for topic in SHOWN:
            self._start(self._listen(link, topic))
        self._start(self._hear_events(link))
        self._start(self._learn(link))
        self._start(self._mind(link))

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.create_task(_until_lost(work))
        self._listening.add(task)
        task.add_done_callback(self._listening.discard)

    async def _listen(self, link: Link, topic: str) -> None:
        with link.ask("subscribe", topic=topic, max_rate_hz=SHOWN_HZ) as talk:
            while True:
                message = await talk.next(None)
                if message.tag == "value":
                    self._values[topic] = (message, self._now_s() - float(message.get("age", "0")))

    async def _hear_events(self, link: Link) -> None:
        with link.ask("subscribe", topic="events") as talk:
            while True:
                message = await talk.next(None)
                if message.tag == "value" and float(message.get("age", "0")) < HISTORY_S:  # `events` shows the older ones
                    self._on_event(event_line(message), message.findtext("level") or "")

    async def _learn(self, link: Link) -> None:
        """What there is, for completion."""
        known: dict[str, dict[str, str]] = {"topic": dict.fromkeys(ALIASES, "")}
        for item in await link.request("describe"):
            kind, name = item.get("kind", ""), item.get("name", "")
            known.setdefault(kind, {})[name] = item.findtext("doc") or ""
            if kind == "node":
                inputs = [port for port in item.iter("field") if port.get("direction") != "out"]
                known[f"port {name}"] = {f"{port.get('name')}=": port.get("doc") or "" for port in inputs}
        known["module"] = {module.get("name", ""): module.get("state", "") for module in await link.request("modules")}
        known["mission"] = {mission.get("name", ""): "" for mission in (await link.request("mission", op="list")).iter("mission")}
        self.names = known

    async def _mind(self, link: Link) -> None:
        """Notice the end of the connection."""
        await link.lost.wait()
        self._lost_s = self._now_s()
        self._on_event(f"connection lost: {link.fault.code}: {link.fault.text}", "error")


async def _until_lost(work: Coroutine[Any, Any, None]) -> None:
    with suppress(GatewayError):
        await work
