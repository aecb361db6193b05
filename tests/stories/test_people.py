"""People who walk past, from ahead, and round behind the robot, and yield to nobody: it may be hit, but it runs into nobody."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from pluto_bt.bench.courses import Course, Surveyor
from pluto_bt.bench.patrols import LEGS, PLATFORMS, Drive, drive, random_worlds
from pluto_bt.maps.world import Actor, Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.scenario import Play

FENCE = Shape("fence", "wall", np.array([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0), (-9.0, -9.0)]))


def among(platform: str, goal: tuple[float, float], speed_mps: float, walk: list[tuple[float, float]], max_time_s: float = 100.0) -> Drive:
    """From the middle of a field, looking east, to a goal, while one person walks."""
    person = Actor("person", 0.25, speed_mps, False, np.array(walk))
    course = Course((0.0, 0.0, 0.0), (goal,), math.hypot(*goal))
    return drive("field", World("field", shapes=(FENCE,), actors=(person,)), load_robot_file(platform), course, 1, max_time_s)


def touches(one: Drive) -> list[float]:
    """The robot's own speed at each collision."""
    return [contact["speed_mps"] for contact in one.runner.result.contacts if contact["kind"] == "collision"]


@pytest.mark.parametrize(("bearing_deg", "speed_mps"), [(-180, 1.0), (146, 1.3), (-180, 1.3), (-123, 0.8), (100, 0.6)])
def test_the_tail_does_not_swing_into_somebody_who_came_round_from_ahead(bearing_deg: int, speed_mps: float) -> None:
    """He walks past on the left or the right, is seen, and comes back to the tail, which no laser sees, while the robot turns round."""
    side, bearing = math.copysign(1.0, bearing_deg), math.radians(bearing_deg)
    behind = (1.8 * math.cos(bearing), 1.8 * abs(math.sin(bearing)) * side)
    one = among("atrv2", (-5.0, 0.8 * side), speed_mps, [(2.2, -1.2 * side), (0.0, -1.5 * side), behind, (0.0, 0.0), (6.0, -6.0)], 60.0)
    assert touches(one) == []


COMES_TO_THE_FLANK = [(120, 1.0, 1.8), (120, 1.4, 2.6), (150, 0.6, 2.6), (150, 1.4, 2.6), (180, 1.4, 3.4), (-120, 1.4, 1.8), (-150, 1.0, 2.6)]


@pytest.mark.parametrize(("bearing_deg", "speed_mps", "comes_s"), COMES_TO_THE_FLANK)
def test_who_comes_first_of_all_to_the_flank_of_a_robot_that_turns_round_is_heard_in_time(bearing_deg: int, speed_mps: float, comes_s: float) -> None:
    """Nobody was seen before, and no laser sees him come: the tail stops for what the ring hears where all was free a moment ago."""
    bearing, far_m = math.radians(bearing_deg), 0.9 + speed_mps * comes_s
    way = np.array([math.cos(bearing), math.sin(bearing)])
    walk = [(float(x), float(y)) for x, y in (far_m * way, -6.0 * way)]
    assert touches(among("atrv2", (-5.0, math.copysign(0.8, bearing_deg)), speed_mps, walk, comes_s + 1.5)) == []


@pytest.mark.parametrize(("bearing_deg", "speed_mps"), [(-55, 1.3), (-39, 1.0), (-39, 1.3), (8, 1.0), (39, 1.3), (55, 1.3)])
def test_the_front_array_hears_who_comes_from_ahead_in_time(bearing_deg: int, speed_mps: float) -> None:
    bearing = math.radians(bearing_deg)
    one = among("jbot", (6.0, 0.0), speed_mps, [(1.5 + 4.0 * math.cos(bearing), 4.0 * math.sin(bearing)), (1.5, 0.0), (-6.0, -6.0)], 60.0)
    assert touches(one) == []


@pytest.mark.parametrize("platform", ["atrv2", "pioneer"])
def test_the_laser_sees_who_comes_from_ahead_and_the_goal_is_reached_behind_him(platform: str) -> None:
    one = among(platform, (6.0, 0.0), 1.0, [(5.3, 1.3), (1.5, 0.0), (-6.0, -6.0)])
    assert touches(one) == []
    assert one.runner.result.result == "SUCCESS", one.runner.result.text


ON_HIS_HEEL = [(2.38, 0.0, 3.3, 1.1), (2.38, -0.8, 2.4, 0.8), (2.88, 0.4, 4.8, 1.1), (3.38, 0.0, 5.5, 1.1)]


@pytest.mark.parametrize(("x_m", "y_m", "comes_from_m", "speed_mps"), ON_HIS_HEEL)
def test_who_crosses_the_way_may_turn_on_his_heel_and_come(x_m: float, y_m: float, comes_from_m: float, speed_mps: float) -> None:
    """He is seen all the time, and turns towards the robot when it is at full speed a metre away. It brakes with 0.5 m/s² only."""
    one = among("pioneer", (6.0, 0.0), speed_mps, [(x_m, comes_from_m), (x_m, y_m), (x_m - 3.0, -0.2), (-6.0, -6.0)], 12.0)
    assert touches(one) == []


def test_when_everybody_is_gone_it_drives_as_ever() -> None:
    alone = among("atrv2", (5.0, 5.0), 1.0, [(8.0, -8.0), (8.0, -8.5)])
    passed = among("atrv2", (5.0, 5.0), 1.2, [(2.5, -2.0), (2.5, -8.5)])
    assert passed.runner.result.result == "SUCCESS"
    assert passed.runner.result.sim_time_s < alone.runner.result.sim_time_s + 25.0


DOOR = """<world name="door"><wall id="hall">-2,-3 14,-3 14,3 -2,3 -2,-3</wall>
<polygon id="right">{x0},-3 {x1},-3 {x1},-0.8 {x0},-0.8</polygon><polygon id="left">{x0},0.8 {x1},0.8 {x1},3 {x0},3</polygon>
<actor id="person" r="0.25" speed="{speed}" loop="true">{x},-0.5 {x},0.5</actor><robot x="0" y="0"/>
<script><at t="45"><remove id="person"/></at></script></world>"""
TO_THE_OTHER_SIDE = '<root BTCPP_format="4"><BehaviorTree ID="M"><MoveTo goal="12;0" timeout_s="200"/></BehaviorTree></root>'


WHERE_AND_HOW_FAST = [("atrv2", 4.2, 0.5), ("atrv2", 9.0, 0.7), ("pioneer", 4.2, 0.8), ("pioneer", 6.2, 0.5)]


@pytest.mark.parametrize(("platform", "away_m", "speed_mps"), WHERE_AND_HOW_FAST)
def test_who_paces_in_the_only_doorway_is_awaited_however_far_he_is(
    scenario: Play, tmp_path: Path, platform: str, away_m: float, speed_mps: float
) -> None:
    (tmp_path / "door.xml").write_text(DOOR.format(x=away_m, x0=away_m - 0.2, x1=away_m + 0.2, speed=speed_mps))
    (tmp_path / "through.xml").write_text(TO_THE_OTHER_SIDE)
    run = scenario(str(tmp_path / "door.xml"), mission=str(tmp_path / "through.xml"), platform=platform, seed=3)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0)
    assert run.sim_time_s > 45.0, "he left only then"


@pytest.mark.parametrize(("platform", "seed"), [("pioneer", 1507), ("atrv2", 2005)])
def test_while_somebody_is_in_view_the_robot_turns_as_if_another_were_behind_it(platform: str, seed: int) -> None:
    """Rooms drawn at random in which it had to turn round at once, and a second person came from where no sensor looks."""
    (place, world), robot = random_worlds(seed, 3)[0], load_robot_file(platform)
    surveyor = Surveyor(world, robot.body.outline_m)
    course = surveyor.course(np.random.default_rng((seed, 0, PLATFORMS.index(platform), False)), LEGS, around=False)
    assert course is not None
    assert touches(drive(place, world, robot, course, seed, 6.0)) == []
