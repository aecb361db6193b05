"""The module `drive`: joins the drive skill to its inbox, the base's topics and the base."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, cast

import msgspec

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.modules.calibration import CalibratedBase, read_calibration
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import RELEASE, Link, newest
from pluto_bt.skills import reasons
from pluto_bt.skills.drive import Drive as Skill
from pluto_bt.skills.drive import DriveParameters, DriveSenses
from pluto_bt.skills.limits import STILL
from pluto_bt.source import InputError

if TYPE_CHECKING:
    from pluto_bt.modules.robot_file import RobotFile

FILTER_SILENT_S = 0.5  # the filter answers each step of the drive; silent for so long it does not run, and nothing reaches the base
FILTER_SILENT = "the stop filter does not answer: start the module filter"
AMENDER = "avoid"  # only the upper link amends an order: the same stamp as before


class Drive:
    """Steps at 20 Hz, and at once when a command comes."""

    def __init__(self, context: Context) -> None:
        self._link = Link(context, "drive", "drive")
        self._clock = context.clock
        self._base = context.inboxes["filter"]
        self._skill = Skill(context.platform, context.parameters(DriveParameters))
        self._raw = newest(context, "ATRV2/Drive/Raw")
        self._sonar = newest(context, "ATRV2/Sonar")
        self._bumper = newest(context, "ATRV2/Bumper")
        self._filter_status = newest(context, "filter/status")
        self._devices = context.devices
        self._say = context.say
        self._started_s = 0.0

    def start(self, now_s: float) -> None:
        """Calibrate the base; begin at rest, without a command."""
        if not self._link.is_running:
            self._calibrate()
            self._skill.reset()
            self._started_s = now_s
            self._link.start()

    def tune(self, robot: RobotFile) -> None:
        """Parameters have changed."""
        self._skill.tune(robot, robot.drive)

    def step(self, now_s: float) -> None:
        """Take a command, keep the base's velocity up to date, tell the status."""
        letter = self._link.letter()
        if letter is not None and letter.is_stop:
            self._base.stop("drive", now_s)
            self._skill.stop(letter.command)
        if not self._link.is_running:
            self._link.tell(now_s, self._rest(now_s), letter.command if letter is not None and letter.is_stop else None)
            return
        if letter is not None and not letter.is_stop:
            if letter.command.flags == RELEASE:
                self._release(now_s, letter.command)
                return
            last = self._skill.command
            amends = letter.source == AMENDER and last is not None and last.stamp_s == letter.command.stamp_s
            self._skill.accept(letter.command, now_s, amends)
        twist = self._skill.step(now_s, DriveSenses(self._raw(), self._sonar(), self._bumper()))
        self._base.post("drive", ActuatorState(now_s, 0, (0.0, 0.0), twist))
        self._link.tell(now_s, self._status(now_s), None if letter is None else letter.command)

    def stop(self) -> None:
        """The thread stops: zero velocity, and -10 for who asks."""
        now_s = self._clock.now_s()
        self._link.is_running = False
        self._base.stop("drive", now_s)  # not `post`: a link that is being stopped may already have lost its inbox to the lease holder
        self._link.tell(now_s, self._rest(now_s))

    def _status(self, now_s: float) -> FVectorState:
        """The drive's own status; where the stop filter lets less through than the drive gives, its verdict and the velocities it lets through."""
        own, verdict = self._skill.status(now_s), self._filter_status()
        heard_s = self._started_s if verdict is None else max(verdict.stamp_s, self._started_s)
        if not own.reason and now_s - heard_s > FILTER_SILENT_S:
            return msgspec.structs.replace(own, data=STILL, reason=reasons.CHAIN_STOPPED, text=FILTER_SILENT)
        if own.reason or verdict is None or not verdict.reason or verdict.reason == reasons.STOPPED:
            return own
        code = (own.element[0] or verdict.element[0],)
        return msgspec.structs.replace(own, data=verdict.data, element=code, reason=verdict.reason, text=verdict.text)

    def _calibrate(self) -> None:
        """Write the calibration file to the base. It was good when the run began; if it no longer is, the base keeps what it has."""
        file = self._skill.parameters.calibration_file
        if not file:
            return
        try:
            calibration = read_calibration(Path(file), file)
        except InputError as error:
            self._say("error", "bad-calibration", "drive", f"the base keeps its old calibration: {error}")
            return
        cast(CalibratedBase, self._devices["base"]).calibrate(calibration.counts_per_m, calibration.effective_track_m)

    def _release(self, now_s: float, command: ActuatorState) -> None:
        self._base.stop("drive", now_s)
        self._link.release()
        self._link.tell(now_s, self._rest(now_s), command)

    def _rest(self, now_s: float) -> FVectorState:
        return FVectorState(now_s, STILL, (int(LinkStatus.STOPPED_THREAD),), reasons.STOPPED, "the drive thread is stopped")
