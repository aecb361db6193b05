"""Do the encoders follow the commands? Wheels that are told to turn and do not, or encoders that lie, look the same: neither may drive on."""

from __future__ import annotations

from collections import deque

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL, Limits, Twist, ramp
from pluto_bt.skills.verdict import ALL_WELL, Verdict

LEAST_M, LEAST_RAD = 0.012, 0.02  # less expected way or turn says nothing
LONGEST_S = 0.12  # after a longer time without a look nothing is known of what the wheels did meanwhile
LEAST_SHARE = 0.15  # of the expected way: less counts as standing still
LAG_S = 0.05  # motors follow so late; else a turn that begins suddenly, after a long while of hardly any, looks like one that is not followed


class Channel:
    """One number of the odometry, distance or heading: its expected and its counted change since it last was seen to follow.

    Counted is every way, forwards or back: on the way from one direction to the other the wheels are later than the model.
    """

    def __init__(self, least: float) -> None:
        self._least = least
        self.begin(0.0, 0.0)

    def begin(self, counted: float, now_s: float) -> None:
        """Compare from now on."""
        self._since_s, self._last = now_s, counted
        self.expected = self.changed = 0.0

    def stands_s(self, rate: float, told: float, dt_s: float, counted: float, now_s: float) -> float:
        """For how long it has stood still though it was expected to change; 0 if it follows.

        Args:
            rate: what a motor model says it does now. told: what the base was told. On the way from one sign to the other nothing is known.
        """
        self.expected += rate * dt_s
        self.changed, self._last = self.changed + abs(counted - self._last), counted
        if told == 0.0 or told * rate < 0.0:
            self.begin(counted, now_s)
        elif abs(self.expected) > self._least:
            if self.changed >= LEAST_SHARE * abs(self.expected):
                self.begin(counted, now_s)
            else:
                return now_s - self._since_s
        return 0.0


class WheelWatch:
    """Compares what the commands in force should have done with what the encoders say."""

    def __init__(self, limits: Limits, still_s: float, retry_s: float) -> None:
        self._limits, self._still_s, self._retry_s = limits, still_s, retry_s
        self._model: Twist = STILL
        self._late: deque[tuple[float, Twist]] = deque([(0.0, STILL)])  # the model of the last moments: since when, and the twist
        self._last_s: float | None = None
        self._way, self._turn = Channel(LEAST_M), Channel(LEAST_RAD)
        self._held_until_s, self._raw_s = -1.0, -1.0
        self._text = ""

    def step(self, raw: ActuatorState, in_force: Twist, now_s: float) -> Verdict:
        """`in_force`: the twist that the base was told last."""
        if self._last_s is None or now_s - self._last_s > LONGEST_S:
            self._model = raw.velocity
            self._late = deque([(now_s, raw.velocity)])
            self._begin(raw, now_s)
            self._last_s = now_s
        dt_s, self._last_s = now_s - self._last_s, now_s
        self._model = ramp(self._model, in_force, self._limits, dt_s)
        rate, turn_rate = self._lagging(now_s)
        if now_s < self._held_until_s:
            self._begin(raw, now_s)
            return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_FROZEN, self._text)
        way_s = self._way.stands_s(rate, in_force[0], dt_s, raw.position[0], now_s)
        turn_s = self._turn.stands_s(turn_rate, in_force[1], dt_s, raw.position[1], now_s)
        is_news, self._raw_s = raw.stamp_s != self._raw_s, raw.stamp_s
        if not is_news or max(way_s, turn_s) < self._still_s:  # who counts nothing says so in new readings; where none come, that is another fault
            return ALL_WELL
        self._held_until_s = now_s + self._retry_s
        self._text = (
            f"the wheels were told to run {self._way.expected:.2f} m and {self._turn.expected:.2f} rad; "
            f"the encoders say {self._way.changed:.2f} m and {self._turn.changed:.2f} rad"
        )
        return Verdict(LinkStatus.NORMAL, reasons.ODOMETRY_FROZEN, self._text)

    def _lagging(self, now_s: float) -> Twist:
        """The model as it was `LAG_S` ago."""
        self._late.append((now_s, self._model))
        while len(self._late) > 1 and self._late[1][0] <= now_s - LAG_S:
            self._late.popleft()
        return self._late[0][1]

    def _begin(self, raw: ActuatorState, now_s: float) -> None:
        self._way.begin(raw.position[0], now_s)
        self._turn.begin(raw.position[1], now_s)
