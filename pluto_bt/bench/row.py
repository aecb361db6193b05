"""One line of a benchmark, and how its figures are taken."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pluto_bt.runtime.clock import wall_ns


@dataclass(frozen=True, slots=True)
class BenchRow:
    """A measured figure beside the figure to reach (`target`, as a word: "<= 0.25"; "" = none)."""

    name: str
    value: float
    unit: str
    target: str = ""
    note: str = ""


def best_us(call: Callable[[], object], repeats: int = 200) -> float:
    """Microseconds of the fastest of many calls, the first (which may compile) left out: the least disturbed one."""
    call()
    least_ns = 1 << 62
    for _ in range(repeats):
        start_ns = wall_ns()
        call()
        least_ns = min(least_ns, wall_ns() - start_ns)
    return least_ns / 1000


def best_pair_us(one: Callable[[], object], other: Callable[[], object], repeats: int = 200) -> tuple[float, float]:
    """`best_us` of two calls taken in turns, so that a change of the machine's pace meets both."""
    least = [1e18, 1e18]
    for _ in range(max(1, repeats // 20)):
        least = [min(least[0], best_us(one, 20)), min(least[1], best_us(other, 20))]
    return least[0], least[1]
