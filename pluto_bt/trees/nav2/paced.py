"""RateController, DistanceController, SpeedController: the child not in every tick but by time, by way driven, or by speed.

All three tick the child on activation, while it is RUNNING, and when it is due again after its last SUCCESS; between these they are
RUNNING. A parent that resets them makes them begin anew.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections import deque
from typing import Any, ClassVar

from pluto_bt.behaviours.robot import pose_of
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.nav2.goals import GOAL_PORTS, GoalWatch
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import Scope
from pluto_bt.trees.values import DOUBLE, STRING

EARLY_S = 1e-9  # ticks fall on whole multiples of the period, as far as doubles hold them
FRAMES = {
    "global_frame": PortModel("global_frame", kind=STRING, required=False, description="of Nav2; there is one map frame here"),
    "robot_base_frame": PortModel("robot_base_frame", kind=STRING, required=False, description="of Nav2; there is one robot frame here"),
}


class Paced(DecoratorNode):
    """What the three have in common."""

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.scope: Scope | None = None  # set by the loader
        self.is_first = True

    @property
    def robot(self) -> Any:
        """The mission's robot, or None."""
        return self.scope.board.robot if self.scope is not None else None

    def begin(self) -> bool:
        """Activated. False if it cannot work."""
        return True

    @abstractmethod
    def is_due(self) -> bool | None:
        """True if the child's turn has come; None if that cannot be told."""

    def succeeded(self) -> bool:
        """The child has succeeded: from here on it is reckoned. False if that cannot be."""
        return True

    def step(self) -> Result:
        if self.status is IDLE:
            if not self.begin():
                return self._ended(FAILURE)
            self.is_first = True
        start(self)
        due = self.is_due()
        if due is None:
            return self._ended(FAILURE)
        if not (due or self.is_first or self.child.status is RUNNING):
            return RUNNING
        self.is_first = False
        result: Result = self.child.step()
        if result is RUNNING:
            return RUNNING
        if result is SKIPPED:
            return self.skip()
        reset(self.child)
        if result is SUCCESS and not self.succeeded():
            return self._ended(FAILURE)
        return self._ended(result)

    def _ended(self, result: Result) -> Result:
        reset(self.child)
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result


class RateController(Paced):
    """The child again when 1/hz seconds have passed since it last succeeded."""

    PORTS: ClassVar = {"hz": PortModel("hz", kind=DOUBLE, default="10.0", description="how often in a second")}

    def begin(self) -> bool:
        hz = self.read("hz")
        self._period_s = 1.0 / hz if hz > 0.0 else math.inf
        self._since_s = self.context.clock.now_s()
        return True

    def is_due(self) -> bool:
        return self.context.clock.now_s() - self._since_s >= self._period_s - EARLY_S

    def succeeded(self) -> bool:
        self._since_s = self.context.clock.now_s()
        return True


class DistanceController(Paced):
    """The child again when the robot is so far from where it last succeeded; FAILURE without a pose."""

    PORTS: ClassVar = {"distance": PortModel("distance", kind=DOUBLE, default="1.0", description="in m, straight"), **FRAMES}

    def begin(self) -> bool:
        self._distance_m = self.read("distance")
        return self.succeeded()

    def is_due(self) -> bool | None:
        here = self._here()
        return None if here is None or self._from is None else math.dist(here, self._from) >= self._distance_m

    def succeeded(self) -> bool:
        self._from = self._here()
        return self._from is not None

    def _here(self) -> tuple[float, float] | None:
        pose = pose_of(self.robot) if self.robot is not None else None
        return None if pose is None else pose[:2]


class SpeedController(Paced):
    """The child at a rate that grows with the robot's speed; a new goal makes it due at once, at the highest rate."""

    PORTS: ClassVar = {
        "min_rate": PortModel("min_rate", kind=DOUBLE, default="0.1", description="times a second at the lowest speed"),
        "max_rate": PortModel("max_rate", kind=DOUBLE, default="1.0", description="times a second at the highest speed"),
        "min_speed": PortModel("min_speed", kind=DOUBLE, default="0.0", description="in m/s"),
        "max_speed": PortModel("max_speed", kind=DOUBLE, default="0.5", description="in m/s"),
        "filter_duration": PortModel("filter_duration", kind=DOUBLE, default="0.3", description="in s: the speed is the mean over so long"),
        **GOAL_PORTS,
    }

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self._goals = GoalWatch(self)
        self._speeds: deque[tuple[float, float]] = deque()
        self._period_s, self._since_s = math.inf, 0.0

    def begin(self) -> bool:
        self._goals.look()
        self._restart()
        return True

    def is_due(self) -> bool:
        now_s = self.context.clock.now_s()
        self._note_speed(now_s)
        if self._goals.look():
            self._restart()
        due = now_s - self._since_s >= self._period_s - EARLY_S
        if due:
            self._period_s = 1.0 / max(self._rate_hz(), 1e-9)
        return due

    def succeeded(self) -> bool:
        self._since_s = self.context.clock.now_s()
        return True

    def _restart(self) -> None:
        self._period_s = 1.0 / max(self.read("max_rate"), 1e-9)
        self._since_s = self.context.clock.now_s()
        self.is_first = True

    def _note_speed(self, now_s: float) -> None:
        raw = self.robot.newest("ATRV2/Drive/Raw") if self.robot is not None else None
        if isinstance(raw, ActuatorState):
            self._speeds.append((now_s, raw.velocity[0]))
        while self._speeds and now_s - self._speeds[0][0] > self.read("filter_duration"):
            self._speeds.popleft()

    def _rate_hz(self) -> float:
        low, high, slow, fast = (float(self.read(port)) for port in ("min_rate", "max_rate", "min_speed", "max_speed"))
        speed_mps = sum(speed for _, speed in self._speeds) / len(self._speeds) if self._speeds else 0.0
        share = (speed_mps - slow) / (fast - slow) if fast != slow else 1.0
        return max(min(low + share * (high - low), high), low)
