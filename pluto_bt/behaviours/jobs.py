"""The complex jobs of motion as leaves of a mission: MoveTo (42), Investigate (43), Explore (44), Resume (45), SetRectangle (46).

Each posts one command; motion runs the library tree of the job, the same as for a raw command, and its status says how it stands.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import AVOIDANCE, MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.codes import MotionCommand, MotionStatus, MovetoStatus, code_name
from pluto_bt.blackboard.messages import FVectorState, JobState, Pair

DONE: Final = (MovetoStatus.AT_GOAL, MovetoStatus.INVESTIGATE_DONE)
AT_REST: Final = (MotionStatus.AT_REST, MotionStatus.AT_REST_WITH_RECTANGLE)


class JobLeaf(MotionLeaf):
    """Orders a job and watches it. After a pause it goes on where it was, with what it has seen and explored."""

    DEVICES: ClassVar = ("laser",)

    @abstractmethod
    def order(self, robot: Robot) -> tuple[MotionCommand, Pair, Pair]:
        """(cmdFlags, position, velocity) of the command."""

    def begin(self, robot: Robot) -> Status | None:
        """Post the command; `force[1..2]` carry the speed limit and A."""
        self._number = 0
        flags, position, velocity = self.order(robot)
        if not all(map(math.isfinite, (*position, *velocity))):
            return self.fail("bad-command", f"{(*position, *velocity)} is not all finite")
        self._post_job(robot, flags, position, velocity)
        return None

    def resume(self, robot: Robot) -> None:
        """45, if motion still keeps our job; else from the beginning."""
        if self._ticket is None:
            return
        job, command = robot.newest("motion/job"), self._ticket.command
        is_ours = isinstance(job, JobState) and job.number == self._number
        self._was_accepted, self._posted_s = False, self._last_s
        self._post_job(robot, MotionCommand.RESUME if is_ours else MotionCommand(command.flags), command.position, command.velocity)

    def follow(self, robot: Robot) -> Status:
        """Done, failed, or at work."""
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        if status is None:
            return self.wait("ordering the job")
        return self._judge(robot, status)

    def _patience(self, word: str, text: str) -> Status | None:
        """What holds the robot back for a while is for the tree of the job to judge; only a chain that is stopped ends the leaf."""
        return super()._patience(word if word == "chain-stopped" else "", text)

    def _judge(self, robot: Robot, status: FVectorState) -> Status:
        moveto, motion = status.element[2], status.element[3]
        if motion in AT_REST:
            if moveto in DONE:
                return self.succeed(code_name(MovetoStatus(moveto)))
            return self.fail(status.reason or "cancelled", status.text)
        job = robot.newest("motion/job")
        if isinstance(job, JobState):
            self._number = job.number
        phase = MotionStatus(motion) if motion in tuple(MotionStatus) else MotionStatus.AT_REST
        return self.wait(code_name(phase))

    def _post_job(self, robot: Robot, flags: MotionCommand, position: Pair, velocity: Pair) -> None:
        avoid = AVOIDANCE[self.get_input("avoid")]
        if self._ticket is None or self._was_accepted:
            self._posted_s = self._last_s
        self._moves, self._was_accepted = True, False
        self._ticket = robot.command(int(flags), position, velocity, 0.0, (0.0, self.max_speed_mps(robot), float(avoid)))


class MoveTo(JobLeaf):
    """Drives to `goal` by ray following: along open paths in the middle of the street. Fails with `no-path` where there is none."""

    WAY: ClassVar = "found"
    INPUT_PORTS = {"goal": Port(tuple[float, float], True, "where to", unit="m"), **MOTION_INPUTS}
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def order(self, robot: Robot) -> tuple[MotionCommand, Pair, Pair]:
        """42 with the goal."""
        return MotionCommand.MOVETO, self.get_input("goal"), (0.0, 0.0)


class Explore(JobLeaf):
    """Explores the rectangle in front of the robot: `b` to either side, `h` deep; then comes home to where it began."""

    INPUT_PORTS = {
        "rectangle": Port(tuple[float, float], True, '"b;h": half the width of the base, and the depth', unit="m", ge=0.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def order(self, robot: Robot) -> tuple[MotionCommand, Pair, Pair]:
        """44 with b and h; home is where the robot is."""
        return MotionCommand.EXPLORE, (0.0, 0.0), self.get_input("rectangle")


class Investigate(JobLeaf):
    """Drives to the closest object, unfolds the arm, and circles it at `radius_m` from its middle. Fails with `no-object` without one."""

    INPUT_PORTS = {
        "radius_m": Port(float, False, "distance to the middle of the object", 2.5, unit="m", ge=0.1),
        "turns": Port(float, False, "how many times around", 1.0, ge=0.05, le=100.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def order(self, robot: Robot) -> tuple[MotionCommand, Pair, Pair]:
        """43 with radius and turns."""
        return MotionCommand.INVESTIGATE, (0.0, 0.0), (float(self.get_input("radius_m")), float(self.get_input("turns")))


class Resume(JobLeaf):
    """Goes on with the job that was stopped; with none, explores the rectangle that is set. Fails with `nothing-to-resume`."""

    INPUT_PORTS = dict(MOTION_INPUTS)
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def order(self, robot: Robot) -> tuple[MotionCommand, Pair, Pair]:
        """45."""
        return MotionCommand.RESUME, (0.0, 0.0), (0.0, 0.0)


class SetRectangle(MotionLeaf):
    """Sets the rectangle that limits MoveTo, Explore and Investigate: `b` to either side of `home`, `h` deep; b = 0 removes it."""

    DRIVES: ClassVar = False
    INPUT_PORTS = {
        "rectangle": Port(tuple[float, float], True, '"b;h": half the width of the base, and the depth', unit="m", ge=0.0),
        "home": Port(tuple[float, float, float], False, '"x;y;theta_deg": middle of the base, looking into it', (0.0, 0.0, 0.0)),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """46; nothing moves by it."""
        x, y, theta_deg = self.get_input("home")
        sides: Pair = self.get_input("rectangle")
        if not all(map(math.isfinite, (x, y, theta_deg, *sides))):
            return self.fail("bad-command", "a rectangle is made of finite numbers")
        self._ticket = robot.command(int(MotionCommand.SET_RECTANGLE), (x, y), sides, 0.0, math.radians(theta_deg))
        return None

    def follow(self, robot: Robot) -> Status:
        """Done when motion has taken it."""
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        return self.wait("setting the rectangle") if status is None else self.succeed("rectangle set")

    def resume(self, robot: Robot) -> None:
        """Once is enough."""
