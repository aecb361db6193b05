"""The simulator's own time: integer nanoseconds on a grid of 10 ms, shared by all its parts."""

from __future__ import annotations

NS = 1_000_000_000
TICK_NS = 10_000_000
TICK_S = TICK_NS / NS
NEVER_NS = 2**62


def ticks_up(time_ns: int) -> int:
    """The first moment of the grid that is not before `time_ns`."""
    return -(-time_ns // TICK_NS) * TICK_NS


def period_ns(rate_hz: float) -> int:
    """The period of a sensor; at least one tick, because nothing changes in between."""
    return max(TICK_NS, round(NS / rate_hz))


class SimTime:
    """Now, as the physics has it. One writer, the simulator; everybody may read."""

    __slots__ = ("now_ns", "now_s")

    def __init__(self) -> None:
        self.now_ns = 0
        self.now_s = 0.0

    def jump_to(self, now_ns: int) -> None:
        """Set both forms of now."""
        self.now_ns = now_ns
        self.now_s = now_ns / NS
