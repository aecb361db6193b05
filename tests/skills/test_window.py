"""Windows of cells."""

from __future__ import annotations

import pytest

from pluto_bt.skills.window import Window


def test_a_window_around_a_place_reaches_as_far_on_every_side() -> None:
    assert Window.around(10.4, 20.6, 3.0) == (7, 14, 17, 24)


@pytest.mark.parametrize(("one", "other", "both"), [((0, 2, 5, 6), (1, 9, 3, 4), (0, 9, 3, 6)), ((0, 2, 5, 6), None, (0, 2, 5, 6))])
def test_two_windows_are_joined_in_the_smallest_that_holds_both(one: Window, other: Window | None, both: Window) -> None:
    assert Window(*one).joined(None if other is None else Window(*other)) == both


def test_a_window_stays_on_its_cells_when_the_grid_moves_and_grows_up_to_the_edge() -> None:
    assert Window(3, 5, 4, 8).moved(2, -3) == (1, 3, 7, 11)
    assert Window(3, 18, 4, 8).grown(4, 20) == (0, 20, 0, 12)
