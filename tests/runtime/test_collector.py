"""The collector while a robot runs: it leaves alone what was there, still finds garbage, and is as before afterwards."""

from __future__ import annotations

import gc
import weakref

import pytest

from pluto_bt.runtime.collector import YOUNG, rarely_collecting


class Knot:
    """Refers to itself: only the collector can take it away."""

    def __init__(self) -> None:
        self.itself = self


def test_what_was_there_is_left_alone_and_garbage_is_found() -> None:
    gc.collect()  # so that it does not begin by itself in between
    old = weakref.ref(Knot())
    with rarely_collecting():
        assert gc.get_threshold()[0] >= YOUNG
        new = weakref.ref(Knot())
        gc.collect()
        assert old() is not None and new() is None
    gc.collect()
    assert old() is None


def test_afterwards_all_is_as_before_also_after_a_failure() -> None:
    usual = gc.get_threshold()
    with pytest.raises(KeyError), rarely_collecting():
        raise KeyError("a run that fails")
    assert gc.get_threshold() == usual and gc.get_freeze_count() == 0


def test_who_has_switched_it_off_finds_it_off() -> None:
    usual = gc.get_threshold()
    try:
        gc.set_threshold(0)
        with rarely_collecting():
            assert gc.get_threshold()[0] == 0
    finally:
        gc.set_threshold(*usual)
