"""The module `filter`: the stop filter between drive and base. It reads latch and sensors itself, and alone posts to the base."""

from __future__ import annotations

import math

from pluto_bt.blackboard.inbox import Letter
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, LaserScan, Pose, SonarState
from pluto_bt.blackboard.poses import pose_at
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import newest
from pluto_bt.modules.mount import LaserMount
from pluto_bt.skills import reasons
from pluto_bt.skills.filter_parameters import FilterParameters
from pluto_bt.skills.limits import STILL, Twist
from pluto_bt.skills.map_area import MapArea
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.scan_watch import Lack
from pluto_bt.skills.stop_filter import FilterSenses, StopFilter
from pluto_bt.skills.verdict import ALL_WELL, Verdict

DEAD_RECKONING = "Localization/Dead-Reckoning"
IDLE_S = 0.06  # a turn of its own comes only when no command came for so long


class Filter:
    """Steps at once when a command comes, and by itself when none does."""

    def __init__(self, context: Context) -> None:
        self._context, self._board, self._clock, self._latch = context, context.board, context.clock, context.latch
        self._inbox, self._base = context.inboxes["filter"], context.inboxes["base"]
        self.skill = StopFilter(context.platform, context.parameters(FilterParameters), MapArea.of(context.map))
        self._mount = LaserMount(context.board, context.platform)
        self._status = context.board.publisher("filter/status", "filter")
        self._raw, self._bumper = newest(context, "ATRV2/Drive/Raw"), newest(context, "ATRV2/Bumper")
        self._dead, self._pose = newest(context, DEAD_RECKONING), newest(context, "Localization/Pose")
        self._scan_topic, self._sonar_topic = newest(context, "sick/scan"), newest(context, "ATRV2/Sonar")
        self._check, self._was_lost, self._doubt = newest(context, "Localization/Check"), False, ALL_WELL
        self._scan: LaserScan | None = None
        self._laser: tuple[Planar | None, float, Lack] = (None, 0.0, Lack.NOTHING)
        self._sonar: SonarState | None = None
        self._sonar_at: Planar | None = None
        self._wanted: Twist = STILL
        self._commanded_s = -math.inf
        self._stepped_s = -math.inf

    def start(self, now_s: float) -> None:
        """At rest, without a command. What was posted before is out of date, but for a stop."""
        self._wanted, self._stepped_s = STILL, -math.inf
        letter = self._inbox.take()
        if letter is not None and letter.is_stop:
            self._base.stop("filter", now_s)

    def stop(self) -> None:
        """Nothing passes a filter that does not run."""
        self._base.stop("filter", self._clock.now_s())

    def step(self, now_s: float) -> None:
        """Take the command, look, let through what may pass."""
        letter = self._inbox.take()
        if letter is None and self._latch.held is None and now_s - self._commanded_s < IDLE_S:
            return
        if letter is not None and not letter.is_stop and now_s == self._stepped_s and letter.command.velocity == self._wanted:
            return  # the drive says the same thing twice at one moment
        if letter is not None:
            self._wanted, self._commanded_s = STILL if letter.is_stop else letter.command.velocity, now_s
        self._look_at_check()
        senses = self._senses()
        if now_s > self._stepped_s:  # two commands of one moment need one look
            self.skill.look(now_s, senses)
        self._stepped_s = now_s
        held = self._held(letter, now_s)
        out = self.skill.step(self._wanted, now_s, senses) if held is None else self.skill.hold(held)
        if letter is not None and letter.is_stop:
            self._base.stop("filter", now_s)
        else:
            self._base.post("filter", ActuatorState(now_s, 0, (0.0, 0.0), out))
        self._status.put(self.skill.status(now_s), now_s)

    def _look_at_check(self) -> None:
        """Carried to another place, what was seen round the robot is not there. Then, and while a sensor is silent, nobody knows a car's place."""
        check: FVectorState | None = self._check()
        is_lost = check is not None and check.reason == reasons.LOST
        is_doubtful = is_lost or (check is not None and check.reason in (reasons.GYRO_STALE, reasons.SPEED_STALE))
        self._doubt = Verdict(reason=check.reason, text=check.text) if check is not None and is_doubtful else ALL_WELL
        if is_lost and not self._was_lost:
            self.skill.forget()
        self._was_lost = is_lost

    def _held(self, letter: Letter | None, now_s: float) -> Verdict | None:
        """Why nothing passes, whatever the sensors say."""
        hold = self._latch.held
        if hold is not None:
            self._wanted = STILL  # a release must not bring an old command back
            return Verdict(reason=hold.word, text=hold.text)
        if letter is not None and letter.is_stop:
            return Verdict(reason=reasons.STOPPED, text="stop was commanded")
        if not math.isfinite(self._wanted[0] + self._wanted[1]):
            return Verdict(reason=reasons.BAD_COMMAND, text=f"({self._wanted[0]}, {self._wanted[1]}) is no velocity")
        stale_s = self.skill.parameters.command_stale_s
        if self._wanted != STILL and now_s - self._commanded_s > stale_s:
            self._wanted = STILL
            return Verdict(reason=reasons.COMMAND_TIMEOUT, text=f"no command from above for {stale_s:g} s")
        return None

    def _senses(self) -> FilterSenses:
        dead: Pose | None = self._dead()
        pose: Pose | None = self._pose()
        self._find_scan()
        self._find_sonar(dead)
        return FilterSenses(
            self._raw(), None if dead is None else (dead.stamp_s, _planar(dead)), None if pose is None else (pose.stamp_s, _planar(pose)),
            self._scan, *self._laser, self._sonar, self._sonar_at, self._bumper(), self._context.silent_s("executive"), self._doubt,
        )  # fmt: skip

    def _find_scan(self) -> None:
        """The newest scan with the place it was taken from, worked out once."""
        scan: LaserScan | None = self._scan_topic()
        if scan is None or scan is self._scan:
            return
        at = pose_at(self._board, DEAD_RECKONING, scan.stamp_s)
        view = self._mount.view(scan, None if at is None else _planar(at))
        self._scan, self._laser = scan, (view.laser, view.tilt_rad, view.lacks)

    def _find_sonar(self, dead: Pose | None) -> None:
        sonar: SonarState | None = self._sonar_topic()
        if sonar is None or sonar is self._sonar or dead is None:
            return
        at = pose_at(self._board, DEAD_RECKONING, sonar.stamp_s)
        self._sonar, self._sonar_at = sonar, _planar(dead if at is None else at)


def _planar(pose: Pose) -> Planar:
    return pose.pose[0], pose.pose[1], pose.pose[3]
