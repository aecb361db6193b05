"""What dead reckoning owes: an error found late is made up for bit by bit, for dead reckoning never jumps."""

from __future__ import annotations

import math


class Debt:
    """A sum (m or rad) that is paid no faster than `rate` a second."""

    __slots__ = ("owed", "rate")

    def __init__(self, rate: float) -> None:
        self.rate = rate
        self.owed = 0.0

    def pay(self, dt_s: float) -> float:
        """The part that is due after `dt_s` more seconds."""
        if not self.owed:
            return 0.0
        paid = math.copysign(min(abs(self.owed), self.rate * dt_s), self.owed)
        self.owed -= paid
        return paid
