"""The live monitor for Groot2 as a module (`--groot HOST:PORT`): shows the mission that the executive ticks; break-points are not served."""

from __future__ import annotations

import hashlib
import uuid

from pluto_bt.gateway.listen import Address
from pluto_bt.groot.protocol import Desk
from pluto_bt.groot.server import Server
from pluto_bt.groot.snapshot import Shown
from pluto_bt.modules.context import Context
from pluto_bt.runtime.clock import calendar_ns
from pluto_bt.trees.activity import Activity


class Groot:
    """The executive hands over statuses, a thread of its own serves them; a step only tells operators that somebody looks on."""

    def __init__(self, context: Context) -> None:
        """Raises: InputError if the ports cannot be had."""
        asked: Address | None = context.system.options.doors.groot
        assert asked is not None, "made only if it was asked for"
        self._context = context
        self._desk = Desk(context.clock.now_ns, lambda: calendar_ns() // 1000)
        self._seen: tuple[int, str] | None = None
        self._is_told = False
        self._server: Server | None = Server(self._desk, asked.host, asked.port)
        self.address = Address(self._server.host, self._server.port)

    def start(self, now_s: float) -> None:
        """Serve, and look at each tick. Raises: InputError if somebody took the ports while the module was stopped."""
        if self._server is None:
            self._server = Server(self._desk, self.address.host, self.address.port)
        self._seen = None
        self._context.system.executive.on_ticked = self._look
        self._server.start()
        self._context.say("info", "groot", "groot", f"Groot2 can connect to {self.address}")

    def step(self, now_s: float) -> None:
        """Say so when the first client has asked."""
        if self._desk.answered and not self._is_told:
            self._is_told = True
            self._context.say("info", "groot-client", "groot", "a monitor looks on")

    def stop(self) -> None:
        """Free the ports."""
        self._context.system.executive.on_ticked = None
        if self._server is not None:
            self._server.stop()
        self._server = None

    def _look(self, ticked: list[Activity], lines: list[str]) -> None:
        """After a tick, in the thread that ticks: a copy of the statuses if one has changed, and nothing that may wait."""
        mission = self._context.system.executive.core.mission
        line = next((line for activity, line in zip(ticked, lines, strict=True) if activity is mission), None)
        if mission is None or line is None or (mission.number, line) == self._seen:
            return
        self._seen = mission.number, line
        shown = self._desk.shown
        if shown is None or shown.mission is not mission.mission:
            shown = Shown(mission.mission, tree_id(mission))
            self._desk.shown = shown
        shown.after_tick(self._context.clock.now_ns())


def tree_id(activity: Activity) -> bytes:
    """16 bytes that change with the tree and with each run of it: by these a client knows that it must fetch the tree again."""
    mission = activity.mission
    text = f"{activity.number} {mission.name} {[(one.path, one.plan.type_name) for one in mission.nodes()]}"
    return uuid.UUID(bytes=hashlib.sha256(text.encode()).digest()[:16], version=4).bytes
