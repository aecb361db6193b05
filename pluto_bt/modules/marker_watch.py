"""Has a marker passed lately? Without one the car's place is reckoned from wheels and gyro alone, and grows uncertain."""

from __future__ import annotations

import math

from pluto_bt.blackboard.messages import MarkerState
from pluto_bt.modules.context import Context
from pluto_bt.modules.marker import MarkerParameters
from pluto_bt.skills.reasons import LOST, MARKER_STALE


class MarkerWatch:
    """Tells when none has passed for `marker.silent_after_s`, when one does again, and when they see the car elsewhere than it was reckoned."""

    def __init__(self, context: Context) -> None:
        self._say = context.say
        self._state = context.board.reader("car/marker")
        self._has_camera = context.platform.devices.marker is not None
        self._most_s = context.parameters(MarkerParameters).silent_after_s
        self._passed, self._passed_s = 0, 0.0  # how many, and when the last of them arrived
        self._told = ("", "")
        self._found_s = -math.inf

    def found(self, now_s: float) -> None:
        """Somebody has said where the car is: what was seen before that contradicts nothing any more."""
        self._found_s = now_s

    def silence(self, now_s: float) -> tuple[str, str]:
        """Word and sentence while none has passed for long, or they tell of another place; "" else."""
        if not self._has_camera:
            return "", ""
        sample = self._state()
        seen = sample.value if sample is not None and isinstance(sample.value, MarkerState) else None
        if sample is not None and seen is not None and seen.accepted_count != self._passed:
            self._passed, self._passed_s = seen.accepted_count, sample.written_s
        if sample is not None and seen is not None and seen.is_elsewhere and sample.written_s > self._found_s:
            return LOST, "the markers see the car elsewhere than wheels and gyro have brought it"
        if now_s - self._passed_s <= self._most_s:
            if self._told[0]:
                self._say("info", "marker-again", "local", "a marker has passed again")
            self._told = ("", "")
        elif not self._told[0]:
            self._told = (MARKER_STALE, self._sentence(seen, now_s))
            self._say("warning", *self._told[:1], "local", self._told[1])
        return self._told

    def _sentence(self, seen: MarkerState | None, now_s: float) -> str:
        if seen is None or now_s - seen.stamp_s > self._most_s:
            why = "the camera says nothing"
        else:
            why = "none is in sight" if seen.marker < 0 else f"the last was refused, {seen.refused}"
        return f"no marker has passed for {self._most_s:g} s, {why}: the place is reckoned from wheels and gyro alone"
