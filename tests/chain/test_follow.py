"""Who is followed, and where the robot drives for it: free-standing pieces, tracks, crossing, hiding, giving up."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from pluto_bt.skills.follow import Follow, Search
from pluto_bt.skills.pieces import Piece, pieces_of
from pluto_bt.skills.tracks import FURNITURE, Track, Tracks

STEP = math.radians(0.5)
HERE = (0.0, 0.0, 0.0)


def scan(*discs: tuple[float, float, float], wall_m: float = 8.0) -> np.ndarray:
    """361 ranges over 180° from the origin: discs (x, y, r) before a wall all round."""
    ranges = np.full(361, wall_m)
    for i, angle in enumerate(-math.pi / 2 + STEP * np.arange(361)):
        for x, y, r in discs:
            along, beside = x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)
            if along > 0 and abs(beside) < r:
                ranges[i] = min(ranges[i], along - math.sqrt(r * r - beside * beside))
    return ranges


def pieces(ranges: np.ndarray, laser: tuple[float, float, float] = HERE) -> list[Piece]:
    return pieces_of(ranges, -math.pi / 2, STEP, laser, 10.0, 0.8)


class TestPieces:
    def test_a_person_is_one_piece_with_the_middle_of_the_near_side(self) -> None:
        (piece,) = pieces(scan((3.0, 1.0, 0.25)))
        assert (piece.x_m, piece.y_m) == pytest.approx((2.82, 0.94), abs=0.03)
        assert piece.width_m == pytest.approx(0.5, abs=0.06)

    def test_it_is_in_the_frame_of_the_laser_s_pose(self) -> None:
        (piece,) = pieces(scan((3.0, 0.0, 0.25)), (10.0, 5.0, math.pi / 2))
        assert (piece.x_m, piece.y_m) == pytest.approx((10.0, 7.82), abs=0.03)

    def test_walls_and_wide_things_and_strips_beside_a_shadow_are_none(self) -> None:
        assert pieces(scan()) == []
        assert pieces(scan((3.0, 0.0, 0.6))) == []
        assert len(pieces(scan((3.0, 0.0, 0.25), (3.0, 0.9, 0.25)))) == 2, "the strip of wall between them is farther than both"

    def test_who_is_half_hidden_is_none(self) -> None:
        found = pieces(scan((2.0, 0.0, 0.25), (4.0, 0.5, 0.25)))
        assert [piece.x_m < 2.0 for piece in found] == [True]

    def test_beams_without_a_number_and_the_edge_of_the_field(self) -> None:
        assert pieces(np.full(361, np.nan)) == pieces(np.full(361, -1.0)) == []
        assert pieces(scan((0.0, 2.0, 0.25))) == [], "cut off by the edge: nobody knows how wide it is"


Walk = Callable[[float], tuple[float, float] | None]


def play(walks: dict[str, Walk], until_s: float, distance_m: float = 1.5, most_mps: float = 0.8) -> tuple[Follow, list[float], Search]:
    """A robot that does as it is told among walkers (None = out of sight), scanning at 5 Hz; the distances to `guide`, and how it ended."""
    x, y, theta = HERE
    follow, distances, state = Follow(distance_m, most_mps, 0.0), [], Search.LOOKING
    for k in range(round(until_s / 0.1)):
        now_s = 0.1 * k
        seen = [at for walk in walks.values() if (at := walk(now_s)) is not None]
        if k % 2 == 0:
            ahead = [at for at in seen if abs(math.remainder(math.atan2(at[1] - y, at[0] - x) - theta, math.tau)) < math.pi / 2]
            follow.see([Piece(*at, 0.45) for at in ahead], (x, y, theta), now_s)
        state = follow.state(now_s)
        if state in (Search.NOBODY, Search.LOST):
            break
        if state is not Search.LOOKING:
            aim = follow.aim((x, y, theta), now_s)
            theta += max(-0.08, min(0.08, aim.turn_rad))
            x, y = x + 0.1 * aim.speed_mps * math.cos(theta), y + 0.1 * aim.speed_mps * math.sin(theta)
        guide = walks["guide"](now_s)
        distances.append(math.inf if guide is None else math.hypot(guide[0] - x, guide[1] - y))
    return follow, distances, state


def straight(now_s: float) -> tuple[float, float]:
    return 2.5 + 0.5 * now_s, 0.3


def post(now_s: float) -> tuple[float, float]:
    return 2.0, -0.8


def test_the_distance_is_kept_behind_one_who_walks_and_posts_are_left_alone() -> None:
    _, distances, state = play({"guide": straight, "post": post}, 30.0)
    assert state is Search.SEEN
    assert all(1.35 < distance < 1.75 for distance in distances[150:])


def test_the_nearest_of_those_who_move_is_chosen_even_if_he_is_slow() -> None:
    follow, _, _ = play({"guide": lambda t: (3.0 + 0.3 * t, 0.0), "runner": lambda t: (6.0, -3.0 + 1.2 * t)}, 2.0)
    assert follow.target is not None and abs(follow.target.y_m) < 0.2


def test_one_who_crosses_between_does_not_take_the_robot_with_him() -> None:
    def guide(t: float) -> tuple[float, float] | None:
        return None if 5.6 <= t < 6.4 else straight(t)

    follow, distances, state = play({"guide": guide, "crosser": lambda t: (3.9, -4.8 + 0.8 * t)}, 20.0)
    assert state is Search.SEEN
    assert follow.target is not None and abs(follow.target.y_m - 0.3) < 0.2
    assert distances[-1] < 1.8


@pytest.mark.parametrize("pace_mps", [0.5, 0.8, 1.1])
@pytest.mark.parametrize("behind_m", [0.2, 0.3])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_two_who_hang_together_in_the_scan_for_a_moment_are_not_mixed_up(pace_mps: float, behind_m: float, side: float) -> None:
    """The crosser comes out from behind a post, and passes so near behind the guide that the laser shows one wide thing; then he alone is seen."""
    follow, meet_s = Follow(1.5, 0.8, 0.0), 6.0
    for k in range(75):
        now_s = 0.2 * k
        guide = straight(now_s)
        crosser = (straight(meet_s)[0] - behind_m, 0.3 + side * pace_mps * (meet_s - now_s))
        apart_m, robot = math.dist(guide, crosser), (guide[0] - 2.0, 0.3, 0.0)
        seen = [Piece(*guide, 0.45)] if now_s < meet_s and apart_m > 0.9 else [Piece(*guide, 0.45), Piece(*crosser, 0.45)]
        if abs(crosser[1] - guide[1]) < 0.1:
            seen = [Piece(*crosser, 0.45)]
        elif apart_m < 0.75:
            seen = [Piece(0.5 * (guide[0] + crosser[0]), 0.5 * (guide[1] + crosser[1]), 0.45 + 0.5 * apart_m)]
        follow.see(seen, robot, now_s)
    assert follow.state(now_s) is Search.SEEN
    assert follow.target is not None and math.dist((follow.target.x_m, follow.target.y_m), guide) < 0.2


def test_one_who_is_hidden_for_three_seconds_is_found_again() -> None:
    _, distances, state = play({"guide": lambda t: None if 8.0 <= t < 11.0 else straight(t)}, 30.0)
    assert state is Search.SEEN and distances[-1] < 1.8


def test_one_who_does_not_come_back_is_given_up_after_eight_seconds() -> None:
    _, distances, state = play({"guide": lambda t: None if t >= 8.0 else straight(t)}, 30.0)
    assert state is Search.LOST
    assert 0.1 * len(distances) == pytest.approx(8.0 + 8.0, abs=0.4)


def test_where_nothing_moves_there_is_nobody_after_ten_seconds() -> None:
    _, distances, state = play({"guide": post}, 30.0)
    assert state is Search.NOBODY and 0.1 * len(distances) == pytest.approx(10.0, abs=0.2)


def test_near_enough_it_stands_and_turns_to_the_target() -> None:
    follow, _, _ = play({"guide": lambda t: (2.0, min(t, 4.0) * 0.3)}, 12.0, distance_m=2.0)
    aim = follow.aim((0.3, 0.0, 0.0), 11.9)
    assert aim.speed_mps == 0.0 and aim.turn_rad == pytest.approx(math.atan2(1.2, 1.7), abs=0.1)


def test_where_he_was_seen_last_the_robot_looks_where_he_went() -> None:
    follow, _, _ = play({"guide": lambda t: (3.0, 0.5 * t) if t < 5.0 else None}, 7.5)
    assert follow.state(7.5) is Search.HIDDEN
    x, y = follow.target.at(7.5) if follow.target is not None else (math.nan, math.nan)
    assert follow.aim((x - 0.2, y, 0.0), 7.5).turn_rad == pytest.approx(math.pi / 2, abs=0.2)


def test_a_pause_does_not_count() -> None:
    follow, _, _ = play({"guide": straight}, 6.0)
    assert follow.state(20.0) is Search.LOST
    follow.pause(14.0)
    assert follow.state(20.0) is Search.SEEN


def test_one_who_stops_while_he_is_hidden_is_found_where_he_stands_and_furniture_is_not_him() -> None:
    def guide(t: float) -> tuple[float, float] | None:
        return straight(t) if t < 8.0 else None if t < 11.0 else (8.6, 0.6)

    follow, distances, state = play({"guide": guide, "post": lambda t: (6.0, -0.9), "bin": lambda t: (7.5, 1.4)}, 25.0)
    assert state is Search.SEEN
    assert follow.target is not None and math.dist((follow.target.x_m, follow.target.y_m), (8.6, 0.6)) < 0.3
    assert distances[-1] == pytest.approx(1.5, abs=0.4)


def test_the_memory_of_furniture_has_an_end_and_keeps_the_newest() -> None:
    tracks = Tracks()
    for k in range(2 * FURNITURE):  # one thing after the other is looked at for a second, then left behind
        for scan in range(6):
            tracks.see([Piece(2.0 * k, 0.0, 0.4)], 3.0 * k + 0.2 * scan, None)
    tracks.see([], 6.0 * FURNITURE, None)

    def stood_at(k: int) -> bool:
        return tracks.stood_there(Track(2.0 * k, 0.0, 0.4, 0.0, 0.0, (0.0, 0.0)))

    assert [stood_at(k) for k in (0, FURNITURE - 1, FURNITURE, 2 * FURNITURE - 1)] == [False, False, True, True]


def test_a_scan_that_cuts_him_in_two_does_not_part_him_from_his_track() -> None:
    follow = Follow(1.5, 0.8, 0.0)
    for k in range(60):
        x, y = straight(0.2 * k)
        halves = [Piece(x, y - 0.12, 0.22), Piece(x, y + 0.12, 0.22)]
        follow.see(halves if k == 30 else [Piece(x, y, 0.46)], HERE, 0.2 * k)
    assert follow.target is not None and follow.target.born_s == 0.0
    assert follow.state(12.0) is Search.SEEN


def test_two_who_cross_keep_their_tracks() -> None:
    follow = Follow(1.5, 0.8, 0.0)
    for k in range(60):
        t = 0.2 * k
        one, other = (3.0, -2.0 + 0.5 * t), (3.5, 2.5 - 0.5 * t)
        hidden = abs(math.atan2(other[1], other[0]) - math.atan2(one[1], one[0])) < 0.12
        follow.see([Piece(*one, 0.46)] + ([] if hidden else [Piece(*other, 0.46)]), HERE, t)
    assert follow.target is not None
    assert math.dist((follow.target.x_m, follow.target.y_m), one) < 0.3, "the nearest, from the beginning to the end"


def test_a_lost_beam_does_not_cut_a_body() -> None:
    ranges = scan((3.0, 0.0, 0.25))
    ranges[180] = 8.0
    ranges[184] = np.nan
    (piece,) = pieces(ranges)
    assert piece.width_m == pytest.approx(0.5, abs=0.06)
