"""Finding a past stamp among remembered moments."""

from __future__ import annotations

from collections import deque
from typing import Protocol, TypeVar


class Stamped(Protocol):
    """What is remembered by its time."""

    @property
    def stamp_s(self) -> float:
        """When it was."""


M = TypeVar("M", bound=Stamped)


def enclosing(moments: deque[M], stamp_s: float) -> tuple[M, M, float] | None:
    """The moments before and after a stamp, and where it lies between them (0 … 1; at a moment itself that one twice); None outside the memory."""
    before = after = None
    for moment in reversed(moments):  # what is asked for is nearly always among the newest
        if moment.stamp_s < stamp_s:
            before = moment
            break
        after = moment
    if after is not None and after.stamp_s == stamp_s:
        return after, after, 0.0
    if before is None or after is None:
        return None
    return before, after, (stamp_s - before.stamp_s) / (after.stamp_s - before.stamp_s)
