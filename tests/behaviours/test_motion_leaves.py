"""Leaves that move the robot, tick by tick, with a robot that notes what it is told."""

from __future__ import annotations

import itertools
import math
from typing import Any

import pytest

from pluto_bt.behaviours.catalogue import ACTIONS, CONDITIONS, LEAVES
from pluto_bt.behaviours.motion_leaf import MotionLeaf
from pluto_bt.behaviours.reasons import REASONS, WAITING
from pluto_bt.behaviours.way_driven import WayDriven
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState, ImuState
from pluto_bt.trees import TickError, load_mission
from pluto_bt.trees.loader.registry import node_types

GOTO = '<GoTo goal="3;4" reason="{why}"/>'
ZERO = (0, (0.0, 0.0), (0.0, 0.0))


def said(*element: int, reason: str = "", text: str = "") -> FVectorState:
    return FVectorState(0.0, (0.0, 0.0), element, reason, text)


def told(robot: Any) -> list[tuple[int, tuple[float, float], tuple[float, float]]]:
    return [(c.flags, c.position, c.velocity) for c in robot.commands]


def run(stage: Any, mission: Any, seconds: float, alive: bool = True) -> str:
    """Tick at 10 Hz with fresh pose and odometry until it ends."""
    for _ in range(round(seconds * 10)):
        if alive:
            stage.robot.is_at(0.0, 0.0)
        status = stage.tick(mission)
        if status != "RUNNING":
            return str(status)
    return "RUNNING"


def test_goto_commands_once_watches_and_lets_go(stage: Any) -> None:
    # tick 1: RUNNING posts 32; 2: RUNNING; 3: reached: SUCCESS and zero velocity
    mission = stage.load('<GoTo goal="3;4" force="2" tolerance_m="0.5" max_speed_mps="5" reason="{why}"/>')
    stage.robot.is_at(0.0, 0.0)
    assert [stage.tick(mission), stage.tick(mission)] == ["RUNNING", "RUNNING"]
    assert mission.node_states()[-1].feedback == "5.00 m to go"
    stage.robot.says = said(0, 1, 0, 0)
    assert stage.tick(mission) == "SUCCESS"
    goto, zero = stage.robot.commands
    assert (goto.flags, goto.position, goto.acceleration[0], goto.force) == (32, (3.0, 4.0), 0.5, (2.0,))
    assert goto.velocity == (0.9, pytest.approx(math.radians(70)))  # the platform's limits stand above the port's
    assert (zero.flags, zero.velocity) == (0, (0.0, 0.0))
    assert mission.blackboard["why"] == ""


@pytest.mark.parametrize(("avoid", "flags"), [("none", 2), ("sonar", 12), ("laser", 22), ("both", 32)])
def test_avoid_is_the_tens_digit(stage: Any, avoid: str, flags: int) -> None:
    stage.tick(stage.load(f'<GoTo goal="1;0" avoid="{avoid}"/>'))
    assert stage.robot.commands[0].flags == flags


def test_sensors_that_the_platform_has_not_are_not_asked_for(make_car: Any) -> None:
    stage, _ = make_car(0, (0.0, 0.0, 0.0))
    stage.tick(stage.load('<GoTo goal="1;0"/>'))
    assert stage.robot.commands[0].flags == 2


def test_the_next_motion_leaf_takes_over_in_the_same_tick(stage: Any) -> None:
    mission = stage.load('<Sequence><GoTo goal="1;0"/><GoTo goal="2;0"/></Sequence>')
    stage.tick(mission)
    stage.robot.says = said(0, 1, 0, 0)
    stage.tick(mission)
    assert told(stage.robot)[1] == ZERO  # replaced in the inbox at once: the newest wins
    assert stage.robot.commands[-1].position == (2.0, 0.0)
    assert stage.robot.commands[1].stamp_s == stage.robot.commands[2].stamp_s


def test_a_halted_leaf_lets_go(stage: Any) -> None:
    mission = stage.load(GOTO)
    stage.tick(mission)
    mission.halt()
    assert told(stage.robot)[-1] == ZERO


def test_timeout(stage: Any) -> None:
    mission = stage.load('<GoTo goal="3;4" timeout_s="2" reason="{why}"/>')
    assert run(stage, mission, 5.0) == "FAILURE"
    assert mission.blackboard["why"] == "timeout"
    assert stage.clock.now_s() == pytest.approx(2.1)
    assert told(stage.robot)[-1] == ZERO


@pytest.mark.parametrize(
    ("status", "reason", "after_s"),
    [
        (said(0, 2, 0, 0, text="came no nearer"), "stuck", 0.2),
        (said(1, 2, 0, 0), "bumper", 0.2),
        (said(1, -1, 0, 0), "bumper", 4.2),
        (said(2, -1, 0, 0), "bumper", 4.2),
        (said(7, -1, 0, 0), "laser-fatal", 30.2),
        (said(0, -1, 0, 0, reason="laser-stale"), "laser-stale", 6.7),
        (said(0, -1, 0, 0, reason="no-pose"), "no-pose", 3.2),
        (said(0, -1, 0, 0, reason="odometry-stale"), "odometry-stale", 3.2),
        (said(0, 0, 0, 0, reason="bad-command", text="flags 99"), "bad-command", 0.2),
        (said(0, -10, 0, 0), "chain-stopped", 1.2),
        (said(0, -1, 0, -10), "chain-stopped", 1.2),
    ],
)
def test_goto_fails_with_a_word_of_the_list(stage: Any, status: FVectorState, reason: str, after_s: float) -> None:
    mission = stage.load(GOTO)
    stage.robot.says = status
    assert run(stage, mission, 60.0) == "FAILURE"
    assert mission.blackboard["why"] == reason
    assert reason in REASONS
    assert stage.clock.now_s() == pytest.approx(after_s, abs=0.11)


def test_a_bumper_that_is_released_in_time_gets_the_new_command_that_opens_its_latch(stage: Any) -> None:
    mission = stage.load(GOTO)
    stage.robot.says = said(1, -1, 0, 0)
    stage.robot.values["ATRV2/Bumper"] = BumperState(0.0, front=True)
    run(stage, mission, 0.5)
    pressed = len(stage.robot.commands)
    stage.robot.values["ATRV2/Bumper"] = BumperState(stage.clock.now_s())
    run(stage, mission, 0.1)
    assert len(stage.robot.commands) == pressed + 1
    assert stage.robot.commands[-1].position == (3.0, 4.0)
    stage.robot.says = said(0, -1, 0, 0)
    assert run(stage, mission, 2.0) == "RUNNING"


@pytest.mark.parametrize("waiting", [said(6, -1, 0, 0, reason="laser"), said(3, -1, 0, 0, reason="sonar"), said(7, -1, 0, 0)])
def test_an_obstacle_or_a_short_reboot_is_waited_for(stage: Any, waiting: FVectorState) -> None:
    mission = stage.load(GOTO)
    stage.robot.says = waiting
    assert run(stage, mission, 20.0) == "RUNNING"
    stage.robot.says = said(0, 1, 0, 0)
    assert stage.tick(mission) == "SUCCESS"


def test_a_command_that_motion_never_takes(stage: Any) -> None:
    stage.robot.accept = False
    mission = stage.load(GOTO)
    assert run(stage, mission, 5.0) == "FAILURE"
    assert mission.blackboard["why"] == "chain-stopped"


def test_a_command_that_is_refused(stage: Any) -> None:
    stage.robot.refuse = "wrong-state"
    mission = stage.load(GOTO)
    assert run(stage, mission, 5.0) == "FAILURE"
    assert mission.blackboard["why"] == "wrong-state"


@pytest.mark.parametrize(("status", "reason"), [(said(0, 0, 0, 0), "cancelled"), (said(0, 0, 0, 0, reason="stopped"), "stopped")])
def test_another_command_in_its_place(stage: Any, status: FVectorState, reason: str) -> None:
    mission = stage.load(GOTO)
    assert run(stage, mission, 0.3) == "RUNNING"
    stage.robot.commands.append(ActuatorState(9.0))
    stage.robot.values["motion/status"] = status
    assert stage.tick(mission) == "FAILURE"
    assert mission.blackboard["why"] == reason


def test_after_a_pause_the_command_is_given_again_and_the_pause_is_no_time(stage: Any) -> None:
    mission = stage.load('<GoTo goal="3;4" timeout_s="2" reason="{why}"/>')
    assert run(stage, mission, 1.0) == "RUNNING"
    stage.robot.stop()
    stage.clock.advance(60.0)
    stage.robot.resumes += 1
    assert run(stage, mission, 0.5) == "RUNNING"
    assert stage.robot.commands[-1].position == (3.0, 4.0)
    assert run(stage, mission, 3.0) == "FAILURE"
    assert stage.clock.now_s() == pytest.approx(62.1, abs=0.2)


@pytest.mark.parametrize("leaf", [kind for kind in (*ACTIONS, *CONDITIONS) if kind.__name__ not in ("Say", "Phase", "WouldRetryHelp")])
def test_without_a_robot_a_leaf_fails_with_not_connected(leaf: Any) -> None:
    given = {
        "goal": "1;1", "angle_deg": "90", "heading_deg": "0", "voltage_v": "24", "area": "a", "topic": "wrist/state", "field": "flags", "value": "1",
        "rectangle": "2;3", "radius_m": "2", "path": "1,2;3,4", "pose": "1;2;90", "module": "drive",
    }  # fmt: skip
    ports = " ".join(f'{name}="{given[name]}"' for name, port in leaf.input_ports().items() if port.required)
    reason = 'reason="{why}"' if "reason" in leaf.output_ports() else ""
    mission = load_mission(f'<root BTCPP_format="4"><BehaviorTree ID="T"><{leaf.__name__} {ports} {reason}/></BehaviorTree></root>')
    assert mission.tick_once() == "FAILURE"
    if reason:
        assert mission.blackboard["why"] == "not-connected"


def test_every_motion_leaf_has_the_common_ports_and_words_are_closed() -> None:
    for kind in ACTIONS:
        if issubclass(kind, MotionLeaf):
            assert {"avoid", "max_speed_mps", "timeout_s"} <= set(kind.input_ports())
            assert "reason" in kind.output_ports()
    assert set(WAITING) <= set(REASONS)
    assert all(reason.meaning and reason.cure for reason in REASONS.values())
    assert {kind.KIND for kind in CONDITIONS} == {"Condition"}  # type: ignore[attr-defined]
    assert len({kind.__name__ for kind in LEAVES}) == len(LEAVES)


def test_what_two_leaves_have_in_common_is_no_node() -> None:
    ours = [node for node in node_types().values() if getattr(node.make, "__module__", "").startswith("pluto_bt.behaviours.")]
    assert {node.make for node in ours} == set(LEAVES)


def test_drive_velocity_refreshes_itself_and_ends_by_time(stage: Any) -> None:
    mission = stage.load('<DriveVelocity speed_mps="-0.3" turn_rate_dps="10" duration_s="5"/>')
    assert run(stage, mission, 20.0) == "SUCCESS"
    assert stage.clock.now_s() == pytest.approx(5.1)
    *driving, zero = stage.robot.commands
    assert len(driving) == 5 and zero.velocity == (0.0, 0.0)
    assert {c.flags for c in driving} == {30} and {c.velocity for c in driving} == {(-0.3, math.radians(10))}
    assert all(b.stamp_s - a.stamp_s <= 1.01 for a, b in itertools.pairwise(driving))


def test_drive_velocity_ends_by_distance(stage: Any) -> None:
    mission = stage.load('<DriveVelocity speed_mps="0.5" distance_m="1"/>')
    for k in range(100):
        stage.robot.is_at(7.0 + 0.05 * k, 0.0)
        if stage.tick(mission) != "RUNNING":
            break
    assert k == pytest.approx(20, abs=1)


@pytest.mark.parametrize("leaf", ['DriveVelocity speed_mps="0.5"', 'HoldHeading heading_deg="0" speed_mps="0.5"'])
def test_a_jump_of_the_odometry_is_no_way(stage: Any, leaf: str) -> None:
    mission = stage.load(f'<{leaf} distance_m="1"/>')
    for k in range(100):
        stage.robot.is_at(0.05 * k, 0.0)
        stage.robot.values["ATRV2/Drive/Raw"] = ActuatorState(stage.clock.now_s(), 0, (0.05 * k + (2.0 if k > 5 else 0.0), 0.0), (0.5, 0.0))
        if stage.tick(mission) != "RUNNING":
            break
    assert k == pytest.approx(20, abs=1)


@pytest.mark.parametrize(("step_m", "turn_rad"), [(0.1, 0.0), (-0.1, 0.0), (0.1, 0.4), (-0.1, -0.4)])
def test_the_way_is_that_of_the_wheels_also_on_arcs(stage: Any, step_m: float, turn_rad: float) -> None:
    way, x, y, theta = WayDriven(stage.robot), 1.0, 2.0, 3.0
    for _ in range(20):
        stage.robot.is_at(x, y, math.remainder(theta, math.tau))
        way.step(stage.robot)
        chord_m = step_m * (math.sin(turn_rad / 2) / (turn_rad / 2) if turn_rad else 1.0)
        x, y, theta = x + chord_m * math.cos(theta + turn_rad / 2), y + chord_m * math.sin(theta + turn_rad / 2), theta + turn_rad
    assert way.way_m == pytest.approx(19 * step_m)


@pytest.mark.parametrize(("platform", "turn"), [("skid", 0.5), ("car", 0.5 * 0.4 / 0.8)])
def test_a_limited_car_keeps_its_curvature(stage: Any, make_car: Any, platform: str, turn: float) -> None:
    stage = stage if platform == "skid" else make_car(0, (0.0, 0.0, 0.0))[0]
    stage.tick(stage.load(f'<DriveVelocity speed_mps="0.8" turn_rate_dps="{math.degrees(0.5)}" max_speed_mps="0.4"/>'))
    assert stage.robot.commands[0].velocity == pytest.approx((0.4, turn))


def test_hold_heading_is_regulator_mode(stage: Any) -> None:
    mission = stage.load('<HoldHeading heading_deg="90" speed_mps="0.2" duration_s="2"/>')
    assert run(stage, mission, 5.0) == "SUCCESS"
    first = stage.robot.commands[0]
    assert (first.flags, first.position, first.velocity) == (31, (0.0, math.pi / 2), (0.2, 0.0))


def test_make_turn_in_place_turns_right_for_a_positive_angle(stage: Any) -> None:
    mission, theta = stage.load('<MakeTurn angle_deg="90" reason="{why}"/>'), 1.0
    for _ in range(200):
        stage.robot.is_at(0.0, 0.0, theta)
        status = stage.tick(mission)
        if status != "RUNNING":
            break
        v, w = stage.robot.commands[-1].velocity
        assert v == 0.0
        theta += w * 0.1
    assert status == "SUCCESS"
    assert 80.0 < math.degrees(1.0 - theta) < 85.0
    assert stage.robot.commands[-1].velocity == (0.0, 0.0)


def test_make_turn_gives_up_after_30_s(stage: Any) -> None:
    mission = stage.load('<MakeTurn angle_deg="90" reason="{why}"/>')
    assert run(stage, mission, 60.0) == "FAILURE"
    assert mission.blackboard["why"] == "timeout"
    assert stage.clock.now_s() == pytest.approx(30.1, abs=0.15)
    assert told(stage.robot)[-1] == ZERO


def test_a_turn_of_0_is_done_at_once_and_moves_nothing(stage: Any) -> None:
    assert stage.tick(stage.load('<MakeTurn angle_deg="0"/>')) == "SUCCESS"
    assert stage.robot.commands == []


def test_early_ticks_do_not_step_a_skill(stage: Any) -> None:
    mission = stage.load('<MakeTurn angle_deg="90"/>')
    stage.robot.is_at(0.0, 0.0)
    stage.tick(mission)
    for _ in range(4):
        stage.tick(mission, after_s=0.02)
    assert len(stage.robot.commands) == 1
    stage.tick(mission, after_s=0.02)
    assert len(stage.robot.commands) == 2


def test_the_car_waits_for_gyro_and_marker_and_then_gives_up(make_car: Any) -> None:
    stage, _car = make_car(0, (0.0, 0.0, math.pi / 2))
    mission = stage.load('<CarGoTo goal="0;9" reason="{why}"/>')
    stage.robot.is_at(0.0, 0.0)
    stage.tick(mission)
    assert "gyro" in mission.node_states()[-1].feedback
    stage.robot.values["dmu/state"] = ImuState(stage.clock.now_s() + 60.0, bias_known=True)  # good for a minute
    assert run(stage, mission, 4.9) == "RUNNING"
    assert "marker" in mission.node_states()[-1].feedback
    assert run(stage, mission, 1.0) == "FAILURE"
    assert mission.blackboard["why"] == "no-pose"
    assert stage.robot.commands == []


def test_a_stepped_leaf_stands_when_the_pose_is_lost(stage: Any) -> None:
    mission = stage.load('<MakeTurn angle_deg="90" reason="{why}"/>')
    assert run(stage, mission, 1.0) == "RUNNING"
    assert stage.robot.commands[-1].velocity != (0.0, 0.0)
    assert run(stage, mission, 1.0, alive=False) == "RUNNING"
    assert stage.robot.commands[-1].velocity == (0.0, 0.0)
    assert run(stage, mission, 5.0, alive=False) == "FAILURE"
    assert mission.blackboard["why"] == "no-pose"


def test_stop_succeeds_when_the_wheels_stand(stage: Any) -> None:
    mission = stage.load("<Stop/>")
    speeds = [0.4, 0.2, 0.1, 0.0, 0.0]
    statuses = []
    for speed in speeds:
        stage.clock.advance(0.05)
        stage.robot.is_at(0.0, 0.0, speed=speed)
        statuses.append(stage.tick(mission, after_s=0.05))
    assert statuses[:4] == ["RUNNING", "RUNNING", "RUNNING", "SUCCESS"]


def test_release_lets_go_without_a_further_command(stage: Any) -> None:
    mission = stage.load("<Release/>")
    stage.tick(mission)
    stage.robot.values["motion/status"] = said(-10, -10, 0, -10)
    assert stage.tick(mission) == "SUCCESS"
    assert [c.flags for c in stage.robot.commands] == [-1]


@pytest.mark.parametrize("x", [math.nan, math.inf])
def test_a_goal_that_is_no_place_is_refused_by_the_port(stage: Any, x: float) -> None:
    mission = stage.load('<GoTo goal="{p}"/>', blackboard={"p": (x, 1.0)})
    with pytest.raises(TickError, match=r"not a number|not finite"):
        stage.tick(mission)
    assert stage.robot.commands == []
