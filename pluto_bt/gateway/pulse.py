"""Whether a process of ours still goes round: it says something four times a second, and we count how long it has not."""

from __future__ import annotations

from pluto_bt.runtime.clock import NS

BEAT_S = 0.25
"""How often it says something, once it serves."""
SILENCE_S = 2.0
FIRST_S = 30.0
"""How long it may take until it serves: a slow computer loads its libraries."""
OUR_ABSENCE_S = 1.0
"""What counts of the time between two looks: who looks may have been stopped himself, and has not read what was said meanwhile."""


class Pulse:
    """The silence of one process, in the time of who looks."""

    def __init__(self, now_ns: int) -> None:
        self._looked_ns = now_ns
        self._silent_ns = 0
        self._is_heard = False
        self._has_begun = False

    def hear(self) -> None:
        """It said something. From any thread."""
        self._is_heard = True

    def is_lost(self, now_ns: int) -> bool:
        """Look: True if it has been silent for too long."""
        self._silent_ns += min(now_ns - self._looked_ns, round(OUR_ABSENCE_S * NS))
        self._looked_ns = now_ns
        if self._is_heard:
            self._is_heard, self._has_begun, self._silent_ns = False, True, 0
        return self._silent_ns >= (SILENCE_S if self._has_begun else FIRST_S) * NS
