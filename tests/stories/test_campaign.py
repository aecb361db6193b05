"""A small campaign: places, starts and goals that are drawn, not chosen. `pluto bench patrols` drives more of them."""

from __future__ import annotations

import multiprocessing
from itertools import pairwise

import numpy as np
import pytest

from pluto_bt.bench.courses import Surveyor
from pluto_bt.bench.patrols import Drive, drive, drives, random_worlds
from pluto_bt.maps.load import load_world
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import Twist
from pluto_bt.skills.stop_filter import FilterSenses, StopFilter
from tests.shared_data import shared_file

A_MOMENT = 20  # steps of the stop filter, a second: an echo may be somebody's till the next ones tell
SEED = 11  # one that no figure was tuned with


def judge(one: Drive) -> None:
    """Success, no contact, and really at each goal; not by a way that a person would find clumsy."""
    result, course = one.runner.result, one.course
    told = f"{one.platform} in {one.place}, seed {one.seed}, {course.start} to {course.goals_text}: {result.text}"
    assert (result.result, result.collisions) == ("SUCCESS", 0), told
    assert one.goal_error_m <= one.allowed_m, told
    assert one.detour < 1.4, told
    assert one.pauses <= 2, told


@pytest.fixture
def walker_s(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """When the stop filter held back for somebody who may walk; filled while a robot drives."""
    times: list[float] = []
    step = StopFilter.step

    def noting(self: StopFilter, wanted: Twist, now_s: float, senses: FilterSenses) -> Twist:
        out = step(self, wanted, now_s, senses)
        if self.verdict.reason == reasons.WALKER:
            times.append(now_s)
        return out

    monkeypatch.setattr(StopFilter, "step", noting)
    return times


@pytest.mark.parametrize("place", [0, 1, 2], ids=["rooms", "street", "wood"])
@pytest.mark.parametrize("platform", ["pioneer", "atrv2", "jbot"])
def test_a_patrol_in_a_place_nobody_chose(walker_s: list[float], platform: str, place: int) -> None:
    done = list(drives(random_worlds(SEED, 0)[place : place + 1], (platform,), SEED))
    assert done
    if platform != "jbot":  # whose ring is alone, and awaits who started it
        assert len(walker_s) <= A_MOMENT, "nobody walks here"
    for one in done:
        judge(one)


@pytest.mark.parametrize(
    ("file", "platform"),
    [("maps/nav2_tb3_sandbox.yaml", "pioneer"), ("maps/aria_triangle.map", "atrv2"), ("worlds/kth_yard.xml", "atrv2")],
)
def test_a_patrol_between_drawn_places_of_a_real_map(file: str, platform: str) -> None:
    done = list(drives([(file, load_world(shared_file("data", *file.split("/"))))], (platform,), SEED))
    assert done
    for one in done:
        judge(one)


def test_people_who_do_not_yield_are_awaited_standing() -> None:
    for one in drives(random_worlds(SEED, 2)[1:2], ("pioneer",), SEED):
        assert (one.runner.result.result, one.runner.result.collisions) == ("SUCCESS", 0), one.runner.result.text


def test_courses_are_free_as_they_promise() -> None:
    post = Shape("post", "circle", np.array([[0.0, 0.0]]), 0.3)
    fence = Shape("fence", "wall", np.array([[-3, -3], [3, -3], [3, 3], [-3, 3], [-3, -3]], dtype=float))
    surveyor = Surveyor(World("post", shapes=(post, fence)), load_robot_file("pioneer").body.outline_m)
    straight, around = (surveyor.course(np.random.default_rng(3), 4, wanted) for wanted in (False, True))
    assert straight is not None and around is not None
    for course, passes_post in ((straight, False), (around, True)):
        points = np.array([course.start[:2], *course.goals])
        for a, b in pairwise(points):
            along = (b - a) / np.linalg.norm(b - a)
            foot = a + np.clip(-a @ along, 0.0, np.linalg.norm(b - a)) * along
            gap_m = np.linalg.norm(foot) - 0.3
            assert gap_m < 0.26 + 0.2 if passes_post else gap_m > 0.19 + 0.14
    too_narrow = Surveyor(World("closet", shapes=(Shape("closet", "wall", fence.points * 0.1),)), load_robot_file("atrv2").body.outline_m)
    assert too_narrow.course(np.random.default_rng(3), 1, False) is None


def trace_of(seed: int) -> str:
    """The trace of the first seconds of a drawn patrol; at module level for other processes."""
    place, world = random_worlds(SEED, 1)[2]
    robot = load_robot_file("pioneer")
    course = Surveyor(world, robot.body.outline_m).course(np.random.default_rng(seed), 2, False)
    assert course is not None
    return drive(place, world, robot, course, seed, max_time_s=15.0).runner.result.trace_sha256


def test_one_seed_gives_one_trace_in_every_process_whatever_its_hash_seed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONHASHSEED", "77")
    with multiprocessing.get_context("spawn").Pool(2) as pool:  # both cores busy
        traces = pool.map(trace_of, [3, 3, 4], chunksize=1)
    assert traces[0] == traces[1] == trace_of(3) != traces[2]
