"""Whether ray after ray leads anywhere: who has to decide again and again in one place makes no headway."""

from __future__ import annotations

import math

PLACE_M = 0.5  # decisions nearer to each other than this are made in one place
MOST_DECISIONS = 4  # in one place


class Headway:
    """Counts the decisions made in one place."""

    def __init__(self) -> None:
        self._place: tuple[float, float] | None = None
        self._decisions = 0

    def decide(self, here: tuple[float, float]) -> bool:
        """Note a decision made here; False if there have been too many."""
        if self._place is None or math.dist(here, self._place) > PLACE_M:
            self._place, self._decisions = here, 0
        self._decisions += 1
        return self._decisions <= MOST_DECISIONS
