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
from pluto_bt.skills.reasons import NO_POSE
from pluto_bt.skills.scan_watch import RETURNS, are_same

FINE = (1.0, 0.0, True, False, False)
AGREED, CORRECTED, IS_LOST = 0, 1, 2  # element[0] of the topic
SETTLING = "the heading was wrong and is being put right"
MOST_PAN_RAD = 0.15  # from scan to scan: while the wrist moves faster its angle is not exact enough


class MotionCheckShown:
    """`Localization/Check` on each change: element[0] 0 the witnesses agree, 1 one is corrected, 2 lost; data = grip, drift rad/s, fit."""

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
        self._shown: tuple[float, float, bool, bool, bool] | None = None

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

    def tell(self, now_s: float) -> None:
        """Findings to the events, the state to the topic."""
        check = self._check
        for word, text in check.news:
            level = "error" if word == LOST else "info" if word in (WHEELS_GRIP, FOUND) else "warning"
            self._say(level, word, "local", text)
            self._word, self._text = word, text
            self._lost_text = text if word == LOST else self._lost_text
        check.news.clear()
        state = (check.way.grip, check.turn.drift_radps, check.turn.trusts_gyro, check.lost, check.turn.is_settling)
        if state == self._shown:
            return
        self._shown = state
        code = IS_LOST if check.lost else AGREED if state == FINE else CORRECTED
        word, text = (self._word, self._text) if code != AGREED else ("", "")
        if check.lost:
            word, text = LOST, self._lost_text or self._text
        elif check.turn.is_settling:
            word, text = NO_POSE, SETTLING
        self._topic.put(FVectorState(now_s, (state[0], state[1], check.fits), (code,), word, text), now_s)


def _has_equal_half(before: FloatArray, now: FloatArray, max_range_m: float) -> bool:
    """True if the beams of one side are exactly those of the scan before, and not because nothing stands there."""
    half = len(now) // 2
    if len(before) != len(now):
        return False
    sides = (slice(None, half), slice(half, None))
    return any(are_same(before[side], now[side]) and np.count_nonzero(now[side] < max_range_m) >= RETURNS for side in sides)
