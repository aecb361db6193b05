"""Adapter `arm`: folds and unfolds the arm. The manual announces an arm and says no more of it, so its driver only keeps its time."""

from __future__ import annotations

import math

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.platform import Arm as ArmFigures
from pluto_bt.modules.context import Context
from pluto_bt.modules.refusal import Refusal


class Arm:
    """`arm/state`: position[0] = how far it is unfolded, 0 to 1; velocity[0] = how fast that changes. A stop holds it where it is.

    What makes no sense moves nothing, and that is said.
    """

    def __init__(self, context: Context) -> None:
        figures = context.platform.devices.arm or ArmFigures()
        self._rate_per_s = 1.0 / figures.unfold_s
        self._inbox = context.inboxes["arm"]
        self._state = context.board.publisher("arm/state", "arm")
        self._share = self._target = 0.0
        self._last_s = 0.0
        self._refusal = Refusal(context, "arm")

    def start(self, now_s: float) -> None:
        """It stays where it is."""
        self._last_s = now_s

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """A command, a piece of the way, the state."""
        letter = self._inbox.take()
        if letter is not None and letter.is_stop:
            self._target = self._share
        elif letter is not None:
            self._aim(letter.command.position[0])
        step = self._rate_per_s * (now_s - self._last_s)
        before, self._last_s = self._share, now_s
        self._share += min(max(self._target - self._share, -step), step)
        rate = (self._share - before) / step * self._rate_per_s if step > 0.0 else 0.0
        self._state.put(ActuatorState(now_s, 0, (self._share, 0.0), (rate, 0.0)), now_s)

    def _aim(self, share: float) -> None:
        is_sense = math.isfinite(share)
        self._refusal.judge("" if is_sense else f"the arm takes how far it is to be unfolded, 0 to 1, not {share}")
        self._target = min(max(share, 0.0), 1.0) if is_sense else self._target
