"""LookAround and SweepWrist: active scanning. The wrist shows the laser the sides and the ground; what it sees stays in the local map."""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar, Final, NamedTuple

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.paths import SIDES
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, LaserScan, Pair
from pluto_bt.skills import reasons

THERE_RAD: Final = math.radians(2.0)
RATE_DPS: Final = 60.0
ACCELERATION_DPS2: Final = 120.0
PATIENCE_S: Final = 4.0  # a wrist that does not get there keeps nobody waiting longer
STILL_MPS, STILL_RADPS = 0.02, 0.03
HOLD_S: Final = 1.0
AMONG_PEOPLE_S: Final = 10.0  # so long after the stop filter held for a walker, a sweep leaves the sides alone …
LOOKS_AHEAD: Final = 5  # … and looks ahead so many times for each look down
SLOW_DPS: Final = 8.0  # what lies low is met by the plane of the laser only between its height over the ground and the ground …
NEAREST_DEG: Final = 28.0  # who stands and looks to both sides may not know the ground before his feet
NEAR: Final = 1.4  # … so a look at the ground begins so many times as far down, and rises slowly over all of it


class Look(NamedTuple):
    """Where the laser is pointed, and how fast it goes there."""

    pan_rad: float
    tilt_rad: float
    rate_dps: float = RATE_DPS


AHEAD: Final = Look(0.0, 0.0)


def ground(tilt_rad: float, steepest_rad: float) -> list[Look]:
    """A look over the ground ahead, from near to as far as `tilt_rad` meets it; none where that is 0."""
    near = [Look(0.0, steepest_rad)] if steepest_rad > tilt_rad else []
    return [*near, Look(0.0, tilt_rad, SLOW_DPS if near else RATE_DPS)] if tilt_rad > 0.0 else []


class WristTour(RobotLeaf):
    """Points the laser from one target to the next; at each one scan has to arrive that was taken there."""

    def initialise(self) -> None:
        """From the beginning."""
        self._targets = self.targets()
        self._next, self._since_s, self._there_s = -1, self.now_s(), math.inf
        self._has_pointed = False

    @abstractmethod
    def targets(self) -> list[Look]:
        """One after the other."""

    def go_on(self, robot: Robot) -> bool:
        """Go on with the tour; True when it is over."""
        now_s = self.now_s()
        robot.surroundings.look(robot, now_s)
        if self._next < 0 or self._is_seen(robot, now_s):
            self._next += 1
            if self._next >= len(self._targets):
                return True
            self._since_s, self._there_s = now_s, math.inf
            self._point(robot, self._targets[self._next])
        return False

    def terminate(self, new_status: Status) -> None:
        """The laser looks ahead again: also between two rounds, and after the last, when there is no next target."""
        robot = self.robot
        if robot is not None and self._has_pointed:
            self._point(robot, AHEAD)

    def _is_seen(self, robot: Robot, now_s: float) -> bool:
        state, scan = robot.newest("wrist/state"), robot.newest("sick/scan")
        target: Pair = self._targets[self._next][:2]
        at: Pair = state.position if isinstance(state, ActuatorState) else AHEAD[:2]  # without a wrist the laser always looks ahead
        is_there = max(abs(at[i] - target[i]) for i in (0, 1)) < THERE_RAD
        if is_there and self._there_s == math.inf:
            self._there_s = now_s
        return (isinstance(scan, LaserScan) and scan.stamp_s >= self._there_s) or now_s - self._since_s > PATIENCE_S

    def _point(self, robot: Robot, look: Look) -> None:
        wrist = robot.platform.devices.wrist
        if wrist is not None:
            self._has_pointed = True
            rate_dps, acceleration_dps2 = min(look.rate_dps, wrist.max_rate_dps), min(ACCELERATION_DPS2, wrist.max_acceleration_dps2)
            robot.point_wrist(look.pan_rad, look.tilt_rad, math.radians(rate_dps), math.radians(acceleration_dps2))


class LookAround(WristTour):
    """Waits until the robot stands, then looks to the sides and to the ground ahead. A robot without a wrist only looks ahead."""

    INPUT_PORTS = {
        "side": Port(str, False, "where to look; `none` = only ahead", "both", choices=SIDES),
        "pan_deg": Port(float, False, "how far to the sides, at most as far as the wrist goes", 55.0, unit="deg", ge=0.0, le=180.0),
        "tilt_deg": Port(float, False, "how far down", 10.0, unit="deg", ge=0.0, le=90.0),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """Nothing is held yet."""
        super().initialise()
        self._held_s = -math.inf

    def targets(self) -> list[Look]:
        """The sides, the ground, and ahead."""
        wrist = self.robot.platform.devices.wrist if self.robot is not None else None
        if wrist is None or self.get_input("side") == "none":
            return [AHEAD]
        pan = math.radians(min(float(self.get_input("pan_deg")), wrist.pan_limit_deg))
        tilt = math.radians(min(float(self.get_input("tilt_deg")), wrist.tilt_limit_deg))
        side = self.get_input("side")
        panned = [Look(angle, 0.0) for angle, word in ((pan, "left"), (-pan, "right")) if side in (word, "both")]
        nearest = math.radians(min(NEAREST_DEG, wrist.tilt_limit_deg)) if side == "both" else NEAR * tilt
        return [*panned, *ground(tilt, max(tilt, nearest)), AHEAD]

    def act(self, robot: Robot) -> Status:
        """Stand, look, done."""
        self._hold(robot)
        if self._next < 0 and self._moves(robot) and self.now_s() - self._since_s < PATIENCE_S:
            robot.surroundings.look(robot, self.now_s())
            return self.wait("coming to rest")
        return self.succeed("looked around") if self.go_on(robot) else self.wait("looking around")

    def _moves(self, robot: Robot) -> bool:
        raw = robot.newest("ATRV2/Drive/Raw")
        return isinstance(raw, ActuatorState) and (abs(raw.velocity[0]) > STILL_MPS or abs(raw.velocity[1]) > STILL_RADPS)

    def _hold(self, robot: Robot) -> None:
        """Command the robot to stand, again and again, so that drive does not time out."""
        if self.now_s() - self._held_s >= HOLD_S:
            self._held_s = self.now_s()
            robot.command(0)


class SweepWrist(WristTour):
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
        super().initialise()

    def targets(self) -> list[Look]:
        """Left, down, right, down, as far as each is asked for; among people down, and ahead for a while."""
        wrist = self.robot.platform.devices.wrist if self.robot is not None else None
        if wrist is None:
            return []
        pan = math.radians(min(float(self.get_input("pan_deg")), wrist.pan_limit_deg))
        tilt = math.radians(min(float(self.get_input("tilt_deg")), wrist.tilt_limit_deg))
        if self.now_s() - self._walker_s < AMONG_PEOPLE_S:
            return [*ground(tilt, tilt), *[AHEAD] * LOOKS_AHEAD]
        down = ground(tilt, min(NEAR * tilt, math.radians(wrist.tilt_limit_deg)))
        return [Look(pan, 0.0), *down, Look(-pan, 0.0), *down] if pan > 0.0 else [*down, AHEAD]

    def act(self, robot: Robot) -> Status:
        """One round after the other."""
        rounds = int(self.get_input("rounds"))
        if robot.platform.devices.wrist is None:
            if not self.get_input("optional"):
                return self.fail("no-device", self.lacks(robot.platform.devices))
            return self.wait("no wrist") if rounds < 0 else self.succeed("no wrist")
        if self._rounds == rounds:
            return self.succeed(f"{rounds} rounds")
        held = robot.newest("filter/status")
        if isinstance(held, FVectorState) and held.reason == reasons.WALKER:
            self._walker_s = self.now_s()
        if self.go_on(robot):
            self._rounds, self._next, self._targets = self._rounds + 1, -1, self.targets()
        return self.succeed(f"{rounds} rounds") if self._rounds == rounds else self.wait("sweeping")
