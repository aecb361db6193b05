"""Single beams so much shorter than both their neighbours that they may be dazzle, rain or a leaf: the scan before has to confirm them."""

from __future__ import annotations

import numpy as np

from pluto_bt.blackboard.messages import read_only
from pluto_bt.maps.kernel import kernel
from pluto_bt.skills.outline import Array

LONE_STEP_M = 0.3
BESIDE = 4  # the robot has moved since: so many beams to either side of it may have seen the same

NO_SCAN: Array = read_only(())  # for the scan before, where there is none


def believed_ends(ranges: Array, before: Array | None, edges_too: bool) -> Array:
    """(n,) 1 where the end of a beam is believed, 0 where it stands alone and `before`, the scan before, does not confirm it.

    Args:
        edges_too: the first and the last beam have one neighbour, and are judged by that; else they are believed.
    """
    comparable = before is not None and len(before) == len(ranges)
    return _believed(ranges, before if comparable and before is not None else NO_SCAN, edges_too)


@kernel
def _believed(ranges: Array, before: Array, edges_too: bool) -> Array:
    n = ranges.shape[0]
    believed = np.ones(n)
    for i in range(0 if edges_too else 1, n if edges_too else n - 1):
        range_m = ranges[i]
        right_m, left_m = ranges[i - 1] if i > 0 else np.inf, ranges[i + 1] if i < n - 1 else np.inf
        if not (right_m - range_m > LONE_STEP_M and left_m - range_m > LONE_STEP_M):  # also NaN
            continue
        believed[i] = 0.0
        for k in range(max(0, i - BESIDE), min(before.shape[0], i + BESIDE + 1)):
            if abs(before[k] - range_m) < LONE_STEP_M:
                believed[i] = 1.0
    return believed
