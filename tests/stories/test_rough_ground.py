"""Stories of jBot in trouble: trapped with turning wheels, with stuck wheels, on a slope too steep; it frees itself or says why not."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pluto_bt.scenario import Play

WORLD = '<world name="rough" seed="1">{parts}<robot platform="jbot" x="0" y="0" theta_deg="0"/></world>'
TRUNK = '<terrain id="trunk" slip="1" slip_back="0.6">4,-3 5,-3 5,1.2 4,1.2</terrain>'
GOALS = "5,0;5,8"  # the first lies on the trunk; there it must turn


@pytest.fixture
def rough(tmp_path: Any) -> Any:
    """Writes a world with these parts into a file; gives its path."""

    def write(parts: str) -> str:
        path = tmp_path / "rough.xml"
        path.write_text(WORLD.format(parts=parts), encoding="utf-8")
        return str(path)

    return write


def test_a_robot_high_centred_on_a_trunk_gets_off_the_way_it_came(scenario: Play, rough: Any) -> None:
    run = scenario(rough(TRUNK), mission="rough.xml", ports={"goals": GOALS}, max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.blackboard["escapes"] == 1
    assert run.final_pose[1] == pytest.approx(8.0, abs=0.6)


def test_a_robot_trapped_for_good_tries_everything_and_says_that_it_is_stuck(scenario: Play, rough: Any) -> None:
    mud = '<terrain id="mud" slip="1">4,-3 5,-3 5,1.2 4,1.2</terrain>'
    run = scenario(rough(mud), mission="rough.xml", ports={"goals": GOALS, "attempts": 1}, max_time_s=200.0)
    assert (run.result, run.reason) == ("FAILURE", "stuck")
    proofs = [status for path, status in run.leaves.items() if ("free" in path and "?" in path) or "turn round" in path]
    assert sorted(proofs) == ["FAILURE"] * 6 + ["IDLE"], "turning round proves more than the small turn that would follow it"


def test_wheels_that_are_held_for_a_while_are_noticed_within_two_seconds_and_the_journey_goes_on(scenario: Play, rough: Any) -> None:
    held = '<script><at t="3"><fault device="base" kind="blocked" for="6"/></at></script>'
    run = scenario(rough(held), mission="rough.xml", ports={"goals": "6,0"}, max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.blackboard["escapes"] == 1
    assert run.sim_time_s < 45.0


def test_a_robot_on_a_slope_of_55_degrees_backs_down(scenario: Play, rough: Any) -> None:
    """It is warned only once it stands on the bank, still drives then, and tries anew from there: of the bank's 3 m it may come up less than one."""
    slope = '<terrain id="bank" pitch_deg="-39" roll_deg="39">4,-2 7,-2 7,2 4,2</terrain>'
    run = scenario(rough(slope), mission="rough.xml", ports={"goals": "8,0", "attempts": 2}, max_time_s=60.0)
    assert run.blackboard["escapes"] >= 1
    assert max(point.pose[0] for point in run.track) < 5.0, "it never went far up"
    assert math.isclose(run.final_pose[0], 3.6, abs_tol=1.2)


def test_with_yaw_enable_off_the_wheels_alone_give_the_heading(scenario: Play, rough: Any) -> None:
    goals = "6,0;6,6;0,6;0,0"
    errors = []
    for setting in ("true", "false"):
        run = scenario(rough(""), mission="rough.xml", ports={"goals": goals}, settings=(f"local.yaw_enable={setting}",), seed=3, max_time_s=120.0)
        assert run.result == "SUCCESS", run.text
        errors.append(math.dist(run.final_pose[:2], run.estimated_pose[:2]))
    assert errors[0] < 0.4 < errors[1]
