"""Single short beams: the kernel against its plain twin."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.blackboard.messages import read_only
from pluto_bt.skills.lone_beams import BESIDE, LONE_STEP_M, believed_ends
from pluto_bt.skills.outline import Array

RANGES = st.lists(st.sampled_from([0.5, 0.7, 1.0, 2.0, 8.0, math.inf, math.nan]), max_size=14)


def twin(ranges: Array, before: Array | None, edges_too: bool) -> list[float]:
    """The same, beam by beam, in words of numpy."""
    beyond = np.concatenate(([np.inf], ranges, [np.inf]))
    with np.errstate(invalid="ignore"):
        lone = np.minimum(beyond[:-2], beyond[2:]) - ranges > LONE_STEP_M
        if not edges_too:
            lone[:1] = lone[-1:] = False
        if before is not None and len(before) == len(ranges):
            for i in np.flatnonzero(lone).tolist():
                lone[i] = not np.any(np.abs(before[max(0, i - BESIDE) : i + BESIDE + 1] - ranges[i]) < LONE_STEP_M)
    return [0.0 if is_lone else 1.0 for is_lone in lone.tolist()]


@settings(deadline=None)  # the first example compiles the kernel
@given(ranges=RANGES, before=st.none() | RANGES, edges_too=st.booleans())
def test_a_beam_is_believed_as_the_plain_twin_says(ranges: list[float], before: list[float] | None, edges_too: bool) -> None:
    now, last = read_only(ranges), None if before is None else read_only(before)
    assert believed_ends(now, last, edges_too).tolist() == twin(now, last, edges_too)


def test_a_dazzled_beam_counts_once_the_scan_before_saw_the_same() -> None:
    wall, post = read_only([3.0] * 9), read_only([3.0] * 4 + [1.0] + [3.0] * 4)
    assert believed_ends(post, None, True)[4] == 0.0
    assert believed_ends(post, wall, True)[4] == 0.0
    assert believed_ends(post, post, True)[4] == 1.0
