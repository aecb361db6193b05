"""The true path of a run, small however long the run is."""

from __future__ import annotations

from array import array
from typing import NamedTuple

NUMBERS = 4  # of a point: t s, x m, y m, theta rad
MOST_POINTS = 12_000  # twenty minutes at ten points a second; then every second point goes


class TrackPoint(NamedTuple):
    """Where the robot really was."""

    t_s: float
    pose: tuple[float, float, float]


class Track:
    """Points in order of time; thinned by half whenever there are too many."""

    def __init__(self) -> None:
        self._numbers = array("d")
        self._every = 1
        self._seen = 0

    def add(self, t_s: float, pose: tuple[float, float, float]) -> None:
        """Take the next point of the path."""
        if self._seen % self._every == 0:
            self._numbers.extend((t_s, *pose))
            if len(self._numbers) >= NUMBERS * MOST_POINTS:
                self._thin()
        self._seen += 1

    def _thin(self) -> None:
        old = self._numbers
        self._numbers = array("d")
        for i in range(0, len(old), 2 * NUMBERS):
            self._numbers.extend(old[i : i + NUMBERS])
        self._every *= 2

    @property
    def points(self) -> list[TrackPoint]:
        """All points."""
        n = self._numbers
        return [TrackPoint(n[i], (n[i + 1], n[i + 2], n[i + 3])) for i in range(0, len(n), NUMBERS)]
