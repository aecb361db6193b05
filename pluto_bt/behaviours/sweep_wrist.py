"""SweepWrist: shows the laser the sides and the ground while the robot does something else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.behaviours.wrist_tour import AHEAD, NEAR, Look, WristTour, ground
from pluto_bt.blackboard.messages import FVectorState
from pluto_bt.maps.platform import Wrist
from pluto_bt.skills import reasons

AMONG_PEOPLE_S: Final = 10.0  # so long after the stop filter held for a walker, a sweep leaves the sides alone …
LOOKS_AHEAD: Final = 5  # … and looks ahead so many times for each look down


class SweepWrist(RobotLeaf):
    """Sweeps the laser to both sides and down to the ground, `rounds` times; does not touch the wheels. Among people it mostly looks ahead: where
    the laser did not look just now somebody may be, and the stop filter lets the robot creep there at most."""

    DEVICES: ClassVar = ("wrist",)
    INPUT_PORTS = {
        "pan_deg": Port(float, False, "how far to either side; 0 = not at all", 40.0, unit="deg", ge=0.0, le=180.0),
        "tilt_deg": Port(float, False, "how far down; 0 = not at all", 10.0, unit="deg", ge=0.0, le=90.0),
        "rounds": Port(int, False, "how many times; -1 = until it is halted", 1, ge=-1),
        "optional": Port(bool, False, "true: a robot without a wrist does nothing instead of failing", False),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """From the beginning."""
        self._rounds, self._walker_s = 0, -math.inf
        self._tour: WristTour | None = None

    def act(self, robot: Robot) -> Status:
        """One round after the other."""
        rounds, wrist, now_s = int(self.get_input("rounds")), robot.platform.devices.wrist, self.now_s()
        if wrist is None:
            if not self.get_input("optional"):
                return self.fail("no-device", self.lacks(robot.platform.devices))
            return self.wait("no wrist") if rounds < 0 else self.succeed("no wrist")
        if self._rounds == rounds:
            return self.succeed(f"{rounds} rounds")
        held = robot.newest("filter/status")
        if isinstance(held, FVectorState) and held.reason == reasons.WALKER:
            self._walker_s = now_s
        robot.surroundings.look(robot, now_s)
        if self._tour is None:
            self._tour = WristTour(self._targets(robot, wrist), now_s)
        if self._tour.go_on(robot, now_s):
            self._rounds += 1
            self._tour.again(self._targets(robot, wrist))
        return self.succeed(f"{rounds} rounds") if self._rounds == rounds else self.wait("sweeping")

    def terminate(self, new_status: Status) -> None:
        """The laser looks ahead again: also between two rounds, and after the last, when there is no next target."""
        if self.robot is not None and self._tour is not None:
            self._tour.end(self.robot)

    def _targets(self, robot: Robot, wrist: Wrist) -> Sequence[Look]:
        """Left, down, right, down, as far as each is asked for; among people down, and ahead for a while."""
        pan = math.radians(min(float(self.get_input("pan_deg")), wrist.pan_limit_deg))
        tilt = math.radians(min(float(self.get_input("tilt_deg")), wrist.tilt_limit_deg))
        if self.now_s() - self._walker_s < AMONG_PEOPLE_S:
            return [*ground(tilt, tilt), *[AHEAD] * LOOKS_AHEAD]
        is_quick = robot.surroundings.sees_walkers(self.now_s())  # among them one cannot look away for long
        down = ground(tilt, tilt if is_quick else min(NEAR * tilt, math.radians(wrist.tilt_limit_deg)))
        return [Look(pan, 0.0), *down, Look(-pan, 0.0), *down] if pan > 0.0 else [*down, AHEAD]
