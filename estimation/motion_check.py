"""Do gyro, wheels and laser tell of the same motion? Three witnesses; whoever stands alone is not believed.

The laser sees how the robot moved since a scan of a moment ago (`key_scan`), and that is compared with what localisation reckons with: the
turn (`turn_check`), the way (`way_check`), and whether the scan fits at all. One that fits nowhere near, followed by one that fits to it,
was taken in another place, and nobody knows where: the robot is lost until somebody posts where it is. People who stand round it may hide
so much that a scan looks like that too; so the place before is kept, and when it comes into view again, where it must be, nobody is lost.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.carried import Carried
from estimation.doubt import Doubt
from estimation.home_scan import Home
from estimation.kept_scans import KeptScans, held_against, is_far
from estimation.key_scan import MUCH, Beams, KeyScan, difference, is_decisive, is_good, is_odd
from estimation.news import FOUND, LOST, News
from estimation.reckoning import Motion, Reckoning
from estimation.scan_match import ScanStep
from estimation.se2 import Pose2, compose, inverse
from estimation.turn_check import TurnCheck
from estimation.way_check import WayCheck
from estimation.way_trial import LEAST_GAIN, LEAST_M

Array = NDArray[np.float64]

LEAST_BEAMS = 0.75  # of a scan must be numbers
GLANCE_BEAMS, GLANCE_EVERY_S = 72, 0.5  # so many of a tilted one must meet what stands upright; and while nothing is wrong that is enough
KEY_S = 3.0  # a scan is compared with for so long, or until the robot has moved on by about `KEY_WAY_M`
NEAR_KEYS, NEVER_FITS = 1.5, 0.1  # beyond so many times that way hardly any point must fit, for round a corner everything looks different
GLANCE_FIT, GLANCE_RAD = 0.8, 0.06  # … unless it fits so badly, or so far turned, that it tells of something else


class Limits(NamedTuple):
    """What the robot can do, and what its laser sees."""

    speed_mps: float
    turn_radps: float
    max_range_m: float


class MotionCheck:
    """Corrects each step of dead reckoning by what the witnesses have found out.

    Attributes:
        turn, way: the trials of gyro and wheels. fits: share of the last scan that was explained.
        news: findings that nobody has told yet. step_var_m2: to add to the variance of the last step's way.
    """

    def __init__(self, limits: Limits, wheels_know_turns: bool, has_gyro: bool, judges_turns: bool) -> None:
        """`has_gyro`: a sensor that drifts gives the heading. `judges_turns`: False where somebody wants the heading as its source gives it."""
        self.news: list[News] = []
        self._reckoning = Reckoning()
        self._turns = TurnCheck(self.news, limits.turn_radps, wheels_know_turns, has_gyro, judges_turns)
        self._ways = WayCheck(self.news, self._reckoning)
        self.turn, self.way = self._turns.trial, self._ways.trial
        self._is_carried_off = False
        self.fits = 1.0
        self._key: KeyScan | None = None
        self._kept = KeptScans()
        self._is_elsewhere = self._is_surely_elsewhere = False
        self._home = Home()
        self._beams = Beams(0.0, 0.0, limits.max_range_m)
        self._carried = Carried(limits.speed_mps)
        self._matched_s = self._glanced_s = self._since_s = -math.inf
        self._doubt = Doubt()  # of turn and place
        self.step_var_m2 = 0.0

    @property
    def lost(self) -> bool:
        """True while nobody knows where the robot is, or where a car without gyro points: its wheels know of no turn."""
        return self._is_carried_off or not self._turns.is_known

    @property
    def believes_tilt(self) -> bool:
        """False while the sensor tells of turns that no robot makes: what it says of the slope is not worth more."""
        return self._turns.believes_tilt

    # ---------------------------------------------------------------- steps

    def step(self, stamp_s: float, dt_s: float, way_m: float, wheel_turn_rad: float, turn_rad: float, is_measured: bool) -> tuple[float, float]:
        """(way m, turn rad) to reckon with. `turn_rad` is the heading source's, `is_measured` if that is a sensor."""
        way_m = self._ways.counted_m(way_m)
        reckoned_m, self.step_var_m2 = self.way.reckoned(dt_s, way_m)
        reckoned_rad, is_measured = self._turns.reckoned(dt_s, wheel_turn_rad, turn_rad, is_measured)
        now = self._reckoning.add(stamp_s, dt_s, reckoned_m, reckoned_rad, (way_m, wheel_turn_rad), is_measured)
        if self._turns.is_due(stamp_s):
            self._turns.judge_alone(now, self._matched_s)
        return reckoned_m + self.way.debt.pay(dt_s), reckoned_rad + self.turn.debt.pay(dt_s)

    def found(self) -> None:
        """Somebody has said where the robot is."""
        self._is_carried_off = self._is_elsewhere = False

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much."""
        self._turns.bias_moved(by_radps)

    # ---------------------------------------------------------------- scans

    def look(self, stamp_s: float, ranges_m: Array, first_rad: float, step_rad: float, arm: Pose2) -> None:
        """Compare a level scan with the key scan. `arm`: where the laser was, seen from the robot."""
        if stamp_s < self._since_s:
            return  # taken before the last finding: what was reckoned then is known to be wrong, and owed
        at, key = self._reckoning.at(stamp_s), self._key
        if at is None or np.count_nonzero(ranges_m > 0.0) < LEAST_BEAMS * len(ranges_m):
            self._is_elsewhere = False  # the next one is compared with the one before
            return
        scan, self._beams = KeyScan(at, ranges_m, arm), Beams(first_rad, step_rad, self._beams.max_range_m)
        if self._is_carried_off and self._home.is_back(scan, self._seen_from_home(scan)):
            self.found()
            self.news.append(News(FOUND, "the laser sees the place again where the robot was: somebody had hidden it"))
        compared = None if key is None else self._kept.compared(scan, key, self._beams, self._ways.since_m)
        if compared is None:
            self._renew(scan, is_lost=True)  # what waits to be confirmed waits on
            return
        if compared[0] is not key:
            self._renew(compared[0])
        self.fits = compared[2].fits
        self._judge(scan, *compared)

    def wants_glance(self, stamp_s: float) -> bool:
        """True if a scan that is not exact may tell something: now and then, and each one while the wheels slip or are suspected to."""
        is_calm = self.way.grip == 1.0 and not self._ways.doubt.is_waiting
        return not (self._is_carried_off or self._is_elsewhere or (is_calm and stamp_s - max(self._matched_s, self._glanced_s) < GLANCE_EVERY_S))

    def glance(self, stamp_s: float, ranges_m: Array, first_rad: float, step_rad: float, arm: Pose2) -> None:
        """A scan from a tilted wrist, as a level one would have shown it, or from one on its way: whether the wheels slip it tells all the same."""
        at, key = self._reckoning.at(stamp_s), self._key
        if at is None or key is None or stamp_s < self._since_s or np.count_nonzero(ranges_m > 0.0) < GLANCE_BEAMS:
            return
        scan, self._beams = KeyScan(at, ranges_m, arm), Beams(first_rad, step_rad, self._beams.max_range_m)
        compared = self._kept.compared(scan, key, self._beams, self._ways.since_m)
        if compared is None or not is_good(compared[2]):
            return
        key, motion, match = compared
        off_m, aside_m, off_rad = _off(scan, key, motion, match)
        is_slip = match.fits > GLANCE_FIT and abs(off_rad) < GLANCE_RAD and abs(motion.wheels_m) > LEAST_M
        if is_slip and not self._carried.says(scan, off_m, aside_m, since=key):
            self._glanced_s = stamp_s
            self._place(scan, key, motion, match, (off_m, aside_m))
            self._ways.doubt.looked(stamp_s)

    def _judge(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> None:
        """Is it the same place? Another one only if two scans in a row say so, and the place before does not come into view again."""
        if is_good(match):
            home = self._seen_from_home(scan) if self._is_elsewhere else None
            if home is not None and not (is_good(home) or self._is_surely_elsewhere or is_odd(home, False, scan.is_crowded)):
                self._renew(scan)  # that tells neither way: it waits on
                return
            self._is_elsewhere = self._is_elsewhere and (self._is_surely_elsewhere if home is None else not self._home.is_near(scan, home))
            self._weigh(scan, key, motion, match)
            self._doubt.looked(scan.at.stamp_s)
            self._ways.doubt.looked(scan.at.stamp_s)
            return
        is_clear = match.fits < NEVER_FITS and min(match.longer, match.shorter) > MUCH
        if (is_clear or not is_far(motion.pose, NEAR_KEYS)) and is_odd(match, key.is_crowded, scan.is_crowded):
            self._is_elsewhere = not self._is_elsewhere
            self._is_surely_elsewhere = is_clear and not (key.is_crowded or scan.is_crowded)
            self._kept.forget()
            if self._is_elsewhere and not self._is_carried_off:
                self._home = Home(key)
        elif self._ways.doubt.is_waiting and not is_far(motion.pose, NEAR_KEYS):
            return  # the key scan may still tell what has become of the way
        self._renew(scan, is_lost=True)

    def _seen_from_home(self, scan: KeyScan) -> ScanStep | None:
        """How a scan fits to the place where the robot was before it seemed elsewhere."""
        held = None if self._home.key is None else held_against(self._home.key, scan, self._beams)
        return None if held is None else held[1]

    def _weigh(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> None:
        """A good match: does it tell of the motion that was reckoned?"""
        stamp_s = self._matched_s = scan.at.stamp_s
        if self._is_elsewhere:
            self._lose("the laser sees another place than a moment ago, where neither wheels nor gyro can have brought the robot")
            self._renew(scan)
            return
        off_m, aside_m, off_rad = _off(scan, key, motion, match)
        off_rad -= self._turns.counted_rad
        if match.fits - match.fits_as_guessed > LEAST_GAIN and self._carried.says(scan, off_m, aside_m):
            self._kept.keep(scan)
            if self._doubt.is_confirmed(stamp_s) or is_decisive(match):
                self._home = Home(key)
                self._lose(f"the laser sees the robot moved by {math.hypot(off_m, aside_m):.1f} m as its wheels cannot move it")
                self._renew(scan)
            return
        self._carried.note(scan, off_m)
        turn = (stamp_s, off_rad, match.sigma_theta_rad, motion)
        if self._turns.is_suspect(*turn, self._doubt):
            return
        if self._turns.is_wrong(*turn, self._reckoning.now_s - stamp_s):
            self._renew(scan)
            self._kept.forget()
            self._turns.counted_rad, self._since_s = self.turn.lag_rad, self._reckoning.now_s
            return
        placed = self._place(scan, key, motion, match, (off_m, aside_m))
        if placed is None:
            return
        self._kept.keep(placed)
        if motion.time_s > KEY_S or is_far(motion.pose, 1.0):
            self._turns.learn(off_rad, match.sigma_theta_rad, motion)
            self._ways.learn(key, motion, match, (off_m, aside_m))
            self._renew(placed)

    def _place(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep, off: tuple[float, float]) -> KeyScan | None:
        """The scan where the laser sees it; None if the next one has to confirm that."""
        was_slipping = self.way.is_slipping
        placed = self._ways.place(scan, key, motion, match, off)
        if placed is not None and placed is not scan:
            self._carried.note(scan, self._ways.since_m)
        if self.way.is_slipping and not was_slipping:
            self._kept.forget()
        return placed

    def _lose(self, text: str) -> None:
        self._is_elsewhere = False
        self._kept.forget()
        if not self._is_carried_off:
            self._is_carried_off = True
            self.news.append(News(LOST, text))

    def _renew(self, scan: KeyScan, is_lost: bool = False) -> None:
        self._key, self._turns.counted_rad = scan, 0.0
        self._carried.note(scan, 0.0)
        self._ways.renew(is_lost)


def _off(scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> tuple[float, float, float]:
    """What the laser saw more than was reckoned: m along the way, m to the left of it, rad."""
    return difference(motion.pose, compose(compose(key.arm, match.step), inverse(scan.arm)))

