"""Do gyro, wheels and laser tell of the same motion? Three witnesses; whoever stands alone is not believed.

The laser sees how the robot moved since a scan of a moment ago (`scan_match`), and that is compared with what localisation reckons with:

- the gyro says another turn than laser *and* wheels: its bias has jumped; the difference is taken off from now on, and a gyro to which that
  happens again and again is not asked any more until its bias is measured anew;
- the wheels say another way than the laser, and the laser's explains the scan better: they slip; so much of their way is believed as gripped;
- the scan fits nowhere near, and the one after it fits to it: the robot stands in another place. Nobody knows where: it is lost.

What was reckoned wrongly until then is made up for bit by bit, for dead reckoning never jumps. Skidding wheels turn a robot 5 – 15 % more or less
than they say (fact sheet of the ATRV-2), so they are asked about turns no more exactly than that. Where a laser sees nothing to hold on to, a
gyro that turns a robot whose wheels run straight is judged by the wheels alone (Borenstein and Feng, Gyrodometry, 1996).
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.reckoning import Motion, Reckoning
from estimation.scan_match import ScanStep, match_scans
from estimation.se2 import IDENTITY, Pose2, between, compose, inverse

Array = NDArray[np.float64]

GYRO_DRIFT, GYRO_REFUSED, WHEEL_SLIP, WHEELS_GRIP, LOST = "gyro-drift", "gyro-refused", "wheel-slip", "wheels-grip", "lost"

GOOD_FIT, LEAST_POINTS = 0.6, 40  # a share of the points on their lines: the match is good
NO_FIT, ONE_SIDED, SIDES = 0.4, 0.08, 0.12  # another place: fewer fit and both sides differ, or hardly any fits at all
SIGMAS = 5.0
LEAST_TURN_RAD, LEAST_SUM_RAD, SUM_S = 0.04, 0.05, 12.0  # a difference of turns that counts: since one scan, or in all scans of the last seconds
WHEELS_SHARE, WHEELS_RAD = 0.2, 0.02  # wheels and gyro agree about a turn: skidding, and counts
LEAST_WAY_M, WAY_SHARE, LEAST_GAIN = 0.08, 0.2, 0.08  # slip: so much, of the way; and so many more points fit than with the wheels' way
GRIPS_AGAIN, GRIPS_IN_A_ROW = 0.1, 2
FASTER, ASIDE_M, JITTER_RAD = 2.0, 0.2, 0.1  # than the platform's limits: nobody drives or turns so fast, or so far sideways
KEY_WAY_M, KEY_TURN_RAD, KEY_S, KEY_SLIPPING_S = 1.0, 0.5, 3.0, 0.35  # a scan is compared with until the robot has moved on so far
ALONE_S, BLIND_S, ALONE_RADPS, STRAIGHT_RADPS = 1.0, 1.5, 0.15, 0.03  # without laser: judged after, since, a turn of the gyro, of the wheels
SMALL_RADPS = 0.005  # what is left of a drift after its bias was measured anew
SETTLING_RAD = 0.3
STRIKES, STRIKES_S, JUMP_RADPS = 3, 15.0, math.radians(1.0)  # so many jumps of the bias of so much within such a time: this is no bias
MAKE_UP_MPS, MAKE_UP_RADPS = 0.3, 1.0  # what is owed is paid no faster


class News(NamedTuple):
    """A new finding: its word and a sentence."""

    word: str
    text: str


class KeyScan(NamedTuple):
    """The scan that others are compared with; `arm`: the laser seen from the robot."""

    stamp_s: float
    ranges_m: Array
    arm: Pose2


class MotionCheck:
    """Corrects each step of dead reckoning by what the witnesses have found out.

    Attributes:
        drift_radps: taken off the turn of the heading sensor. trusts_gyro: False = the wheels' turn stands in for it.
        grip: share of the wheels' way that is believed. lost: the robot is elsewhere. fits: share of the last scan that was explained.
    """

    def __init__(self, max_range_m: float, max_speed_mps: float, max_turn_radps: float, wheels_know_turns: bool, has_gyro: bool, judges_turns: bool) -> None:
        """`judges_turns`: False where somebody wants the heading as its source gives it."""
        self._max_speed_mps, self._max_turn_radps = max_speed_mps, max_turn_radps
        self._max_range_m, self._asks_wheels, self._has_gyro, self._judges_turns = max_range_m, wheels_know_turns, has_gyro, judges_turns
        self.drift_radps, self.grip, self.lost, self.trusts_gyro = 0.0, 1.0, False, True
        self.fits = 1.0
        self.news: list[News] = []
        self._owed_m = self._owed_rad = 0.0
        self._reckoning = Reckoning()
        self._key: KeyScan | None = None
        self._is_elsewhere = False
        self._gripped = 0
        self._turns: deque[tuple[float, float, Motion]] = deque()  # stamp s, laser's turn − reckoned turn, motion; since each of the last key scans
        self._last_off_m = self._last_time_s = 0.0
        self._strikes: deque[float] = deque(maxlen=STRIKES)  # when the gyro's bias jumped
        self._matched_s = self._alone_s = self._since_s = self._scan_s = -math.inf

    # ---------------------------------------------------------------- steps

    def step(
        self, stamp_s: float, dt_s: float, way_m: float, wheel_turn_rad: float, turn_rad: float, is_measured: bool
    ) -> tuple[float, float]:
        """(way m, turn rad) to reckon with. `turn_rad` is the heading source's, `is_measured` if that is a sensor."""
        if is_measured and abs(turn_rad) > FASTER * self._max_turn_radps * dt_s + JITTER_RAD:
            self._refuse_gyro(f"the gyro says {turn_rad / dt_s:.3g} rad/s, more than this robot can turn")
        if not self.trusts_gyro:
            turn_rad, is_measured = wheel_turn_rad, False
        reckoned_m = way_m * self.grip
        reckoned_rad = turn_rad - self.drift_radps * dt_s if is_measured else turn_rad
        self._reckoning.add(stamp_s, dt_s, reckoned_m, reckoned_rad, (way_m, wheel_turn_rad, reckoned_rad), is_measured)
        if self._has_gyro and self._asks_wheels and stamp_s - self._alone_s >= ALONE_S:
            self._judge_alone(stamp_s)
        if self._owed_m:
            pay_m = math.copysign(min(abs(self._owed_m), MAKE_UP_MPS * dt_s), self._owed_m)
            self._owed_m, reckoned_m = self._owed_m - pay_m, reckoned_m + pay_m
        if self._owed_rad:
            self._owed_rad = math.remainder(self._owed_rad, math.tau)
            pay_rad = math.copysign(min(abs(self._owed_rad), MAKE_UP_RADPS * dt_s), self._owed_rad)
            self._owed_rad, reckoned_rad = self._owed_rad - pay_rad, reckoned_rad + pay_rad
        return reckoned_m, reckoned_rad

    @property
    def is_settling(self) -> bool:
        """True while so much of the heading is owed that nobody should steer by it."""
        return abs(self._owed_rad) > SETTLING_RAD

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much: what was taken off here for it is not needed any more."""
        left_radps = self.drift_radps - by_radps
        self.drift_radps = left_radps if self.drift_radps and abs(left_radps) > SMALL_RADPS else 0.0
        if not self.trusts_gyro:
            self.trusts_gyro, self.drift_radps = True, 0.0
        self._turns.clear()

    def found(self) -> None:
        """Somebody has said where the robot is."""
        self.lost = self._is_elsewhere = False

    def _judge_alone(self, stamp_s: float) -> None:
        """The gyro against wheels that run straight, while no laser can say more."""
        motion = self._reckoning.between(max(0.0, self._alone_s), stamp_s) if self._alone_s > -math.inf else None
        self._alone_s = self._scan_s = stamp_s
        if motion is None or stamp_s - self._matched_s < BLIND_S or motion.time_s > 2.0 * ALONE_S or motion.measured_s < 0.9 * motion.time_s:
            return
        is_straight = abs(motion.wheels_rad) < STRAIGHT_RADPS * motion.time_s and motion.wheels_m != 0.0
        if is_straight and abs(motion.turn_rad) > ALONE_RADPS * motion.time_s:
            self._accuse_gyro(motion.wheels_rad - motion.turn_rad, motion, "no laser is there to ask")

    # ---------------------------------------------------------------- scans

    def look(self, stamp_s: float, ranges_m: Array, first_rad: float, step_rad: float, arm: Pose2) -> None:
        """Compare a level scan with the key scan. `arm`: where the laser was, seen from the robot."""
        if stamp_s < self._since_s:
            return  # reckoned with what is known to be wrong
        scan, key = KeyScan(stamp_s, ranges_m, arm), self._key
        motion = self._reckoning.between(key.stamp_s, stamp_s) if key is not None else None
        if key is None or motion is None or len(ranges_m) != len(key.ranges_m) or stamp_s - key.stamp_s > 2.0 * KEY_S:
            self._renew(scan)
            return
        match = self._best_match(key, scan, motion, first_rad, step_rad)
        self.fits = match.fits
        if match.points < LEAST_POINTS:
            self._is_elsewhere = False
            self._renew(scan)
        elif match.fits < GOOD_FIT:
            both_sides = match.fits < NO_FIT and min(match.longer, match.shorter) > SIDES
            self._is_elsewhere = not self._is_elsewhere and (both_sides or match.fits < ONE_SIDED)
            self._renew(scan)
        else:
            self._weigh(scan, key, motion, match)

    def blind(self) -> None:
        """A scan came that cannot be compared: the next one begins anew."""
        self._key, self._is_elsewhere = None, False

    def _best_match(self, key: KeyScan, scan: KeyScan, motion: Motion, first_rad: float, step_rad: float) -> ScanStep:
        """From where localisation believes to be; if that fits badly also from where the wheels' turn leads, and from no motion at all."""
        x, y, _ = motion.pose
        guesses = (motion.pose, (x, y, motion.wheels_rad), IDENTITY)
        best: ScanStep | None = None
        for pose in guesses:
            guess = between(key.arm, compose(pose, scan.arm))
            match = match_scans(key.ranges_m, scan.ranges_m, first_rad, step_rad, guess, self._max_range_m)
            if best is None or match.fits > best.fits + 0.1:
                best = match if best is None else match._replace(fits_as_guessed=best.fits_as_guessed)
            if best.fits >= GOOD_FIT:
                break
        assert best is not None
        return best

    def _weigh(self, scan: KeyScan, key: KeyScan, motion: Motion, match: ScanStep) -> None:
        """A good match: does it tell of the motion that was reckoned?"""
        if self._is_elsewhere:
            self._lose("the laser sees another place than a moment ago, where neither wheels nor gyro can have brought the robot")
            self._renew(scan)
            return
        self._matched_s = self._scan_s = scan.stamp_s
        seen = compose(compose(key.arm, match.step), inverse(scan.arm))
        pan_rad = key.arm[2]
        sigma_m = math.hypot(match.sigma_x_m * math.cos(pan_rad), match.sigma_y_m * math.sin(pan_rad))
        off_rad = seen[2] - motion.pose[2]
        heading_rad = 0.5 * motion.pose[2]
        c, s = math.cos(heading_rad), math.sin(heading_rad)
        x, y = seen[0] - motion.pose[0], seen[1] - motion.pose[1]
        off_m, aside_m = c * x + s * y, c * y - s * x
        if self._is_carried(motion, off_m, aside_m, match):
            self._lose(f"the laser sees the robot moved by {math.hypot(off_m, aside_m):.1f} m as no wheels can move it")
            self._renew(scan)
            return
        if self._weigh_turn(scan.stamp_s, off_rad, SIGMAS * match.sigma_theta_rad, motion):
            self._begin_anew()
            return
        x, y, turn_rad = motion.pose
        is_far = math.hypot(x, y) > KEY_WAY_M or abs(turn_rad) > KEY_TURN_RAD or motion.time_s > KEY_S
        if self._weigh_way(off_m, SIGMAS * sigma_m, motion, match) or is_far:
            self._turns.append((scan.stamp_s, off_rad, motion))
            self._renew(scan)

    def _is_carried(self, motion: Motion, off_m: float, aside_m: float, match: ScanStep) -> bool:
        """True if the difference came at once, or sideways: then somebody moved the robot."""
        last_m, self._last_off_m = (self._last_off_m if motion.time_s > self._last_time_s else 0.0), off_m
        dt_s = motion.time_s - (self._last_time_s if motion.time_s > self._last_time_s else 0.0)
        self._last_time_s = motion.time_s
        is_sudden = abs(off_m - last_m) > FASTER * self._max_speed_mps * dt_s + LEAST_WAY_M
        return (is_sudden or abs(aside_m) > ASIDE_M) and match.fits - match.fits_as_guessed > LEAST_GAIN

    def _lose(self, text: str) -> None:
        self._is_elsewhere = False
        if not self.lost:
            self.lost = True
            self.news.append(News(LOST, text))

    def _weigh_turn(self, stamp_s: float, off_rad: float, noise_rad: float, motion: Motion) -> bool:
        """True if the heading's source was found wrong, at once or little by little."""
        if not self._judges_turns:
            return False
        while self._turns and stamp_s - self._turns[0][0] > SUM_S:
            self._turns.popleft()
        if abs(off_rad) > max(LEAST_TURN_RAD, noise_rad) and self._is_alone(motion):
            self._accuse_gyro(off_rad, motion, f"so do the {motion.time_s:.1f} s of scans" if self._asks_wheels else "the laser denies it")
            return True
        motions = [turn[2] for turn in self._turns] + [motion]
        sum_rad = off_rad + sum(turn[1] for turn in self._turns)
        if len(motions) < 2 or abs(sum_rad) <= max(LEAST_SUM_RAD, noise_rad):
            return False
        whole = Motion(IDENTITY, *(sum(values) for values in zip(*(m[1:] for m in motions), strict=True)))
        if not self._is_alone(whole):
            return False
        self._accuse_gyro(sum_rad, whole, f"so do the scans of {whole.time_s:.0f} s")
        return True

    def _is_alone(self, motion: Motion) -> bool:
        """True if the wheels do not side with the heading's source, or are that source themselves."""
        if not motion.is_measured or not self._asks_wheels:
            return True
        return abs(motion.wheels_rad - motion.turn_rad) > max(WHEELS_RAD, WHEELS_SHARE * abs(motion.wheels_rad))

    def _accuse_gyro(self, off_rad: float, motion: Motion, others: str) -> None:
        """Make up for the turn, and take the drift off from now on."""
        self._owed_rad += off_rad
        self._turns.clear()
        if not motion.is_measured:
            return  # the wheels stand in for a gyro: they are wrong by a share, which is no drift
        by_radps = -off_rad / motion.time_s
        self.drift_radps += by_radps
        self._owed_rad -= by_radps * (self._reckoning.now_s - self._scan_s)
        told = f"the gyro turns by {math.degrees(by_radps):+.1f} deg/s more than the robot: the wheels say {motion.wheels_rad:.2f} rad, it says {motion.turn_rad:.2f}"
        if abs(by_radps) > JUMP_RADPS:
            self._strikes.append(self._reckoning.now_s)
        if len(self._strikes) == STRIKES and self._strikes[-1] - self._strikes[0] < STRIKES_S:
            self._refuse_gyro(f"{told}; {others}. Again and again")
        else:
            self.news.append(News(GYRO_DRIFT, f"{told}; {others}. It is taken off from now on"))

    def _refuse_gyro(self, why: str) -> None:
        """The wheels stand in. A car's wheels know of no turn: it must stop."""
        if not self.trusts_gyro:
            return
        self._strikes.clear()
        self.trusts_gyro, self.drift_radps = False, 0.0
        self.news.append(News(GYRO_REFUSED, f"{why}: the wheels stand in until its bias is measured anew"))
        if not self._asks_wheels:
            self._lose(f"{why}; nothing else tells where the robot points")

    def _weigh_way(self, off_m: float, noise_m: float, motion: Motion, match: ScanStep) -> bool:
        """True if the wheels' way was found wrong, or while it is known to be."""
        way_m, seen_m = motion.wheels_m, motion.wheels_m * self.grip + off_m
        if self.grip != 1.0:
            return self._follow_slip(off_m, seen_m, motion)
        least_m = max(LEAST_WAY_M, WAY_SHARE * abs(way_m), noise_m)
        if abs(off_m) <= least_m or match.fits - match.fits_as_guessed < LEAST_GAIN:
            return False
        self._owed_m += off_m
        told = f"the wheels say {way_m:.2f} m, the laser {seen_m:.2f} m in {motion.time_s:.1f} s"
        if abs(way_m) > LEAST_WAY_M:
            self.grip, self._gripped = min(max(seen_m / way_m, 0.0), 1.5), 0
            self.news.append(News(WHEEL_SLIP, f"{told}: {self.grip:.0%} of their way is believed until they agree again"))
        else:
            self.news.append(News(WHEEL_SLIP, f"{told}: the robot was moved"))
        return True

    def _follow_slip(self, off_m: float, seen_m: float, motion: Motion) -> bool:
        """While the wheels slip: the laser's way counts, and how much of theirs it is."""
        if motion.time_s <= KEY_SLIPPING_S:
            return False
        self._owed_m += off_m
        if abs(motion.wheels_m) < 0.5 * LEAST_WAY_M:
            return True
        share = min(max(seen_m / motion.wheels_m, 0.0), 1.5)
        self._gripped = self._gripped + 1 if abs(1.0 - share) < GRIPS_AGAIN else 0
        self.grip = share
        if self._gripped >= GRIPS_IN_A_ROW:
            self.grip = 1.0
            self.news.append(News(WHEELS_GRIP, "wheels and laser agree again about the way"))
        return True

    def _renew(self, scan: KeyScan) -> None:
        self._key = scan

    def _begin_anew(self) -> None:
        """What was reckoned until now was reckoned wrongly: compare from here on."""
        self._key, self._since_s = None, self._reckoning.now_s
