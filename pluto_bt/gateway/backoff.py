"""When to try again."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Backoff:
    """Waits that grow: `first_s`, then `factor` times the one before, never above `longest_s`."""

    first_s: float = 0.05
    factor: float = 2.0
    longest_s: float = 2.0

    def delay_s(self, attempt: int) -> float:
        """How long to wait before the attempt of that number (0 = the first)."""
        return min(self.first_s * self.factor ** min(attempt, 64), self.longest_s)


AGAIN = Backoff()
STEADY_S = 5.0  # a connection that lived so long was a good one: after it the waits begin anew
