"""The car's `maketurn(angle)` (seed 002; DESIGN.md, section 9): a sharp turn, relative, clockwise positive. One call is 0.1 s.

Steering is ±90 % until the heading is within 10° of the target, so angles that differ by whole turns are the same turn; 0 is done at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from pluto_bt.skills.car_steering import wrap180

TURN_PERCENT: Final = 90.0
DONE_WITHIN_DEG: Final = 10.0
LIMIT_S: Final = 30.0


@dataclass(frozen=True, slots=True)
class MakeTurn:
    """One turn: its side, and the heading (car frame) where it ends."""

    angle_deg: float
    target_deg: float

    @classmethod
    def begin(cls, heading_deg: float, angle_deg: float) -> MakeTurn:
        """A turn by `angle_deg` from the present heading."""
        return cls(angle_deg, heading_deg + angle_deg)

    def to_go_deg(self, heading_deg: float) -> float:
        """What is missing to the target, the shorter way round, without sign."""
        return abs(wrap180(heading_deg - self.target_deg))

    def is_done(self, heading_deg: float) -> bool:
        """True within 10° of the target; at once for an angle of 0."""
        return self.angle_deg == 0.0 or self.to_go_deg(heading_deg) < DONE_WITHIN_DEG

    @property
    def steering_percent(self) -> float:
        """Full steering to the side of the angle; + = right."""
        return math.copysign(TURN_PERCENT, self.angle_deg)
