"""Do gyro, wheels and laser tell of the same motion? Three witnesses; whoever stands alone is not believed.

The laser sees how the robot moved since a scan of a moment ago (`key_scan`), and that is compared with what localisation reckons with: the
turn (`turn_trial`), the way (`way_trial`), and whether the scan fits at all. One that fits nowhere near, followed by one that fits to it,
was taken in another place, and nobody knows where: the robot is lost until somebody posts where it is. People who stand round it may hide
so much that a scan looks like that too; so the place before is kept, and when it comes into view again, where it must be, nobody is lost.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.home_scan import Home
from estimation.kept_scans import KeptScans, held_against, is_far
from estimation.key_scan import MUCH, KeyScan, difference, is_good, is_odd
from estimation.news import FOUND, LOST, News
from estimation.reckoning import Motion, Reckoning, Sums, motion_between
from estimation.scan_match import ScanStep
from estimation.se2 import Pose2, compose, inverse
from estimation.trim import OF_GYRO, OF_WHEELS, Trim
from estimation.turn_trial import TurnTrial
from estimation.way_trial import WayTrial

Array = NDArray[np.float64]

LEAST_BEAMS = 0.75  # of a scan must be numbers
SIGMAS = 5.0
FASTER, ASIDE_M, SUDDEN_M, JITTER_RAD = 2.0, 0.2, 0.08, 0.1  # than the platform's limits: nobody drives or turns so fast, or so far sideways
LEAST_GAIN = 0.08  # so many more points fit where the laser sees the robot
SEES_ALONG_M, LEAST_WAY_M = 0.008, 0.3  # along a bare street a laser sees no way; nothing is learned there, nor from less of a way
KEY_S = 3.0  # a scan is compared with for so long, or until the robot has moved on by about `KEY_WAY_M`
NEAR_KEYS, NEVER_FITS = 1.5, 0.1  # beyond so many times that way hardly any point must fit, for round a corner everything looks different
ALONE_S, BLIND_S = 1.0, 1.5  # without laser: judged each second, and after so long without


class Limits(NamedTuple):
    """What the robot can do, and what its laser sees."""

    speed_mps: float
    turn_radps: float
    max_range_m: float


class MotionCheck:
    """Corrects each step of dead reckoning by what the witnesses have found out.

    Attributes:
        turn, way: the trials of gyro and wheels. fits: share of the last scan that was explained.
        news: findings that nobody has told yet.
    """

    def __init__(self, limits: Limits, wheels_know_turns: bool, has_gyro: bool, judges_turns: bool) -> None:
        """`has_gyro`: a sensor that drifts gives the heading. `judges_turns`: False where somebody wants the heading as its source gives it."""
        self._limits, self._asks_wheels, self._has_gyro, self._judges_turns = limits, wheels_know_turns, has_gyro, judges_turns
        self.news: list[News] = []
        self.turn, self.way = TurnTrial(self.news, wheels_know_turns), WayTrial(self.news)
        self._gyro_trim, self._wheel_trim = Trim(OF_GYRO), Trim(OF_WHEELS)
        self._is_carried_off = self._talks_nonsense = False
        self.fits = 1.0
        self._reckoning = Reckoning()
        self._key: KeyScan | None = None
        self._kept = KeptScans()
        self._is_elsewhere = self._is_surely_elsewhere = False
        self._home = Home()
        self._beams = (0.0, 0.0, 0.0)  # bearing of the first one, and from each to the next, rad; the laser's range, m
        self._counted_rad = 0.0  # of the difference to this key scan, so much is owed already
        self._last = (0.0, 0.0)  # of the last comparison with this key scan: time s, difference m
        self._matched_s = self._since_s = -math.inf
        self._alone: Sums | None = None  # since then the gyro is watched by the wheels
        self._looked_s = self._suspected_s = -math.inf  # stamps of the last scan, and of the last that told of a wrong way

    @property
    def lost(self) -> bool:
        """True while nobody knows where the robot is, or where a car without gyro points: its wheels know of no turn."""
        return self._is_carried_off or not (self.turn.trusts_gyro or self._asks_wheels)

    @property
    def believes_tilt(self) -> bool:
        """False while the sensor tells of turns that no robot makes: what it says of the slope is not worth more."""
        return self.turn.trusts_gyro or not self._talks_nonsense

    # ---------------------------------------------------------------- steps

    def step(self, stamp_s: float, dt_s: float, way_m: float, wheel_turn_rad: float, turn_rad: float, is_measured: bool) -> tuple[float, float]:
        """(way m, turn rad) to reckon with. `turn_rad` is the heading source's, `is_measured` if that is a sensor."""
        if is_measured and self.turn.trusts_gyro and abs(turn_rad) > FASTER * self._limits.turn_radps * dt_s + JITTER_RAD:
            self._refuse_gyro(f"the gyro says {turn_rad / dt_s:.3g} rad/s, more than this robot can turn")
        way_m += self._wheel_trim.rate * way_m
        reckoned_m = way_m * self.way.grip
        reckoned_rad, is_measured = self.turn.reckoned(dt_s, wheel_turn_rad, turn_rad, is_measured)
        if is_measured:
            reckoned_rad += self._gyro_trim.rate * dt_s
        self._reckoning.add(stamp_s, dt_s, reckoned_m, reckoned_rad, (way_m, wheel_turn_rad), is_measured)
        if self._has_gyro and self._asks_wheels and (self._alone is None or stamp_s - self._alone.stamp_s >= ALONE_S):
            self._judge_without_laser(stamp_s)
        return reckoned_m + self.way.debt.pay(dt_s), reckoned_rad + self.turn.debt.pay(dt_s)

    def found(self) -> None:
        """Somebody has said where the robot is."""
        self._is_carried_off = self._is_elsewhere = False

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much."""
        self.turn.bias_moved(by_radps)
        self._talks_nonsense = False
        self._gyro_trim.moved(by_radps)

    def _refuse_gyro(self, why: str) -> None:
        self.turn.refuse(why)
        self._talks_nonsense = True
        if not self._asks_wheels:
            self.news.append(News(LOST, f"{why}, and nothing else tells where the robot points"))

    def _judge_without_laser(self, stamp_s: float) -> None:
        before, now = self._alone, self._reckoning.at(stamp_s)
        self._alone = now
        if before is not None and now is not None and stamp_s - self._matched_s > BLIND_S and stamp_s - before.stamp_s < 2.0 * ALONE_S:
            self.turn.weigh_alone(motion_between(before, now))

    # ---------------------------------------------------------------- scans

    def look(self, stamp_s: float, ranges_m: Array, first_rad: float, step_rad: float, arm: Pose2) -> None:
        """Compare a level scan with the key scan. `arm`: where the laser was, seen from the robot."""
        if stamp_s < self._since_s:
            return  # taken before the last finding: what was reckoned then is known to be wrong, and owed
        at, key = self._reckoning.at(stamp_s), self._key
        if at is None or np.count_nonzero(ranges_m > 0.0) < LEAST_BEAMS * len(ranges_m):
            self._is_elsewhere = False  # the next one is compared with the one before
            return
        scan, self._beams = KeyScan(at, ranges_m, arm), (first_rad, step_rad, self._limits.max_range_m)
        if self._is_carried_off and self._home.is_back(scan, self._seen_from_home(scan)):
            self.found()
            self.news.append(News(FOUND, "the laser sees the place again where the robot was: somebody had hidden it"))
        compared = None if key is None else self._kept.compared(scan, key, *self._beams)
        if compared is None:
            self._renew(scan)  # what waits to be confirmed waits on
            return
        if compared[0] is not key:
            self._renew(compared[0])
        self.fits = compared[2].fits
        self._judge(scan, *compared)

    def _judge(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> None:
        """Is it the same place? Another one only if two scans in a row say so, and the place before does not come into view again."""
        if is_good(match):
            home = self._seen_from_home(scan) if self._is_elsewhere else None
            if home is not None and not (is_good(home) or self._is_surely_elsewhere or is_odd(home, False, scan.is_crowded)):
                self._renew(scan)  # that tells neither way: it waits on
                return
            self._is_elsewhere = self._is_elsewhere and (self._is_surely_elsewhere if home is None else not is_good(home))
            self._weigh(scan, key, motion, match)
            self._looked_s = scan.at.stamp_s
            return
        is_clear = match.fits < NEVER_FITS and min(match.longer, match.shorter) > MUCH
        if (is_clear or not is_far(motion.pose, NEAR_KEYS)) and is_odd(match, key.is_crowded, scan.is_crowded):
            self._is_elsewhere = not self._is_elsewhere
            self._is_surely_elsewhere = is_clear and not (key.is_crowded or scan.is_crowded)
            self._kept.forget()
            if self._is_elsewhere and not self._is_carried_off:
                self._home = Home(key)
        self._renew(scan)

    def _seen_from_home(self, scan: KeyScan) -> ScanStep | None:
        """How a scan fits to the place where the robot was before it seemed elsewhere."""
        held = None if self._home.key is None else held_against(self._home.key, scan, *self._beams)
        return None if held is None else held[1]

    def _weigh(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> None:
        """A good match: does it tell of the motion that was reckoned?"""
        stamp_s = self._matched_s = scan.at.stamp_s
        if self._is_elsewhere:
            self._lose("the laser sees another place than a moment ago, where neither wheels nor gyro can have brought the robot")
            self._renew(scan)
            return
        seen = compose(compose(key.arm, match.step), inverse(scan.arm))
        off_m, aside_m, off_rad = difference(motion.pose, seen)
        off_rad -= self._counted_rad
        self._kept.keep(scan)
        gain = match.fits - match.fits_as_guessed
        if gain > LEAST_GAIN and self._is_carried(motion, off_m, aside_m):
            if self._is_confirmed(stamp_s):
                self._home = Home(key)
                self._lose(f"the laser sees the robot moved by {math.hypot(off_m, aside_m):.1f} m as its wheels cannot move it")
                self._renew(scan)
            return
        self._last = (motion.time_s, off_m)
        if self._judges_turns and self._is_wrong_turn(scan, off_rad, SIGMAS * match.sigma_theta_rad, motion):
            return
        sigma_m = math.hypot(match.sigma_x_m * math.cos(key.arm[2]), match.sigma_y_m * math.sin(key.arm[2]))
        if self.way.is_suspect(off_m, SIGMAS * sigma_m, gain, motion) and not self._is_confirmed(stamp_s):
            return
        if self.way.weigh(off_m, SIGMAS * sigma_m, gain, motion):
            self._kept.forget()
        elif motion.time_s <= KEY_S and not is_far(motion.pose, 1.0):
            return
        self._trim(off_m, sigma_m, off_rad, match.sigma_theta_rad, motion)
        self._renew(scan)

    def _trim(self, off_m: float, sigma_m: float, off_rad: float, sigma_rad: float, motion: Motion) -> None:
        """A comparison that is over, and found nothing wrong: learn from it what there is."""
        if self._has_gyro and self.turn.trusts_gyro and motion.is_measured:
            paid_rad = self._gyro_trim.take(off_rad, sigma_rad, motion.time_s)
            self.turn.debt.owed += paid_rad
            off_rad -= paid_rad
        self.turn.keep(motion.until_s, off_rad, motion)
        if self.way.grip == 1.0 and sigma_m < SEES_ALONG_M and abs(motion.wheels_m) > LEAST_WAY_M:
            self.way.debt.owed += self._wheel_trim.take(off_m, sigma_m, motion.wheels_m)

    def _is_wrong_turn(self, scan: KeyScan, off_rad: float, noise_rad: float, motion: Motion) -> bool:
        """True if the turn is found wrong, or is suspected and the next scan has to confirm it."""
        stamp_s = scan.at.stamp_s
        if self.turn.is_suspect(off_rad, noise_rad, motion) and not self._is_confirmed(stamp_s):
            return True
        if not self.turn.weigh(stamp_s, off_rad, noise_rad, motion, self._reckoning.now_s - stamp_s):
            return False
        self._renew(scan)
        self._kept.forget()
        self._counted_rad, self._since_s = self.turn.lag_rad, self._reckoning.now_s
        return True

    def _is_carried(self, motion: Motion, off_m: float, aside_m: float) -> bool:
        """True if the difference came at once, or sideways: then somebody moved the robot."""
        last_s, last_m = self._last
        most_m = FASTER * self._limits.speed_mps * (motion.time_s - last_s) + SUDDEN_M
        return abs(off_m - last_m) > most_m or abs(aside_m) > ASIDE_M

    def _is_confirmed(self, stamp_s: float) -> bool:
        """True for the second scan in a row that says so: what walks past the laser moves on."""
        is_second = self._suspected_s > -math.inf and self._suspected_s == self._looked_s
        self._suspected_s = stamp_s
        return is_second

    def _lose(self, text: str) -> None:
        self._is_elsewhere = False
        self._kept.forget()
        if not self._is_carried_off:
            self._is_carried_off = True
            self.news.append(News(LOST, text))

    def _renew(self, scan: KeyScan) -> None:
        self._key, self._last, self._counted_rad = scan, (0.0, 0.0), 0.0
