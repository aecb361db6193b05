"""Whether somebody is about who will walk on: then a robot that cannot get on waits, instead of calling itself stuck."""

from __future__ import annotations

import math

from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState
from pluto_bt.skills import reasons

AWAITS_S = 10.0  # so long after the last sign of somebody his fellows, and the echoes that he left behind (8 s), are still awaited
MOVES_MPS, MOVES_RADPS = 0.05, 0.05  # of the wheels; a robot that stood for STOOD_S when its bumper was pressed has not touched: it was touched
STOOD_S = 0.3


class PassersBy:
    """Signs of somebody: the stop filter holds for him, or he walks into a robot that stands."""

    def __init__(self) -> None:
        self._seen_s = self._moved_s = -math.inf
        self._was_pressed = False

    def note(self, now_s: float, held: FVectorState | None, raw: ActuatorState | None, bumper: BumperState | None) -> bool:
        """Take what the filter or drive says of its verdict, how the wheels turn, and what the bumpers feel; None = not known. True if the robot has
        just run into something with its front."""
        if raw is not None and (abs(raw.velocity[0]) > MOVES_MPS or abs(raw.velocity[1]) > MOVES_RADPS):
            self._moved_s = now_s
        stood = now_s - self._moved_s > STOOD_S
        is_pressed = bumper is not None and (bumper.front or bumper.back)
        is_news = is_pressed and not self._was_pressed
        self._was_pressed = is_pressed
        if (is_news and stood) or (held is not None and held.reason == reasons.WALKER):
            self._seen_s = now_s
        return is_news and not stood and bumper is not None and bumper.front

    def are_awaited(self, now_s: float) -> bool:
        """True if somebody was about lately."""
        return now_s - self._seen_s < AWAITS_S
