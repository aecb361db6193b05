"""Gyro bias: the mean rate of a robot that stands still (DESIGN.md, section 9: 1000 samples; not still: refuse and say so)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum


class BiasNews(Enum):
    """What a sample changed."""

    NOTHING = "nothing"
    KNOWN = "known"
    MOVED = "moved"  # the robot moved while samples were taken: all are thrown away
    UNSTEADY = "unsteady"  # the rates scatter too much for a robot at rest: all are thrown away


@dataclass(slots=True)
class GyroBias:
    """Collects standstill samples until the bias is known. Mean and variance run along (Welford), so nothing is stored.

    Attributes:
        samples_needed: how many samples make a bias.
        max_spread_radps: largest standard deviation of the samples that passes for standing still.
        bias_radps: 0 until `known`.
        taken: samples of the present attempt.
        thrown_away: samples of the last attempt that failed.
    """

    samples_needed: int = 1000
    max_spread_radps: float = 0.03
    bias_radps: float = 0.0
    spread_radps: float = 0.0
    known: bool = False
    taken: int = 0
    thrown_away: int = 0
    _mean: float = 0.0
    _squares: float = 0.0

    def add(self, rate_radps: float, is_still: bool) -> BiasNews:
        """One sample of the raw rate about z. After `KNOWN` further samples change nothing."""
        if self.known:
            return BiasNews.NOTHING
        if not is_still:
            news = BiasNews.MOVED if self.taken else BiasNews.NOTHING
            self._start_again()
            return news
        self.taken += 1
        change = rate_radps - self._mean
        self._mean += change / self.taken
        self._squares += change * (rate_radps - self._mean)
        return BiasNews.NOTHING if self.taken < self.samples_needed else self._judge()

    def _judge(self) -> BiasNews:
        self.spread_radps = math.sqrt(self._squares / self.taken)
        if self.spread_radps > self.max_spread_radps:
            self._start_again()
            return BiasNews.UNSTEADY
        self.bias_radps, self.known = self._mean, True
        return BiasNews.KNOWN

    def _start_again(self) -> None:
        self.thrown_away = self.taken or self.thrown_away
        self.taken, self._mean, self._squares = 0, 0.0, 0.0
