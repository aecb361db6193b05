"""Finding a past stamp among remembered moments."""

from __future__ import annotations

import bisect
from collections import deque
from typing import Protocol, TypeVar


class Stamped(Protocol):
    """What is remembered by its time."""

    @property
    def stamp_s(self) -> float:
        """When it was."""


M = TypeVar("M", bound=Stamped)


def stamp_of(moment: Stamped) -> float:
    """The key to search by."""
    return moment.stamp_s


def enclosing(moments: deque[M], stamp_s: float) -> tuple[M, M, float] | None:
    """The moments before and after a stamp, and where it lies between them (0 … 1; at a moment itself that one twice); None outside the memory."""
    i = bisect.bisect_left(moments, stamp_s, key=stamp_of)
    if i == len(moments) or (i == 0 and moments[0].stamp_s != stamp_s):
        return None
    after = moments[i]
    if after.stamp_s == stamp_s:
        return after, after, 0.0
    before = moments[i - 1]
    return before, after, (stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s)
