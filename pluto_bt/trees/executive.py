"""The executive: one mission at a time, ticked, paused, resumed, stopped; it decides nothing that the tree does not decide.

Start reading at `Executive.step`.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from typing import Protocol

from pluto_bt.trees.errors import TickError
from pluto_bt.trees.mission import Mission

IDLE, RUNNING, PAUSED, SUCCEEDED, FAILED, ABORTED = "idle", "running", "paused", "succeeded", "failed", "aborted"


class Body(Protocol):
    """What the executive needs of the robot."""

    def refresh(self, now_s: float) -> None:
        """Take one consistent view of all topics for the coming tick."""

    def stop(self) -> None:
        """Zero velocity at once."""


class Executive:
    """Holds a mission and its state. Orders (start, pause, …) come from any thread and take effect at the next step."""

    def __init__(self, body: Body, on_event: Callable[[str, str, str], None]) -> None:
        self._body = body
        self._say = on_event  # (level, code, text)
        self._orders: deque[Callable[[], None]] = deque()
        self._lock = threading.Lock()
        self.mission: Mission | None = None
        self.state = IDLE
        self.reason = ""
        self.run = 0
        self.ticks = 0
        self.error: TickError | None = None

    def step(self, now_s: float) -> bool:
        """One turn: orders, a fresh view, one decision. True if the tree was ticked."""
        self._take_orders()
        if self.state != RUNNING or self.mission is None:
            return False
        self._body.refresh(now_s)
        self._tick(self.mission)
        return True

    def start(self, mission: Mission) -> None:
        """Run `mission` from its beginning at the next step."""
        self._order(lambda: self._start(mission))

    def pause(self, reason: str) -> None:
        """Stop the robot now; the mission waits until `resume`."""
        self._body.stop()
        self._order(lambda: self._pause(reason))

    def resume(self) -> None:
        """Let a paused mission go on: its leaves start again where the tree stands."""
        self._order(self._resume)

    def abort(self, reason: str) -> None:
        """Stop the robot now and end the mission."""
        self._body.stop()
        self._order(lambda: self._end(ABORTED, reason))

    @property
    def is_over(self) -> bool:
        """True once a mission has ended and none has been started since."""
        return self.state in (SUCCEEDED, FAILED, ABORTED)

    def _order(self, order: Callable[[], None]) -> None:
        with self._lock:
            self._orders.append(order)

    def _take_orders(self) -> None:
        while self._orders:
            with self._lock:
                order = self._orders.popleft()
            order()

    def _start(self, mission: Mission) -> None:
        if self.mission is not None and self.state in (RUNNING, PAUSED):
            self._end(ABORTED, "preempted")
        self.mission, self.error = mission, None
        self.run += 1
        self.ticks = 0
        self.state, self.reason = RUNNING, ""

    def _pause(self, reason: str) -> None:
        if self.state == RUNNING:  # the tree keeps its place; motion leaves command again when they are next ticked
            self.state, self.reason = PAUSED, reason
            self._say("warning", reason, f"mission paused: {reason}")

    def _resume(self) -> None:
        if self.state == PAUSED:
            self.state, self.reason = RUNNING, ""
            self._say("info", "resumed", "mission goes on")

    def _end(self, state: str, reason: str) -> None:
        if self.state in (RUNNING, PAUSED) and self.mission is not None:
            self.mission.halt()
            self.state, self.reason = state, reason

    def _tick(self, mission: Mission) -> None:
        self.ticks += 1
        try:
            status = mission.tick_once()
        except TickError as error:
            self.error = error
            self._body.stop()
            self.state, self.reason = FAILED, "leaf-error"
            self._say("error", "leaf-error", str(error))
            return
        if status == "SUCCESS":
            self.state, self.reason = SUCCEEDED, ""
        elif status in ("FAILURE", "SKIPPED"):
            self.state = FAILED
            self.reason = mission.deciding_reason() or ("skipped" if status == "SKIPPED" else "failed")
