"""The base of every leaf of the library: how it meets the mission's clock and robot."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar, Final

from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation

from pluto_bt.behaviours.robot import Robot
from pluto_bt.maps.platform import Devices
from pluto_bt.runtime.clock import MissionClock

NO_PORTS: Final[dict[str, PortInformation]] = {}


class Leaf(BehaviourWithPorts):
    """A leaf with a robot. `reason` holds the word of the last failure (`pluto_bt.behaviours.reasons`), "" else."""

    DEVICES: ClassVar[tuple[str, ...]] = ()  # it needs one of these (names of `Devices`), unless its port `optional` is true

    @classmethod
    def lacks(cls, devices: Devices) -> str:
        """The sentence for a robot that has none of the devices this leaf needs; "" if it has one."""
        if not cls.DEVICES or any(getattr(devices, name) is not None for name in cls.DEVICES):
            return ""
        return f"the platform has {'neither ' if len(cls.DEVICES) > 1 else 'no '}{' nor '.join(cls.DEVICES)}"

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.reason = ""
        self._clock: MissionClock | None = None
        self._store: Any = None

    def setup(self, **mission: Any) -> None:
        """Meet the mission: `clock` and `blackboard`. The robot is looked up at each use, for it may be joined later."""
        self._clock, self._store = mission["clock"], mission["blackboard"]

    @property
    def robot(self) -> Robot | None:
        """The robot, or None where the mission runs without one."""
        robot: Robot | None = getattr(self._store, "robot", None)
        return robot

    def now_s(self) -> float:
        """Seconds of the run. Raises RuntimeError before `setup`."""
        if self._clock is None:
            raise RuntimeError(f"{self.name}: setup(clock=..., blackboard=...) has not been called")
        return self._clock.now_s()

    def fail(self, reason: str, text: str) -> Status:
        """FAILURE with a word of the list and a short sentence."""
        self.reason = reason
        self.feedback_message = f"{reason}: {text}" if text else reason
        if "reason" in self.output_ports():
            self._set_output("reason", reason)
        return Status.FAILURE

    def succeed(self, text: str = "") -> Status:
        """SUCCESS; the reason is empty."""
        self.reason = ""
        self.feedback_message = text
        if "reason" in self.output_ports():
            self._set_output("reason", "")
        return Status.SUCCESS

    def wait(self, text: str) -> Status:
        """RUNNING, with a short text."""
        self.feedback_message = text
        return Status.RUNNING


class RobotLeaf(Leaf):
    """A leaf that can do nothing without a robot: it fails with `not-connected` where there is none."""

    def update(self) -> Status:
        """One tick."""
        robot = self.robot
        return self.fail("not-connected", "no robot") if robot is None else self.act(robot)

    @abstractmethod
    def act(self, robot: Robot) -> Status:
        """One tick, with the robot."""
