"""The topic `map/local`: the local map of a job, cut to what is known, about once in two seconds."""

from __future__ import annotations

import numpy as np

from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard.messages import LocalMapState
from pluto_bt.modules.context import Context

EVERY_S = 2.0
UNKNOWN, FREE, COVERED, STANDS, LOW = range(5)


class LocalMapShown:
    """The writer of the topic."""

    def __init__(self, context: Context) -> None:
        self._topic = context.board.publisher("map/local", "executive")
        self._next_s = 0.0

    def show(self, around: Surroundings, now_s: float, is_last: bool) -> None:
        """Publish if it is time, or if the job ends."""
        if now_s >= self._next_s or is_last:
            self._next_s = now_s + EVERY_S
            self._topic.put(shown(around, now_s), now_s)


def shown(around: Surroundings, now_s: float) -> LocalMapState:
    """The map as a message."""
    map = around.map
    oldest_s = max(0.0, now_s - map.parameters.ground_memory_s) - 1e-3
    is_known = (map.evidence != 0) | (map.low_s > oldest_s)
    rows, columns = np.flatnonzero(is_known.any(axis=1)), np.flatnonzero(is_known.any(axis=0))
    if not len(rows):
        return LocalMapState(now_s, cell_m=map.cell_m)
    cut = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    is_free = map.evidence[cut] < 0
    is_covered = (map.covered[cut] != 0) & is_free
    cells = np.where(is_free, FREE, UNKNOWN).astype(np.uint8)
    cells[is_covered] = COVERED
    cells[map.evidence[cut] > 0] = STANDS
    cells[map.low_s[cut] > oldest_s] = LOW
    x_m, y_m = (int(rows[0]) + map.i0) * map.cell_m, (int(columns[0]) + map.j0) * map.cell_m
    covered_m2 = float(np.count_nonzero(is_covered)) * map.cell_m**2
    return LocalMapState(now_s, x_m, y_m, map.cell_m, cells.shape[0], cells.shape[1], cells.tobytes(), covered_m2)
