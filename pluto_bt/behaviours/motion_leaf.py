"""The life of every leaf that moves the robot: command, watch, let go.

Letting go: whenever the leaf ends or is halted it posts zero velocity. In an inbox the newest command wins, so a motion leaf that
follows in the same tick replaces it, and one moves on without stopping; where none follows, the robot stops.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.patience import Patience
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.reasons import BLIND, WAITING, sentence
from pluto_bt.behaviours.robot import Robot, Ticket, why_no_pose
from pluto_bt.blackboard.codes import Avoidance, LinkStatus, code_name
from pluto_bt.blackboard.messages import BumperState, FVectorState, Pair

AVOIDANCE: Final = {code_name(code): int(code) for code in Avoidance}  # A of cmdFlags = 10*A + T
ACCEPT_S: Final = 1.0  # motion takes a command within one of its steps, 0.1 s

MOTION_INPUTS: Final = {
    "avoid": Port(str, False, "which sensors slow, stop and steer", "both", choices=tuple(AVOIDANCE)),
    "max_speed_mps": Port(float, False, "speed limit; the platform's limit stands above it", 0.5, unit="m/s", ge=0.01),
    "timeout_s": Port(float, False, "fails with `timeout` after so long", math.inf, unit="s", ge=0.0),
}
MOTION_OUTPUTS: Final = {"reason": Port(str, False, "why it failed: a word of the list in docs/reasons.md; empty on success")}


class MotionLeaf(RobotLeaf):
    """A leaf that holds the robot. Subclasses command in `begin` and judge in `follow`.

    Attributes:
        DRIVES: two of these at the same time take the robot from one another; `pluto check` tells it of parallel branches.
        WAY: how the leaf comes to its port `goal`: "straight", "planned" on the map, "found" on the way; "stays" if it stays where it is,
            "asked" if it only asks for the way (leaves that plan); "" else.
        PATIENCE_S: seconds for which it lets the chain wait, where they differ from `WAITING`.
    """

    DRIVES: ClassVar = True
    WAY: ClassVar = ""
    PATIENCE_S: ClassVar[Mapping[str, float]] = {}

    def initialise(self) -> None:
        """Forget the last run; the command itself goes out in the first `update`."""
        self._began = False
        self._resumes = 0
        self._moves = False
        self._ticket: Ticket | None = None
        self._was_accepted = False
        self._heard: FVectorState | None = None
        self._held = ""  # the word for which, by the last status of our command, the chain holds the robot back
        self._waits = Patience()
        self._placeless_since_s = self._placeless_s = -math.inf
        self._start_s = self._last_s = self._posted_s = self.now_s()
        self._timeout_s = float(self.get_input("timeout_s"))

    def act(self, robot: Robot) -> Status:
        """One tick."""
        now_s = self.now_s()
        self._gap_s, self._last_s = now_s - self._last_s, now_s
        was_paused, self._resumes = robot.resumes != self._resumes, robot.resumes
        if not self._began:
            self._began = True
            ended = self.begin(robot)
            return self.wait("starting") if ended is None else self._told(ended)
        if was_paused:  # that time does not count
            self._start_s += self._gap_s
            self._placeless_s = -math.inf
            self.resume(robot)
        if self.elapsed_s >= self._timeout_s:
            return self.fail("timeout", f"{self._timeout_s:g} s are over")
        return self._told(self.follow(robot))

    def _told(self, status: Status) -> Status:
        """While the chain holds the robot back the leaf says with which word and why."""
        if status is Status.RUNNING:
            held = self._heard if self._heard is not None and self._heard.reason else None
            self.reason = "" if held is None else held.reason
            if held is not None:
                self.feedback_message = "; ".join(filter(None, (self.feedback_message, f"{held.reason}: {held.text or sentence(held.reason)}")))
        return status

    def terminate(self, new_status: Status) -> None:
        """Zero velocity, if the robot was told to move."""
        robot = self.robot
        if robot is not None and self._moves:
            robot.command(0)
        self._moves = False

    @abstractmethod
    def begin(self, robot: Robot) -> Status | None:
        """Give the first command. A status ends the leaf at once."""

    @abstractmethod
    def follow(self, robot: Robot) -> Status:
        """Watch, and command again where the leaf must."""

    def resume(self, robot: Robot) -> None:
        """After a pause: command again what stood before it."""
        if self._ticket is not None:
            c = self._ticket.command
            self._was_accepted = False
            self._posted_s = self.now_s()
            self._ticket = robot.command(c.flags, c.position, c.velocity, c.acceleration[0], c.force)

    # ---------------------------------------------------------------- for subclasses

    @property
    def elapsed_s(self) -> float:
        """Seconds since the start, pauses left out."""
        return self._last_s - self._start_s

    def post(
        self,
        robot: Robot,
        kind: int,
        position: Pair = (0.0, 0.0),
        velocity: Pair = (0.0, 0.0),
        tolerance_m: float = 0.0,
        force: float | tuple[float, ...] = 1.0,
        *,
        on_the_way: bool = False,
    ) -> None:
        """Post `10*A + kind` with the avoidance that the port asks for, as far as the platform has the sensors."""
        devices = robot.platform.devices
        has = (Avoidance.SONAR if devices.sonar is not None else 0) | (Avoidance.LASER if devices.laser is not None else 0)
        flags = 10 * (AVOIDANCE[self.avoidance()] & has) + kind
        if self._ticket is None or self._was_accepted:  # else the time without an answer goes on
            self._posted_s = self._last_s
        self._moves, self._was_accepted = True, False
        self._ticket = robot.command(flags, position, velocity, tolerance_m, force, on_the_way=on_the_way)

    def avoidance(self) -> str:
        """Which sensors slow, stop and steer."""
        return str(self.get_input("avoid"))

    def max_speed_mps(self, robot: Robot) -> float:
        """The port's limit, held within the platform's."""
        return min(float(self.get_input("max_speed_mps")), robot.platform.limits.max_speed_mps)

    def chain_status(self, robot: Robot) -> FVectorState | None:
        """What motion says of our command, or None while it has not taken it."""
        if self._ticket is None:
            return None
        status = self._heard = robot.status(self._ticket)
        if status is not None:
            self._was_accepted, self._held = True, _waiting_word(status)
        return status

    def chain_trouble(self, robot: Robot, status: FVectorState | None) -> Status | None:
        """FAILURE if the chain cannot carry out the command, at once or after the patience that the word deserves; else None."""
        if self._ticket is not None and self._ticket.refused:
            return self.fail(self._ticket.refused, "motion's inbox belongs to another")
        if status is None:
            if self._was_accepted:
                return self._replaced(robot)
            if self._last_s - self._posted_s > ACCEPT_S:
                return self.fail("chain-stopped", "motion does not take the command; start the module motion, and what it needs")
            return None
        if status.reason == "bad-command":
            return self.fail("bad-command", status.text)
        trouble = self._patience(self._held, status.text)
        if trouble is None and self._held == "bumper" and _is_released(robot):
            self.resume(robot)  # the drive's latch opens with a new command
        return trouble

    @property
    def is_blind(self) -> bool:
        """True while the laser that the command asks for cannot be trusted."""
        return self._held in BLIND

    def placeless(self, robot: Robot) -> Status:
        """One tick in which nobody knows where the robot is: it waits with the pose's own reason, and fails with it after the usual time."""
        if self._placeless_s < self._last_s - self._gap_s:
            self._placeless_since_s = self._last_s
        self._placeless_s = self._last_s
        word, text = why_no_pose(robot)
        if self._last_s - self._placeless_since_s >= WAITING[word]:
            return self.fail(word, text)
        return self.wait(f"{word}: {text}")

    def _replaced(self, robot: Robot) -> Status:
        now = robot.newest("motion/status")
        if isinstance(now, FVectorState) and now.reason == "stopped":
            return self.fail("stopped", now.text)
        return self.fail("cancelled", "another command took its place")

    def _patience(self, word: str, text: str) -> Status | None:
        """Let the chain wait for a while with the same word."""
        waited_s = self._waits.waited_s(word, self._last_s)
        if word and waited_s >= self.PATIENCE_S.get(word, WAITING[word]):
            return self.fail(word, text or sentence(word))
        return None


def _is_released(robot: Robot) -> bool:
    """True if the bumpers are known to be open."""
    bumper = robot.newest("ATRV2/Bumper")
    return isinstance(bumper, BumperState) and not (bumper.front or bumper.back or robot.is_stale("ATRV2/Bumper"))


def _waiting_word(status: FVectorState) -> str:
    """The word for which the chain holds the robot back, if it is one that a leaf waits for; "" else."""
    code = status.element[0]
    if LinkStatus.STOPPED_THREAD in status.element:
        return "chain-stopped"
    if code in (LinkStatus.FRONT_BUMPER, LinkStatus.BACK_BUMPER):
        return "bumper"
    if code == LinkStatus.LASER_FATAL:
        return "laser-fatal"
    if status.reason == "outside-map" and status.data != (0.0, 0.0):
        return ""  # it slows before the edge of its area
    return status.reason if status.reason in WAITING else ""
