"""Stories of patrols: in worlds of all three kinds, in lockstep and in threads, with faults on the way."""

from __future__ import annotations

import math
from typing import Any

import pytest
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts

from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import make_runner
from pluto_bt.scenario import Play, Run
from pluto_bt.source import InputError
from pluto_bt.system import System
from tests.shared_data import shared_file

SQUARE = """<world name="square" seed="1">
  <wall id="fence">-6,-6 6,-6 6,6 -6,6 -6,-6</wall>
  <circle id="post" x="2" y="0.1" r="0.15"/> <polygon id="crate" absent="true">3,-1 4,-1 4,1 3,1</polygon>
  <robot platform="pioneer" x="-3" y="0" theta_deg="0"/>
  {script}
</world>"""


@pytest.fixture
def square(tmp_path: Any) -> Any:
    """Writes the square world with a script into a file; gives its path."""

    def write(script: str = "") -> str:
        path = tmp_path / "square.xml"
        path.write_text(SQUARE.format(script=f"<script>{script}</script>" if script else ""), encoding="utf-8")
        return str(path)

    return write


def test_the_robot_patrols_the_yard_and_comes_home(scenario: Play) -> None:
    run = scenario("yard.xml", mission="patrol.xml", ports={"goals": "8,3;13.5,3;10.5,8;2,3.5"})
    assert (run.result, run.reason, run.exit_code) == ("SUCCESS", "", 0)
    assert run.collisions == 0
    assert math.dist(run.final_pose[:2], (2.0, 3.5)) < 0.3 + 0.02 * run.distance_m, "the goal is reached in truth, but for the drift"
    assert run.blackboard["reached"] == 4
    assert all(status in ("SUCCESS", "IDLE", "FAILURE") for status in run.leaves.values())


@pytest.mark.parametrize(
    ("world", "platform", "start", "goals"),
    [
        ("maps/nav2_tb3_sandbox.yaml", "pioneer", "-2,-0.5,0", [(-0.5, -0.5), (-0.6, 1.8), (-2.0, -0.5)]),
        ("maps/aria_office.map", "pioneer", "1,8,-90", [(1.0, 6.0), (2.0, 8.5)]),
        ("worlds/kth_yard.xml", "atrv2", "115,222,-90", [(115.0, 210.0), (120.0, 202.0)]),
    ],
)
def test_the_robot_patrols_in_maps_of_all_three_kinds(scenario: Play, world: str, platform: str, start: str, goals: Any) -> None:
    path = shared_file("data", world)
    run = scenario(str(path), mission="patrol.xml", platform=platform, start=start, ports={"goals": goals}, seed=5)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], goals[-1]) < 0.3 + 0.02 * run.distance_m


def test_one_seed_gives_one_trace_and_another_seed_another(scenario: Play, square: Any) -> None:
    hashes = [scenario(square(), mission="patrol.xml", ports={"goals": "0,2"}, seed=seed).trace_sha256 for seed in (7, 7, 8)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_the_same_scenario_in_lockstep_and_in_threads(scenario: Play, square: Any) -> None:
    runs = [scenario(square(), mission="patrol.xml", ports={"goals": "-1.5,0.5"}, realtime=realtime) for realtime in (False, True)]
    for run in runs:
        assert (run.result, run.collisions) == ("SUCCESS", 0), (run.reason, run.text)
        assert math.dist(run.final_pose[:2], (-1.5, 0.5)) < 0.5


def test_a_crate_that_drops_in_front_of_the_robot_is_not_touched(scenario: Play, square: Any) -> None:
    run = scenario(square('<at t="9"><place id="crate"/></at>'), mission="patrol.xml", ports={"goals": "5,0", "timeout_s": 40}, max_time_s=120)
    assert run.collisions == 0
    assert run.result in ("SUCCESS", "FAILURE") and (run.result == "SUCCESS" or run.reason in ("stuck", "timeout"))


def test_a_dead_laser_pauses_the_drive_and_the_mission_goes_on_after_the_reboot(scenario: Play, square: Any) -> None:
    run = scenario(square('<at t="4"><fault device="laser" kind="fatal"/></at>'), mission="patrol.xml", ports={"goals": "4,-2"})
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.at(8.0).pose[:2], run.at(20.0).pose[:2]) < 0.01, "it stands still while the laser reboots"
    assert run.sim_time_s > 24.0


class Raises(BehaviourWithPorts, tag="StoryRaises"):
    """A leaf with a bug."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        raise ZeroDivisionError("a bug in a leaf")


class Leaves(Raises, tag="StoryLeaves"):
    """A leaf that thinks it is a program of its own."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        raise SystemExit(7)


class GivesNothing(Raises, tag="StoryGivesNothing"):
    """A leaf that forgets to return."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        return None  # type: ignore[return-value]  # that is the bug


WHILE_DRIVING = """<root BTCPP_format="4"><BehaviorTree ID="main"><Parallel>
  <GoTo name="drive" goal="4;-2"/> <Delay delay_msec="3000"><{leaf} name="bad"/></Delay></Parallel></BehaviorTree></root>"""


def play(scenario: Play, tmp_path: Any, world: str, leaf: str, **more: Any) -> Run:
    path = tmp_path / "mission.xml"
    path.write_text(WHILE_DRIVING.format(leaf=leaf), encoding="utf-8")
    return scenario(world, mission=str(path), **more)


@pytest.mark.parametrize(
    ("leaf", "reason", "says"),
    [("StoryRaises", "leaf-error", "a bug in a leaf"), ("StoryLeaves", "leaf-error", "SystemExit: 7"), ("StoryGivesNothing", "leaf-error", "None")],
)
def test_a_bad_leaf_ends_the_run_with_the_robot_at_rest(scenario: Play, square: Any, tmp_path: Any, leaf: str, reason: str, says: str) -> None:
    run = play(scenario, tmp_path, square(), leaf, nodes=(Raises, Leaves, GivesNothing))
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", reason, 3)
    assert says in run.text and "bad" in run.text
    assert run.distance_m > 0.2, "it did drive"
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)


@pytest.mark.parametrize("kind", ["raise", "wrong", "hang"])
def test_a_leaf_that_the_script_lets_fail(scenario: Play, square: Any, tmp_path: Any, kind: str) -> None:
    run = play(scenario, tmp_path, square(f'<at t="2"><fault device="leaf:bad" kind="{kind}"/></at>'), "AlwaysSuccess")
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", "hung" if kind == "hang" else "leaf-error", 3)
    assert "bad" in run.text
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)


@pytest.mark.parametrize("module", ["drive", "avoid", "motion", "local", "base"])
def test_a_critical_module_that_keeps_raising_ends_the_run_at_rest(scenario: Play, square: Any, module: str) -> None:
    run = scenario(square(f'<at t="4"><fault device="module:{module}" kind="raise"/></at>'), mission="patrol.xml", ports={"goals": "4,-2"})
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", "module-error", 3)
    assert module in run.text
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)
    assert run.sim_time_s < 8.0


def test_a_module_that_raises_for_a_moment_pauses_the_drive_only(scenario: Play, square: Any) -> None:
    run = scenario(square('<at t="4"><fault device="module:drive" kind="raise" for="0.25"/></at>'), mission="patrol.xml", ports={"goals": "4,-2"})
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.said("module-restarted")


ONE_LEAF = '<root BTCPP_format="4"><BehaviorTree ID="main">{body}</BehaviorTree></root>'


@pytest.mark.parametrize("module", ["base", "local", "filter", "drive", "avoid", "motion", "executive"])
@pytest.mark.parametrize(("body", "at_s"), [('<GoTo goal="4;-2"/>', 4), ('<MoveTo goal="4;-2"/>', 9)], ids=["goto", "moveto"])
def test_a_mission_without_a_second_try_goes_on_too_when_the_module_that_raised_runs_again(
    scenario: Play, square: Any, tmp_path: Any, module: str, body: str, at_s: int
) -> None:
    mission = tmp_path / "one.xml"
    mission.write_text(ONE_LEAF.format(body=body), encoding="utf-8")
    run = scenario(square(f'<at t="{at_s}"><fault device="module:{module}" kind="raise" for="0.25"/></at>'), mission=str(mission), max_time_s=90.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.said("module-restarted") and run.said("resumed")
    assert math.dist(run.final_pose[:2], (4.0, -2.0)) < 0.5


@pytest.mark.parametrize("how", ["stop", "estop and release", "pause"])
def test_who_stops_a_mission_that_waits_for_a_module_has_stopped_it(square: Any, how: str) -> None:
    world = square('<at t="4"><fault device="module:drive" kind="raise" for="0.25"/></at>')
    inputs = read_inputs(Request("patrol.xml", world=world, port=["goals=4,-2"]))
    done: list[str] = []

    def person(system: System) -> None:
        if system.clock.now_s() < 4.6 or done:
            return
        mission = system.executive.core.mission
        assert mission is not None and (mission.state, mission.reason) == ("paused", "module-error")
        done.append(how)
        if how == "pause":
            system.executive.core.pause("operator-stop")
        else:
            system.operator_stop("anna")
            if how == "estop and release":
                system.latch.set("estop", "smoke")
                system.latch.release("estop")

    runner = make_runner(inputs, max_time_s=15.0, on_progress=person)
    result = runner.run()
    assert done and (result.result, result.reason) == ("STOPPED", "max-time")
    still = [point.pose for point in runner.system.track.points if point.t_s > 7.0]
    assert max(math.dist(pose[:2], still[0][:2]) for pose in still) < 0.01, "nobody has said that it may go on"


def test_a_lost_base_ends_the_run(scenario: Play, square: Any) -> None:
    run = scenario(square('<at t="4"><fault device="base" kind="off"/></at>'), mission="patrol.xml", ports={"goals": "4,-2"})
    assert (run.result, run.exit_code) == ("STOPPED", 3)
    assert run.reason == "base-lost"


def test_the_longest_time_ends_the_run_at_rest(scenario: Play, square: Any) -> None:
    run = scenario(square(), mission="patrol.xml", ports={"goals": "4,-2"}, max_time_s=5.0)
    assert (run.result, run.reason, run.exit_code) == ("STOPPED", "max-time", 1)
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)


def test_a_start_inside_a_wall_is_refused(scenario: Play, square: Any) -> None:
    with pytest.raises(InputError, match='would start inside "post"'):
        scenario(square(), mission="patrol.xml", ports={"goals": "4,-2"}, start="2,0,0")
