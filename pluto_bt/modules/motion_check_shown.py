"""The cross-check of gyro, wheels and laser as part of `local`: feeds it level scans, tells its findings, shows it in `Localization/Check`."""

from __future__ import annotations

import numpy as np

from estimation.levelled_scan import levelled
from estimation.motion_check import MotionCheck
from estimation.news import FOUND, LOST, WHEELS_GRIP
from estimation.track import Moment
from pluto_bt.blackboard.messages import FloatArray, FVectorState, LaserScan
from pluto_bt.modules.context import Context
from pluto_bt.modules.laser_poses import Arm
from pluto_bt.modules.tilted_laser import LEVEL_RAD, TiltedLaser
from pluto_bt.skills.reasons import MARKER_STALE, NO_POSE
from pluto_bt.skills.scan_watch import RETURNS, are_same

FINE = (1.0, 0.0, True, False, False)
AGREED, CORRECTED, IS_LOST, SILENT = 0, 1, 2, 3  # element[0] of the topic
SETTLING = "the heading was wrong and is being put right"
MOST_PAN_RAD = 0.15  # from scan to scan: while the wrist moves faster its angle is not exact enough


class MotionCheckShown:
    """`Localization/Check` on each change: element[0] 0 the witnesses agree, 1 one is corrected, 2 lost, 3 one is silent.

    Its data are grip, drift in rad/s, fit.
    """

    def __init__(self, context: Context, check: MotionCheck) -> None:
        self._check, self._say = check, context.say
        self._scan = context.board.reader("sick/scan")
        laser = context.platform.devices.laser
        self._max_range_m = laser.max_range_m if laser is not None else 0.0
        self._topic = context.board.publisher("Localization/Check", "local")
        self._word = self._text = self._lost_text = ""
        self._pan_rad = 0.0
        self._tilted = TiltedLaser(context.say)
        self._ranges_m: FloatArray | None = None
        self._shown: tuple[object, ...] | None = None

    def look(self, stamp_s: float, arm: Arm, then: Moment) -> None:
        """Give the scan of that stamp, when the robot was at `then`, to the check, if it is level."""
        sample = self._scan()
        if sample is None or not isinstance(sample.value, LaserScan) or sample.value.stamp_s != stamp_s:
            return
        self._tilted.look(arm.tilt_rad, then.pose_odom)
        scan, last, self._ranges_m = sample.value, self._ranges_m, sample.value.ranges_m
        if last is not None and _has_equal_half(last, scan.ranges_m, self._max_range_m):
            return  # a laser that repeats itself is no witness
        panned_rad, self._pan_rad = abs(arm.pan_rad - self._pan_rad), arm.pan_rad
        if max(abs(then.tilt[0]), abs(then.tilt[1])) > LEVEL_RAD:
            return  # and what the scan before it told still waits to be confirmed
        x, y, z = arm.pose_robot_laser[:3]
        beams, place, is_level = (scan.angle_min_rad, scan.angle_step_rad), (x, y, arm.pan_rad), abs(arm.tilt_rad) <= LEVEL_RAD
        if is_level and panned_rad <= MOST_PAN_RAD:
            self._check.look(stamp_s, scan.ranges_m, *beams, place)
        elif self._check.wants_glance(stamp_s):
            self._check.glance(stamp_s, scan.ranges_m if is_level else levelled(scan.ranges_m, *beams, arm.tilt_rad, z), *beams, place)

    def found(self) -> None:
        """Somebody has posted where the robot is."""
        was_lost = self._check.lost
        self._check.found()
        if was_lost and not self._check.lost:
            self._say("info", "found", "local", "a pose was posted: the robot is not lost any more")

    def tell(self, now_s: float, silence: tuple[str, str] = ("", "")) -> None:
        """Findings to the events, the state to the topic. `silence`: word and sentence of a sensor that says nothing."""
        check = self._check
        for word, text in check.news:
            level = "error" if word == LOST else "info" if word in (WHEELS_GRIP, FOUND) else "warning"
            self._say(level, word, "local", text)
            self._word, self._text = word, text
            self._lost_text = text if word == LOST else self._lost_text
        check.news.clear()
        settles = check.turn.is_settling or now_s < check.turn.rests_until_s
        state = (check.way.grip, check.turn.drift_radps, check.turn.trusts_gyro, check.lost, settles)
        if (state, silence[0]) == self._shown:
            return
        self._shown = (state, silence[0])
        code, word, text = self._state(state, silence)
        self._topic.put(FVectorState(now_s, (state[0], state[1], check.fits), (code,), word, text), now_s)

    def _state(self, state: tuple[float, float, bool, bool, bool], silence: tuple[str, str]) -> tuple[int, str, str]:
        """Code, word and sentence, the worst first: that nobody knows the place, who is silent, who is corrected."""
        check = self._check
        if check.lost:
            return IS_LOST, LOST, self._lost_text or self._text
        if silence[0] and silence[0] != MARKER_STALE:
            return (IS_LOST if silence[0] == LOST else SILENT), *silence
        if state[4]:
            return CORRECTED, NO_POSE, SETTLING
        if silence[0]:
            return SILENT, *silence
        return (AGREED, "", "") if state == FINE else (CORRECTED, self._word, self._text)


def _has_equal_half(before: FloatArray, now: FloatArray, max_range_m: float) -> bool:
    """True if the beams of one side are exactly those of the scan before, and not because nothing stands there."""
    half = len(now) // 2
    if len(before) != len(now):
        return False
    sides = (slice(None, half), slice(half, None))
    return any(are_same(before[side], now[side]) and np.count_nonzero(now[side] < max_range_m) >= RETURNS for side in sides)
