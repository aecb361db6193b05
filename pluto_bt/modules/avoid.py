"""The module `avoid`: joins the avoidance skill to its inbox, the sensors' and localisation's topics, and drive."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from pluto_bt.blackboard.codes import GotoStatus, LinkStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, LaserScan, Pose
from pluto_bt.blackboard.poses import pose_at
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import RELEASE, Link, below, newest
from pluto_bt.modules.mount import LaserMount
from pluto_bt.skills import reasons
from pluto_bt.skills.avoid import Avoid as Skill
from pluto_bt.skills.avoid import AvoidParameters, AvoidSenses
from pluto_bt.skills.drive import DriveParameters
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.passers_by import PassersBy
from pluto_bt.skills.sight import ScanView
from pluto_bt.skills.verdict import Verdict
from pluto_bt.skills.wall_parameters import WallParameters

if TYPE_CHECKING:
    from pluto_bt.modules.robot_file import RobotFile

DEAD_RECKONING = "Localization/Dead-Reckoning"
BUMPERS = (LinkStatus.FRONT_BUMPER, LinkStatus.BACK_BUMPER)


class Avoid:
    """Steps at 10 Hz, and at once when a command comes."""

    def __init__(self, context: Context) -> None:
        platform = context.platform
        self._link = Link(context, "avoid", "avoidance")
        self._board, self._clock = context.board, context.clock
        self._drive = context.inboxes["drive"]
        self._parameters = context.parameters(AvoidParameters)
        self._skill = Skill(platform, self._parameters, context.parameters(DriveParameters), context.parameters(WallParameters))
        self._mount = LaserMount(context.board, platform)
        self._drive_status, self._drive_command = below(context, "drive")
        self._pose, self._dead = newest(context, "Localization/Pose"), newest(context, DEAD_RECKONING)
        self._raw, self._sonar = newest(context, "ATRV2/Drive/Raw"), newest(context, "ATRV2/Sonar")
        self._scan, self._check = newest(context, "sick/scan"), newest(context, "Localization/Check")
        self._view: ScanView | None = None
        self._sent: ActuatorState | None = None
        self._passers_by, self._bumper = PassersBy(), newest(context, "ATRV2/Bumper")

    def start(self, now_s: float) -> None:
        """Begin without a command."""
        if not self._link.is_running:
            self._skill.reset()
            self._view = self._sent = None
            self._link.start()

    def tune(self, robot: RobotFile) -> None:
        """Parameters have changed."""
        self._parameters = robot.avoid
        self._skill.tune(robot, robot.avoid, robot.drive, robot.wall)

    def step(self, now_s: float) -> None:
        """Take a command, look around, command drive, tell the status."""
        letter = self._link.letter()
        if letter is not None and letter.is_stop:
            self._drive.stop("avoid", now_s)
            self._skill.stop(letter.command)
            self._sent = None
        if not self._link.is_running:
            self._link.tell(now_s, self._rest(now_s), letter.command if letter is not None and letter.is_stop else None)
            return
        if letter is not None and not letter.is_stop:
            if letter.command.flags == RELEASE:
                self._halt(now_s)
                self._link.release()
                self._link.tell(now_s, self._rest(now_s), letter.command)
                return
            self._skill.accept(letter.command, now_s)
        status: FVectorState | None = self._drive_status()
        has_it = letter is None and self._drive_has_it()  # a goto posts anew in each cycle, so ask before: drive tells of the last cycle's
        command = self._skill.step(now_s, self._senses(now_s, status))
        if command is not None:
            if letter is None and self._sent is not None and status is not None and status.element[0] in BUMPERS:
                command = msgspec.structs.replace(command, stamp_s=self._sent.stamp_s)  # no new order: that would open the bumper's latch
            self._drive.post("avoid", command)
            self._sent = command
        has_it = has_it or self._drive_has_it()
        self._link.tell(now_s, self._skill.status(now_s, status, has_it), None if letter is None else letter.command)

    def _drive_has_it(self) -> bool:
        """True if drive has accepted the last command that went down."""
        return self._sent is None or bool(self._drive_command() == self._sent)

    def stop(self) -> None:
        """The thread stops: zero velocity below, and -10 for who asks."""
        now_s = self._clock.now_s()
        if self._link.is_running:
            self._halt(now_s)
        self._link.is_running = False
        self._link.tell(now_s, self._rest(now_s))

    def _halt(self, now_s: float) -> None:
        self._drive.stop("avoid", now_s)  # not `post`: a link that is being stopped may already have lost its inbox to the lease holder

    def _senses(self, now_s: float, drive: FVectorState | None) -> AvoidSenses:
        data = STILL if drive is None else drive.data
        oldest_s = now_s - self._parameters.pose_stale_s
        raw = self._raw()
        self._passers_by.note(now_s, drive, raw, self._bumper())
        raw_rad = raw.position[1] if raw is not None and raw.stamp_s >= oldest_s else None
        pose, dead = _planar(self._pose(), oldest_s), _planar(self._dead(), oldest_s)
        check: FVectorState | None = self._check()
        stand = drive is not None and drive.reason == reasons.ODOMETRY_FROZEN
        walkers = self._passers_by.are_awaited(now_s)
        senses = AvoidSenses(pose, dead, raw_rad, (data[0], data[1]), self._newest_view(), self._sonar(), walkers, stand)
        if check is None or check.reason not in reasons.PLACELESS:
            return senses
        return senses._replace(pose=None, no_pose=Verdict(reason=check.reason, text=check.text))

    def _newest_view(self) -> ScanView | None:
        """The newest scan with the place it was taken from, worked out once."""
        scan: LaserScan | None = self._scan()
        if scan is None:
            return None
        if self._view is None or self._view.scan is not scan:
            at = pose_at(self._board, DEAD_RECKONING, scan.stamp_s)
            self._view = self._mount.view(scan, None if at is None else (at.pose[0], at.pose[1], at.pose[3]))
        return self._view

    def _rest(self, now_s: float) -> FVectorState:
        element = (int(LinkStatus.STOPPED_THREAD), int(GotoStatus.STOPPED_THREAD))
        return FVectorState(now_s, STILL, element, reasons.STOPPED, "the avoidance thread is stopped")


def _planar(pose: Pose | None, oldest_s: float) -> Planar | None:
    return None if pose is None or pose.stamp_s < oldest_s else (pose.pose[0], pose.pose[1], pose.pose[3])
