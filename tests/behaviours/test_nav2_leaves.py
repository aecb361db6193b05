"""Nav2's leaves, decorators and conditions that look at the robot, at goals and at paths."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import pytest

from pluto_bt.behaviours.conditions import Condition
from pluto_bt.behaviours.destinations import Destinations
from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.missing import MISSING
from pluto_bt.blackboard.messages import ActuatorState, BatteryState, FVectorState, LaserScan, read_only
from pluto_bt.maps.world import Goal, Shape, World
from pluto_bt.skills.sight import ScanView
from pluto_bt.trees import MissionError, check_mission, load_mission, plan_mission

ROOMS = World(
    "rooms",
    shapes=(
        Shape("outside", "wall", np.array([(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0), (0.0, 0.0)])),
        Shape("between", "wall", np.array([(6.0, 0.0), (6.0, 5.0)])),
    ),
    goals=(Goal("dock", 9.0, 2.0, math.pi / 2),),
    home=Goal("home", 3.0, 2.0),
)


def line(length_m: float, y_m: float = 2.0, x_m: float = 3.0) -> MapPath:
    return MapPath.along(np.column_stack((np.arange(x_m, x_m + length_m + 0.05, 0.1), np.full(round(length_m * 10) + 1, y_m))))


@pytest.fixture
def run(stage: Any) -> Callable[..., Any]:
    """Loads a mission for a robot in two rooms; `run(xml, key=value, …)`."""
    stage.robot.map = ROOMS
    stage.robot.is_at(3.0, 2.0)

    def load(xml: str, **entries: Any) -> Any:
        return stage.load(xml, blackboard=entries)

    return load


def sees_a_wall(stage: Any, x_m: float) -> None:
    """Scans of a wall across the way, right ahead of a robot that looks along x."""
    x, y, theta = (stage.robot.values["Localization/Pose"].pose[i] for i in (0, 1, 3))
    angles = np.linspace(-1.0, 1.0, 81)
    scan = LaserScan(stage.clock.now_s(), -1.0, 0.025, read_only(tuple((x_m - x) / np.cos(angles))), 81)
    stage.robot.views += [ScanView(scan, (x, y, theta))] * 3


# ---------------------------------------------------------------------- planning

PLANS = [
    # leaf and goal                                                           status, error number
    ('ComputePathToPose goal="9;2"', "SUCCESS", 0),
    ('ComputePathToPose goal="dock"', "SUCCESS", 0),
    ('ComputePathToPose goal="home" start="dock"', "SUCCESS", 0),
    ('ComputePathToPose goal="9;2" viapoints="3,6;9,6"', "SUCCESS", 0),
    ('ComputePathToPose goal="99;2"', "FAILURE", 208),  # outside of the walls
    ('ComputePathToPose goal="6;2"', "FAILURE", 206),
    ('ComputePathToPose goal="dok"', "FAILURE", 200),
    ("ComputePathToPose", "FAILURE", 200),
    ('ComputePathThroughPoses goals="3,6;dock"', "SUCCESS", 0),
    ('ComputePathThroughPoses goals="3,6;99,2"', "FAILURE", 308),
    ("ComputePathThroughPoses", "FAILURE", 309),
]


@pytest.mark.parametrize(("leaf", "status", "number"), PLANS)
def test_planning(run: Any, leaf: str, status: str, number: int) -> None:
    mission = run(f'<{leaf} path="{{path}}" error_code_id="{{e}}" error_msg="{{why}}"/>')
    assert mission.tick_once() == status
    assert mission.blackboard["e"] == number and bool(mission.blackboard["why"]) is (number != 0)
    assert ("path" in mission.blackboard) is (status == "SUCCESS")


def test_a_path_begins_at_the_robot_and_ends_as_the_goal_says(run: Any) -> None:
    mission = run('<ComputePathToPose goal="dock" path="{path}"/>')
    assert mission.tick_once() == "SUCCESS"
    path = mission.blackboard["path"]
    assert path.poses[0, :2] == pytest.approx((3.0, 2.0)) and path.poses[-1] == pytest.approx((9.0, 2.0, math.pi / 2))
    assert path.ends_turned and path.points[:, 1].max() > 5.4


def test_without_a_map_or_a_pose_there_is_no_path(stage: Any) -> None:
    mission = stage.load('<PlanPath goal="1;1" reason="{why}"/>')
    assert {stage.tick(mission) for _ in range(29)} == {"RUNNING"}
    assert {stage.tick(mission) for _ in range(3)} >= {"FAILURE"} and mission.blackboard["why"] == "no-pose"
    stage.robot.is_at(0.0, 0.0)
    assert mission.tick_once() == "FAILURE" and mission.blackboard["why"] == "no-path"
    assert "there is no map to plan on" in mission.root.feedback_message


# ---------------------------------------------------------------------- on paths and goals


def test_paths_are_cut_joined_and_taken_apart(run: Any) -> None:
    mission = run(
        """<Sequence><TruncatePath distance="1" input_path="{p}" output_path="{short}"/>
        <TruncatePathLocal distance_forward="1.05" distance_backward="0.55" input_path="{p}" output_path="{near}" pose="5;2"/>
        <ConcatenatePaths input_path1="{p}" input_path2="{q}" output_path="{both}"/>
        <GetPoseFromPath path="{p}" index="-1" pose="{end}"/><GetPoseFromPath path="{p}" pose="{begin}"/>
        <Inverter><GetPoseFromPath path="{p}" index="999" pose="{x}"/></Inverter><Inverter><ConcatenatePaths output_path="{x}"/></Inverter>
        </Sequence>""",
        p=line(4.0), q=line(1.0, x_m=7.1),
    )  # fmt: skip
    assert mission.tick_once() == "SUCCESS"
    board = mission.blackboard
    assert board["short"].length_m == pytest.approx(3.0, abs=0.11)
    assert board["near"].poses[[0, -1], 0] == pytest.approx((4.5, 6.0), abs=0.06)
    assert board["both"].length_m == pytest.approx(5.1)
    assert (board["begin"].x_m, board["end"].x_m) == pytest.approx((3.0, 7.0))


def test_goals_are_dropped_appended_and_chosen(run: Any) -> None:
    mission = run(
        """<Sequence><RemovePassedGoals input_goals="{goals}" output_goals="{left}"/>
        <AppendGoalPoseToGoals goal_pose="dock" input_goals="{left}" output_goals="{more}"/>
        <GetNextFewGoals num_goals="2" input_goals="{more}" output_goals="{few}"/>
        <RemoveInCollisionGoals input_goals="{more}" output_goals="{free}"/></Sequence>""",
        goals="3,2;3.3,2;5,2;6,2",
    )  # fmt: skip
    assert mission.tick_once() == "SUCCESS"
    texts = {key: mission.blackboard[key].to_text() for key in ("left", "more", "few", "free")}
    assert texts == {"left": "5.0,2.0;6.0,2.0", "more": "5.0,2.0;6.0,2.0;dock", "few": "5.0,2.0;6.0,2.0", "free": "5.0,2.0;dock"}


def test_the_last_goal_is_never_passed(run: Any) -> None:
    mission = run('<RemovePassedGoals input_goals="3,2" output_goals="{left}"/>')
    assert mission.tick_once() == "SUCCESS" and len(mission.blackboard["left"]) == 1


def test_a_path_is_valid_until_something_is_seen_on_it(stage: Any, run: Any) -> None:
    xml = '<ValidatePath path="{p}" collision_poses="{where}"/>'
    assert run(xml, p=line(2.5)).tick_once() == "SUCCESS"
    assert run(xml, p=line(5.0)).tick_once() == "FAILURE", "through the wall of the map"
    assert run(xml, p=MapPath.empty()).tick_once() == "FAILURE"
    sees_a_wall(stage, 5.0)
    stage.clock.advance(1.0)
    stage.robot.is_at(3.0, 2.0)
    mission = run(xml, p=line(2.5))
    assert mission.tick_once() == "FAILURE"
    assert isinstance(mission.blackboard["where"], Destinations) and abs(mission.blackboard["where"][0].x_m - 4.6) < 0.3


@pytest.mark.parametrize(
    ("leaf", "is_forgotten"),
    [
        ('<ClearEntireCostmap service_name="global_costmap/clear_entirely_global_costmap"/>', True),
        ('<ClearEntireCostmap service_name="local_costmap/clear_entirely_local_costmap"/>', False),  # 2 m away
        ('<ClearCostmapExceptRegion reset_distance="1"/>', True),
        ('<ClearCostmapAroundRobot reset_distance="1"/>', False),
        ('<ClearCostmapAroundPose pose="5;2" reset_distance="12"/>', True),
    ],
)
def test_what_was_seen_is_forgotten(stage: Any, run: Any, leaf: str, is_forgotten: bool) -> None:
    sees_a_wall(stage, 5.0)
    mission = run(f'<Sequence><Inverter><IsPathValid path="{{p}}"/></Inverter>{leaf}<IsPathValid path="{{p}}"/></Sequence>', p=line(2.5))
    assert mission.tick_once() == ("SUCCESS" if is_forgotten else "FAILURE")


# ---------------------------------------------------------------------- conditions


def test_goal_updated_begins_anew_when_it_is_reset(run: Any) -> None:
    mission = run("<PipelineSequence><ForceSuccess><GoalUpdated name='asked'/></ForceSuccess><Sleep msec='99999'/></PipelineSequence>", goal="1;1")
    for goal in ("1;1", "2;2"):
        mission.blackboard["goal"] = goal
        mission.tick_once()
        assert mission.statuses()["asked"] == "FAILURE", "its parent resets it in each tick"


def test_goal_updated_where_nobody_resets_it(run: Any) -> None:
    mission = run("<WhileDoElse><GoalUpdated/><AlwaysSuccess/><Sleep msec='99999'/></WhileDoElse>", goal="1;1")
    assert [mission.tick_once(), mission.tick_once()] == ["RUNNING", "RUNNING"]
    mission.blackboard["goal"] = "2;2"
    assert mission.tick_once() == "SUCCESS"


def test_time_expired_and_distance_traveled_where_nobody_resets_them(stage: Any, run: Any) -> None:
    for condition, far in (('<TimeExpired seconds="0.5"/>', False), ('<DistanceTraveled distance="0.4"/>', True)):
        mission = run(f"<WhileDoElse>{condition}<AlwaysSuccess/><Sleep msec='99999'/></WhileDoElse>")
        answers = []
        for tick in range(6):
            stage.robot.is_at(3.0 + (0.1 * tick if far else 0.0), 2.0)
            answers.append(mission.tick_once()[0])
            stage.clock.advance(0.01 if far else 0.1)
        assert "".join(answers) in ("RRRRRS", "RRRRSR")


def test_globally_updated_goal_keeps_its_own_memory(run: Any) -> None:
    mission = run("<GlobalUpdatedGoal/>", goal="1;1")
    assert [mission.tick_once(), mission.tick_once()] == ["SUCCESS", "FAILURE"]
    mission.blackboard["goals"] = "1,1;2,2"
    assert [mission.tick_once(), mission.tick_once()] == ["SUCCESS", "FAILURE"]


def test_path_expiring_timer(stage: Any, run: Any) -> None:
    mission = run('<PathExpiringTimer seconds="1" path="{p}"/>', p=line(1.0))
    answers = [stage.tick(mission, 0.5) for _ in range(4)]
    mission.blackboard["p"] = line(2.0)
    answers += [stage.tick(mission, 0.5) for _ in range(3)]
    assert "".join(answer[0] for answer in answers) == "FFSF" + "FFS"


CONDITIONS = [
    ('<GoalReached goal="3.2;2"/>', "SUCCESS"),
    ('<GoalReached goal="3.3;2"/>', "FAILURE"),
    ('<GoalReached goal="home"/>', "SUCCESS"),
    ('<ArePosesNear ref_pose="3;2" target_pose="home" tolerance="0.1"/>', "SUCCESS"),
    ('<ArePosesNear ref_pose="3;2" target_pose="dock"/>', "FAILURE"),
    ('<ArePosesNear ref_pose="3;2"/>', "FAILURE"),
    ('<IsGoalNearby path="{p}"/>', "FAILURE"),
    ('<IsGoalNearby path="{p}" proximity_threshold="5"/>', "SUCCESS"),
    ('<IsGoalNearby path="{none}"/>', "FAILURE"),
    ('<IsBatteryLow min_battery="0.5"/>', "SUCCESS"),
    ('<IsBatteryLow min_battery="0.2"/>', "FAILURE"),
    ('<IsBatteryLow min_battery="23.2" is_voltage="true"/>', "SUCCESS"),
    ("<InitialPoseReceived/>", "SUCCESS"),
    ('<InitialPoseReceived initial_pose_received="false"/>', "FAILURE"),
    ("<TransformAvailable/>", "SUCCESS"),
    ('<IsWithinPathTrackingBounds tracking_feedback="{t}"/>', "SUCCESS"),
    ('<IsWithinPathTrackingBounds tracking_feedback="{t}" max_error_left="0.2"/>', "FAILURE"),
    ('<IsWithinPathTrackingBounds tracking_feedback="{t}" max_error_heading="0.1"/>', "FAILURE"),
    ('<WouldAControllerRecoveryHelp error_code="105"/>', "SUCCESS"),
    ('<WouldAControllerRecoveryHelp error_code="103"/>', "FAILURE"),
    ('<WouldAControllerRecoveryHelp error_code="{unwritten}"/>', "FAILURE"),
    ('<WouldAPlannerRecoveryHelp error_code="208"/>', "SUCCESS"),
    ('<WouldAPlannerRecoveryHelp error_code="204"/>', "FAILURE"),
    ('<AreErrorCodesPresent error_code="7" error_codes_to_check="5;7"/>', "SUCCESS"),
    ('<AreErrorCodesPresent error_code="6" error_codes_to_check="5;7"/>', "FAILURE"),
    ('<CheckPoseOccupancy pose="9;2"/>', "SUCCESS"),
    ('<CheckPoseOccupancy pose="6.1;2"/>', "FAILURE"),
]


@pytest.mark.parametrize(("xml", "status"), CONDITIONS)
def test_conditions(stage: Any, run: Any, xml: str, status: str) -> None:
    stage.robot.values["ATRV2/Battery"] = BatteryState(0.0, 23.2)
    assert run(xml, p=line(2.0), t=[0.3, -0.2]).tick_once() == status


# ---------------------------------------------------------------------- decorators that look at the robot


def test_distance_controller(stage: Any, run: Any) -> None:
    paced = '<DistanceController distance="0.5"><Say text="now"/></DistanceController>'
    mission = run(f'<PipelineSequence>{paced}<Sleep msec="9999"/></PipelineSequence>')
    for x_m in (3.0, 3.4, 3.5, 3.6, 4.0, 3.6):
        stage.robot.is_at(x_m, 2.0)
        assert mission.tick_once() == "RUNNING"
    assert len(stage.robot.said) == 3
    stage.robot.values.clear()
    assert mission.tick_once() == "FAILURE", "no pose"


def test_speed_controller_asks_more_often_when_the_robot_is_fast_or_the_goal_new(stage: Any, run: Any) -> None:
    xml = '<PipelineSequence><SpeedController min_rate="0.5" max_rate="2"><Say text="now"/></SpeedController><Sleep msec="99999"/></PipelineSequence>'
    mission = run(xml, goal="1;1")
    told = []
    for speed_mps in (0.0, 0.5):
        for _ in range(60):
            stage.robot.is_at(3.0, 2.0, speed=speed_mps)
            stage.tick(mission)
        told.append(len(stage.robot.said))
        stage.robot.said.clear()
    assert told[0] in (3, 4, 5) and told[1] in (10, 11, 12)
    mission.blackboard["goal"] = "2;2"
    stage.tick(mission, 0.01)
    assert stage.robot.said == ["now"]


def test_goal_updated_controller(run: Any, stage: Any) -> None:
    xml = '<PipelineSequence><GoalUpdatedController><Say text="now"/></GoalUpdatedController><Sleep msec="99999"/></PipelineSequence>'
    mission = run(xml, goal="1;1")
    for goal in ("1;1", "1;1", "2;2", "2;2", "1;1"):
        mission.blackboard["goal"] = goal
        mission.tick_once()
    assert len(stage.robot.said) == 3


def test_goal_updater_takes_the_newer_goal(run: Any) -> None:
    xml = '<GoalUpdater input_goal="{goal}" output_goal="{out}"><AlwaysSuccess/></GoalUpdater>'
    mission = run(xml, goal="5;map;1;1;0;0;0;0;1")
    shown = []
    for update in (None, "4;map;2;2;0;0;0;0;1", "6;map;3;3;0;0;0;0;1", "4;4"):
        if update is not None:
            mission.blackboard["goal_update"] = update
        mission.tick_once()
        shown.append(mission.blackboard["out"].x_m)
    assert shown == [1.0, 1.0, 3.0, 4.0]


def test_path_longer_on_approach(run: Any) -> None:
    mission = run('<PathLongerOnApproach path="{p}"><AlwaysFailure/></PathLongerOnApproach>', p=line(2.0))
    assert mission.tick_once() == "SUCCESS", "the first path"
    around = MapPath.along(np.vstack([line(2.0, 6.0).points, line(2.0).points]))
    for path, status in ((line(1.0, x_m=4.0), "SUCCESS"), (around, "FAILURE"), (around, "SUCCESS"), (line(4.0, x_m=1.0), "SUCCESS")):
        mission.blackboard["p"] = path
        assert mission.tick_once() == status


def test_pause_and_resume(run: Any, stage: Any) -> None:
    says = "".join(f'<Sequence><Say text="{word}"/>{more}</Sequence>' for word, more in
                   (("work", '<Sleep msec="999999"/>'), ("paused", '<Sleep msec="999999"/>'), ("on pause", ""), ("on resume", "")))  # fmt: skip
    mission = run(f"<PauseResumeController>{says}</PauseResumeController>")
    for key in ("", "pause", "", "", "resume", "", ""):
        if key:
            mission.blackboard[key] = True
        assert mission.tick_once() == "RUNNING"
    assert stage.robot.said == ["work", "on pause", "paused", "on resume", "work"]
    stage.robot.said.clear()
    stage.robot.resumes += 1  # the operator's own pause is over
    for _ in range(4):
        mission.tick_once()
    assert stage.robot.said == ["on pause", "on resume", "work"]


# ---------------------------------------------------------------------- driving


def test_spin_turns_by_as_much_as_it_is_told_and_the_other_way_round(stage: Any, run: Any) -> None:
    for spin_rad in (1.57, -4.0):
        mission = run(f'<Spin spin_dist="{spin_rad}" error_code_id="{{e}}"/>')
        stage.robot.is_at(3.0, 2.0)
        theta, status = 0.0, "RUNNING"
        for _ in range(95):
            status = stage.tick(mission)
            if status != "RUNNING":
                break
            theta += 0.1 * stage.robot.commands[-1].velocity[1]
            stage.robot.is_at(3.0, 2.0, math.remainder(theta, math.tau))
        assert status == "SUCCESS" and theta == pytest.approx(spin_rad, abs=0.08)
        assert mission.blackboard["e"] == 0


@pytest.mark.parametrize(
    ("leaf", "speed_mps", "way_m", "number"),
    [
        ('BackUp backup_dist="0.3" backup_speed="0.1"', -0.1, 0.3, 0),
        ('DriveOnHeading dist_to_travel="0.4" speed="0.2"', 0.2, 0.4, 0),
        ('BackUp backup_dist="3" backup_speed="0.1"', -0.1, 1.0, 711),
        ('DriveOnHeading dist_to_travel="3" speed="0.2"', 0.2, 2.0, 721),
        ('DriveOnHeading dist_to_travel="1" speed="-0.2"', 0.0, 0.0, 724),
    ],
)
def test_driving_straight(stage: Any, run: Any, leaf: str, speed_mps: float, way_m: float, number: int) -> None:
    mission = run(f'<{leaf} error_code_id="{{e}}"/>')
    x_m, status = 3.0, "RUNNING"
    for _ in range(120):
        status = stage.tick(mission)
        if status != "RUNNING":
            break
        assert stage.robot.commands[-1].velocity == pytest.approx((speed_mps, 0.0))
        x_m += 0.1 * speed_mps
        stage.robot.is_at(x_m, 2.0)
    assert mission.blackboard["e"] == number and status == ("FAILURE" if number else "SUCCESS")
    assert abs(x_m - 3.0) == pytest.approx(way_m, abs=0.03)


def test_collision_checks_can_be_disabled_as_far_as_avoidance_goes(stage: Any, run: Any) -> None:
    for given, flags in (("", 30), ('disable_collision_checks="true"', 0)):
        run(f"<BackUp {given}/>").tick_once()
        assert stage.robot.commands[-1].flags == flags


def test_wait(stage: Any, run: Any) -> None:
    mission = run('<Wait wait_duration="0.5"/>')
    assert [stage.tick(mission, 0.25) for _ in range(3)] == ["RUNNING", "RUNNING", "SUCCESS"]


def test_check_stop_status(stage: Any, run: Any) -> None:
    mission = run('<CheckStopStatus duration_stopped="300"/>')
    answers = []
    for speed_mps in (0.2, 0.0, 0.0, 0.0, 0.0):
        stage.robot.is_at(3.0, 2.0, speed=speed_mps)
        answers.append(stage.tick(mission)[0])
    assert answers == ["R", "R", "R", "S", "R"] or answers == ["R", "R", "R", "R", "S"]


def test_follow_path_steers_along_the_path_and_tells_when_it_is_stuck(stage: Any, run: Any) -> None:
    mission = run('<FollowPath path="{p}" error_code_id="{e}" tracking_feedback="{t}" reason="{why}"/>', p=line(4.0, 6.0))
    stage.robot.is_at(3.0, 6.1)
    assert stage.tick(mission) == "RUNNING"
    assert stage.robot.commands[-1].position == pytest.approx((5.0, 6.0), abs=0.11)
    assert mission.blackboard["t"][0] == pytest.approx(0.1, abs=0.02)
    mission.blackboard["p"] = line(4.0, 7.0)
    stage.tick(mission)
    assert stage.robot.commands[-1].position[1] == 7.0, "the new path"
    stage.robot.says = FVectorState(0.0, (0.0, 0.0), (0, 2, 0, 0))
    stage.robot.is_at(3.0, 6.1)
    assert stage.tick(mission) == "FAILURE"
    assert (mission.blackboard["why"], mission.blackboard["e"]) == ("stuck", 105)


def test_a_pose_from_one_leaf_is_a_goal_for_another_whatever_form_it_wants(run: Any, stage: Any) -> None:
    for order in ('<GetCurrentPose current_pose="{p}"/><GoTo goal="{p}"/>', '<GoTo goal="{p}" _skipIf="true"/><GetCurrentPose current_pose="{p}"/>'):
        mission = run(f'<Sequence>{order}<IsAt goal="{{p}}"/><GoalReached goal="{{p}}"/></Sequence>')
        assert mission.tick_once() in ("RUNNING", "SUCCESS")
    assert stage.robot.commands[-1].position == (3.0, 2.0)


def test_selectors_listen_to_entries_of_the_main_tree(run: Any) -> None:
    mission = run('<PlannerSelector selected_planner="{p}" default_planner="Grid" topic_name="planner"/>')
    assert (mission.tick_once(), mission.blackboard["p"]) == ("SUCCESS", "Grid")
    mission.blackboard["planner"] = "Other"
    assert (mission.tick_once(), mission.blackboard["p"]) == ("SUCCESS", "Other")
    assert run('<PlannerSelector selected_planner="{p}"/>').tick_once() == "FAILURE"


def test_get_current_pose_and_cancel_control(stage: Any, run: Any) -> None:
    mission = run('<Sequence><GetCurrentPose current_pose="{here}"/><CancelControl/></Sequence>')
    assert mission.tick_once() == "SUCCESS"
    assert (mission.blackboard["here"].x_m, mission.blackboard["here"].frame) == (3.0, "map")
    assert stage.robot.commands[-1] == ActuatorState(stage.clock.now_s(), 0, acceleration=(0.0, 0.0), force=(1.0,))


def test_get_current_pose_says_that_the_robot_was_carried_off(stage: Any, run: Any) -> None:
    stage.robot.values["Localization/Check"] = FVectorState(0.0, (1.0, 0.0, 0.1), (2,), "lost", "the laser sees another place")
    mission = run('<GetCurrentPose current_pose="{here}"/>')
    assert mission.tick_once() == "FAILURE"
    assert (mission.root.reason, mission.root.feedback_message) == ("lost", "lost: the laser sees another place")


# ---------------------------------------------------------------------- what is not there yet


@pytest.mark.parametrize("name", sorted(MISSING))
def test_what_is_not_there_yet_is_refused_by_name_before_anything_runs(stage: Any, name: str) -> None:
    text = f'<root BTCPP_format="4"><BehaviorTree ID="T"><Sequence><{name}/></Sequence></BehaviorTree></root>'
    faults = [fault for fault in check_mission(text) if fault.code == "not-there-yet"]
    assert [(fault.line, fault.severity) for fault in faults] == [(1, "error")] and name in faults[0].message
    with pytest.raises(MissionError, match=f"<{name}> is not there yet"):
        stage.load(text)
    assert plan_mission(text).children, "it can be drawn all the same"


def test_a_leaf_that_forgets_its_part_is_refused_when_it_is_built(stage: Any) -> None:
    class Forgetful(Condition):
        INPUT_PORTS: ClassVar = {}
        OUTPUT_PORTS: ClassVar = {}

    text = '<root BTCPP_format="4"><BehaviorTree ID="T"><Forgetful/></BehaviorTree></root>'
    with pytest.raises(MissionError, match=r"<Forgetful> could not be built.*ask"):
        load_mission(text, nodes=[Forgetful])
