"""Wrist, words and conditions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pluto_bt.behaviours.topic_compare import compare, field_of
from pluto_bt.blackboard.messages import ActuatorState, BatteryState, BumperState, FVectorState, Pose
from pluto_bt.maps.world import Area, World

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])


def test_point_wrist_waits_until_it_points(stage: Any) -> None:
    mission = stage.load('<PointWrist pan_deg="40" tilt_deg="-10" reason="{why}"/>')
    assert stage.tick(mission) == "RUNNING"
    assert stage.robot.pointed == [pytest.approx((math.radians(40), math.radians(-10), math.radians(30), math.radians(60)))]
    for share, status in ((0.5, "RUNNING"), (1.0, "SUCCESS")):
        at = (share * math.radians(40), share * math.radians(-10))
        stage.robot.values["wrist/state"] = ActuatorState(stage.clock.now_s(), 0, at)
        assert stage.tick(mission) == status
    assert stage.robot.commands == []  # the wheels are not touched


@pytest.mark.parametrize(("pan", "seconds", "reason"), [("80", 0.2, "bad-command"), ("20", 16.0, "timeout")])
def test_point_wrist_fails(stage: Any, pan: str, seconds: float, reason: str) -> None:
    mission = stage.load(f'<PointWrist pan_deg="{pan}" reason="{{why}}"/>')
    statuses = {stage.tick(mission) for _ in range(round(seconds * 10))}
    assert "FAILURE" in statuses
    assert mission.blackboard["why"] == reason


def test_a_platform_without_wrist(make_car: Any) -> None:
    stage, _ = make_car(0, (0.0, 0.0, 0.0))
    mission = stage.load('<PointWrist reason="{why}"/>')
    assert stage.tick(mission) == "FAILURE" and mission.blackboard["why"] == "no-device"


def test_say(stage: Any) -> None:
    assert stage.tick(stage.load('<Say text="mind the step"/>')) == "SUCCESS"
    assert stage.robot.said == ["mind the step"]


def test_set_pose_waits_until_it_is_believed(stage: Any) -> None:
    mission = stage.load('<SetPose pose="1;2;90" reason="{why}"/>')
    assert stage.tick(mission) == "RUNNING"
    assert stage.robot.posed.pose == pytest.approx((1.0, 2.0, 0.0, math.pi / 2, 0.0, 0.0)) and stage.robot.posed.setter == -1
    stage.robot.values["Localization/Post_Pose"] = stage.robot.posed
    assert stage.tick(mission) == "SUCCESS" and stage.robot.commands == []


def test_set_pose_is_refused_while_a_module_keeps_the_pose_and_gives_up(stage: Any) -> None:
    stage.robot.keeps_pose = True
    mission = stage.load('<SetPose pose="1;2;90" reason="{why}"/>')
    assert stage.tick(mission) == "FAILURE" and mission.blackboard["why"] == "bad-command"
    stage.robot.keeps_pose = False
    assert "FAILURE" in {stage.tick(mission) for _ in range(15)} and mission.blackboard["why"] == "timeout"


@pytest.mark.parametrize(("x", "status"), [(1.29, "SUCCESS"), (1.31, "FAILURE")])
def test_is_at(stage: Any, x: float, status: str) -> None:
    stage.robot.is_at(x, 2.0)
    assert stage.tick(stage.load('<IsAt goal="1;2"/>'), after_s=0.0) == status


CONDITIONS = [
    ("<IsStuck/>", "motion/status", lambda t: FVectorState(t, element=(0, 2, 0, 0)), "SUCCESS"),
    ("<IsStuck/>", "motion/status", lambda t: FVectorState(t, element=(0, -1, 0, 0)), "FAILURE"),
    ("<BumperPressed/>", "ATRV2/Bumper", lambda t: BumperState(t, False, True), "SUCCESS"),
    ('<BumperPressed which="front"/>', "ATRV2/Bumper", lambda t: BumperState(t, False, True), "FAILURE"),
    ('<BumperPressed which="back"/>', "ATRV2/Bumper", lambda t: BumperState(t, False, True), "SUCCESS"),
    ('<BatteryAbove voltage_v="24"/>', "ATRV2/Battery", lambda t: BatteryState(t, 24.5), "SUCCESS"),
    ('<BatteryAbove voltage_v="24"/>', "ATRV2/Battery", lambda t: BatteryState(t, 24.0), "FAILURE"),
    ('<PoseQualityAbove quality="0.5"/>', "Localization/Pose", lambda t: Pose(t, covariance=(0.9, 0, 0, 0, 0.1, 0, 0, 0, 0)), "SUCCESS"),
    ('<PoseQualityAbove quality="0.5"/>', "Localization/Pose", lambda t: Pose(t, covariance=(0.6, 0.6, 0, 0.6, 0.6, 0, 0, 0, 0)), "FAILURE"),
    ('<InsideArea area="dock"/>', "Localization/Pose", lambda t: Pose(t, (1.0, 1.0, 0, 0, 0, 0)), "SUCCESS"),
    ('<InsideArea area="dock"/>', "Localization/Pose", lambda t: Pose(t, (3.0, 1.0, 0, 0, 0, 0)), "FAILURE"),
    ('<InsideArea area="duck"/>', "Localization/Pose", lambda t: Pose(t, (1.0, 1.0, 0, 0, 0, 0)), "FAILURE"),
    ('<TopicCompare topic="ATRV2/Battery" field="voltage_v" is="&gt;=" value="24"/>', "ATRV2/Battery", lambda t: BatteryState(t, 24.0), "SUCCESS"),
    ('<TopicCompare topic="ATRV2/Bumper" field="front" value="true"/>', "ATRV2/Bumper", lambda t: BumperState(t, True), "SUCCESS"),
    ('<TopicCompare topic="ATRV2/Battery" field="wattage" value="24"/>', "ATRV2/Battery", lambda t: BatteryState(t, 24.0), "FAILURE"),
    ('<TopicCompare topic="ATRV2/Buttery" field="x" value="24"/>', "ATRV2/Battery", lambda t: BatteryState(t, 24.0), "FAILURE"),
]


@pytest.mark.parametrize(("xml", "topic", "message", "status"), CONDITIONS)
def test_conditions(stage: Any, xml: str, topic: str, message: Any, status: str) -> None:
    stage.robot.map = World("w", areas=(Area("dock", "named", SQUARE),))
    mission = stage.load(xml)
    stage.robot.values[topic] = message(0.0)
    assert stage.tick(mission, after_s=0.0) == status
    assert stage.tick(mission, after_s=60.0) == "FAILURE"  # too old to trust
    del stage.robot.values[topic]
    assert stage.tick(mission) == "FAILURE"  # nobody has written


def test_wait_for_runs_until_it_is_so(stage: Any) -> None:
    mission = stage.load('<WaitFor topic="ATRV2/Bumper" field="back" value="true" timeout_s="3" reason="{why}"/>')
    stage.robot.values["ATRV2/Bumper"] = BumperState(0.0)
    assert [stage.tick(mission) for _ in range(3)] == ["RUNNING"] * 3
    stage.robot.values["ATRV2/Bumper"] = BumperState(stage.clock.now_s(), back=True)
    assert stage.tick(mission) == "SUCCESS"
    stage.robot.values["ATRV2/Bumper"] = BumperState(stage.clock.now_s())
    assert [stage.tick(mission) for _ in range(31)][-1] == "FAILURE"
    assert mission.blackboard["why"] == "timeout"


@pytest.mark.parametrize(
    ("found", "sign", "text", "is_so"),
    [
        (2, "==", "2.0", True), (2.5, "<", "10", True), ("10", "<", "9", True), (True, "==", "true", True), (False, "==", "0", True),
        (1.0, "==", "one", False), (1.0, "!=", "one", True), ("stuck", "==", "stuck", True), ("", "!=", "stuck", True),
    ],
)  # fmt: skip
def test_comparing(found: Any, sign: str, text: str, is_so: bool) -> None:
    assert compare(found, sign, text) is is_so


def test_fields_are_those_of_the_message_and_nothing_of_python() -> None:
    state = ActuatorState(1.0, 3, (4.0, 5.0))
    assert field_of(state, "position.1") == 5.0 and field_of(state, "flags") == 3
    for bad in ("position.7", "position.x", "__class__", "flags.0", ""):
        with pytest.raises((AttributeError, IndexError, ValueError, TypeError)):
            field_of(state, bad)


@pytest.mark.parametrize("leaf", ['<GoTo name="out" goal="{place}" reason="{why}"/>', '<MakeTurn name="out" angle_deg="{place}" reason="{why}"/>'])
def test_a_leaf_whose_entry_nothing_wrote_on_this_way_fails_with_node_port_and_cure(stage: Any, leaf: str) -> None:
    mission = stage.load(f"<Sequence><AlwaysSuccess _onFailure=\"place:='1;2'\"/>{leaf}</Sequence>")
    assert stage.tick(mission) == "FAILURE" and mission.blackboard["why"] == "no-input"
    port = "goal" if "goal" in leaf else "angle_deg"
    why = "entry 'place' has no value; write it on every way that leads here, or once at the beginning"
    told = f'no-input: port "{port}" of "out" has no value: {why}'
    assert [node.feedback_message for node in mission.root.iterate() if node.name == "out"] == [told]
    assert stage.robot.commands in ([], [0])  # nothing moves
    mission.blackboard["place"] = "1;2" if port == "goal" else "90"
    assert stage.tick(mission) == "RUNNING", "it works once the entry is there"
