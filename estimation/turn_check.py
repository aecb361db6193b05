"""What wheels and laser say of the robot's turn: whether its gyro lies, and how an honest one creeps."""

from __future__ import annotations

from estimation.doubt import Doubt
from estimation.news import LOST, News
from estimation.reckoning import Motion, Sums, motion_between
from estimation.trim import OF_GYRO, Trim
from estimation.turn_trial import TurnTrial

SIGMAS = 5.0
FASTER, JITTER_RAD = 2.0, 0.1  # than the platform's limit: nobody turns so fast
ALONE_S, BLIND_S = 1.0, 1.5  # without laser: judged each second, and after so long without


class TurnCheck:
    """Attributes: `trial` of the gyro; `counted_rad`: of the difference to the key scan, so much is owed already."""

    def __init__(self, news: list[News], turn_radps: float, asks_wheels: bool, has_gyro: bool, judges: bool) -> None:
        """`turn_radps`: the platform's limit. `has_gyro`, `judges`: see `MotionCheck`."""
        self.trial = TurnTrial(news, asks_wheels)
        self.counted_rad = 0.0
        self._news, self._turn_radps = news, turn_radps
        self._asks_wheels, self._has_gyro, self._judges = asks_wheels, has_gyro, judges
        self._trim = Trim(OF_GYRO)
        self._talks_nonsense = False
        self._alone: Sums | None = None  # since then the gyro is watched by the wheels

    @property
    def is_known(self) -> bool:
        """False where nothing tells where a car points: its wheels know of no turn."""
        return self.trial.trusts_gyro or self._asks_wheels

    @property
    def believes_tilt(self) -> bool:
        """False while the sensor tells of turns that no robot makes."""
        return self.trial.trusts_gyro or not self._talks_nonsense

    def reckoned(self, dt_s: float, wheel_turn_rad: float, turn_rad: float, is_measured: bool) -> tuple[float, bool]:
        """(turn rad to reckon with, whether a sensor measured it) of one step."""
        if is_measured and self.trial.trusts_gyro and abs(turn_rad) > FASTER * self._turn_radps * dt_s + JITTER_RAD:
            self._refuse(f"the gyro says {turn_rad / dt_s:.3g} rad/s, more than this robot can turn")
        turn_rad, is_measured = self.trial.reckoned(dt_s, wheel_turn_rad, turn_rad, is_measured)
        return (turn_rad + self._trim.rate * dt_s if is_measured else turn_rad), is_measured

    def bias_moved(self, by_radps: float) -> None:
        """The gyro's own bias was measured anew, higher by so much."""
        self.trial.bias_moved(by_radps)
        self._talks_nonsense = False
        self._trim.moved(by_radps)

    def is_due(self, now_s: float) -> bool:
        """True if the wheels have to watch the gyro again."""
        return self._has_gyro and self._asks_wheels and (self._alone is None or now_s - self._alone.stamp_s >= ALONE_S)

    def judge_alone(self, now: Sums, matched_s: float) -> None:
        """Where no laser can say more since `matched_s`, the wheels watch the gyro."""
        before, self._alone = self._alone, now
        if before is not None and now.stamp_s - matched_s > BLIND_S and now.stamp_s - before.stamp_s < 2.0 * ALONE_S:
            self.trial.weigh_alone(motion_between(before, now))

    def is_suspect(self, stamp_s: float, off_rad: float, sigma_rad: float, motion: Motion, doubt: Doubt) -> bool:
        """True if the turn would be found wrong, but the next scan has to confirm it."""
        return self._judges and self.trial.is_suspect(off_rad, SIGMAS * sigma_rad, motion) and not doubt.is_confirmed(stamp_s)

    def is_wrong(self, stamp_s: float, off_rad: float, sigma_rad: float, motion: Motion, lag_s: float) -> bool:
        """True if the turn is found wrong; `lag_s`: so long ago the scan was taken."""
        return self._judges and self.trial.weigh(stamp_s, off_rad, SIGMAS * sigma_rad, motion, lag_s)

    def learn(self, off_rad: float, sigma_rad: float, motion: Motion) -> None:
        """A comparison that is over, and found nothing wrong: learn from it what there is."""
        if self._has_gyro and self.trial.trusts_gyro and motion.is_measured:
            paid_rad = self._trim.take(off_rad, sigma_rad, motion.time_s)
            self.trial.debt.owed += paid_rad
            off_rad -= paid_rad
        self.trial.keep(motion.until_s, off_rad, motion)

    def _refuse(self, why: str) -> None:
        self.trial.refuse(why)
        self._talks_nonsense = True
        if not self._asks_wheels:
            self._news.append(News(LOST, f"{why}, and nothing else tells where the robot points"))
