"""The bumper panels: pressed while something is within their depth of the front or back half of the outline."""

from __future__ import annotations

from drivers.records import BumperRecord
from pluto_bt.maps import platform
from sim.body import Body
from sim.outline import Outline
from sim.simtime import period_ns
from sim.surroundings import Surroundings
from sim.travel import Travel

CHECK_HZ = 50.0
REPEAT_S = 0.1  # a change is reported at once, the same state every 0.1 s


class BumperSensor:
    """Both panels. An ideal bumper is always open (the manual's dummy base)."""

    period_ns = period_ns(CHECK_HZ)

    def __init__(self, figures: platform.Bumpers, outline: Outline, body: Body, around: Surroundings, travel: Travel, ideal: bool) -> None:
        self._depth_m, self._body, self._around, self._travel, self._ideal = figures.depth_m, body, around, travel, ideal
        grown = outline.grown(figures.depth_m)
        self._front, self._back = grown.half(front=True), grown.half(front=False)
        self._sent = (False, False)
        self._sent_s = -REPEAT_S

    def sample(self, now_s: float) -> BumperRecord | None:
        """The panels now; None if there is nothing new to say."""
        near = not self._ideal and self._travel.free_m <= self._depth_m
        state = (near and self._presses(self._front), near and self._presses(self._back))
        if state == self._sent and now_s - self._sent_s < REPEAT_S - 1e-9:
            return None
        self._sent, self._sent_s = state, now_s
        return BumperRecord(now_s, now_s, *state)

    def _presses(self, panel: Outline | None) -> bool:
        """True if something solid touches the panel."""
        return panel is not None and self._around.solid_gap_m(panel.at(self._body.pose)) <= 0.0
