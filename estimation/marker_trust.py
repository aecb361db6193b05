"""Markers against the estimate: who is believed when they contradict one another?

A marker that hangs elsewhere than the map says, or turned, contradicts the estimate each time it is seen; so does every marker once somebody
has carried the car. The difference: a marker that agreed before has not moved, and two markers do not lie alike.
"""

from __future__ import annotations

import math
from collections import deque
from itertools import pairwise
from typing import Final, NamedTuple

from pluto_bt.maps.geometry import wrap_angle

ALIKE_M: Final = 0.5  # two readings that differ by less from the estimate tell the same
PARTING_MPS: Final = 2.0  # so fast the estimate of a car that points elsewhere moves away from it
MOST: Final = 3  # readings that are judged together


class Contradiction(NamedTuple):
    """A reading less the estimate."""

    stamp_s: float
    marker: int
    x_m: float
    y_m: float
    theta_rad: float


class MarkerTrust:
    """The last contradictions in a row, and which markers have ever agreed.

    Attributes:
        alike_rad: two readings whose headings differ by less from the estimate's tell the same.
        alike: how many of the last contradictions tell the same as the newest.
    """

    def __init__(self, alike_rad: float) -> None:
        self.alike_rad = alike_rad
        self.alike = 0
        self._proven: set[int] = set()
        self._accusers: set[int] = set()  # who has contradicted since one agreed
        self._run: deque[Contradiction] = deque(maxlen=MOST)

    def agree(self, marker: int) -> None:
        """This one tells what was reckoned, or is believed now."""
        self._proven.add(marker)
        self.forget()

    def forget(self) -> None:
        """What contradicted is settled."""
        self._run.clear()
        self._accusers.clear()
        self.alike = 0

    def contradict(self, seen: Contradiction) -> None:
        """This one does not."""
        self._run.append(seen)
        self._accusers.add(seen.marker)
        self.alike = sum(self._tells_same(one, seen) for one in self._run)

    @property
    def is_confirmed(self) -> bool:
        """True if those who contradict can be right: one agreed before, or they are several."""
        return len(self._accusers) > 1 or not self._accusers.isdisjoint(self._proven)

    @property
    def is_fresh(self) -> bool:
        """True while none has agreed yet: there is nobody to ask."""
        return not self._proven

    @property
    def is_elsewhere(self) -> bool:
        """True while nobody should drive by the estimate: two that can be right tell the same, or three of one place that the car keeps turning."""
        turns = len(self._run) == MOST and all(_is_same_place(*pair) for pair in pairwise(self._run))
        return self.is_confirmed and not self.is_fresh and (self.alike > 1 or turns)

    def _tells_same(self, one: Contradiction, other: Contradiction) -> bool:
        return _is_same_place(one, other) and abs(wrap_angle(one.theta_rad - other.theta_rad)) < self.alike_rad


def _is_same_place(one: Contradiction, other: Contradiction) -> bool:
    parted_m = PARTING_MPS * abs(math.sin(other.theta_rad / 2.0) * (other.stamp_s - one.stamp_s))
    return math.hypot(one.x_m - other.x_m, one.y_m - other.y_m) < ALIKE_M + parted_m
