"""Stories of Investigate: objects of all shapes, wherever they stand; on the circle the laser looks at them as far as the wrist goes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.blackboard.codes import MotionStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, WorldState
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.scenario import Play, Run

MISSION = """<root BTCPP_format="4"><BehaviorTree ID="main"><Parallel success_count="1">
  <Investigate radius_m="{radius_m}"/> <Watcher/> </Parallel></BehaviorTree></root>"""
FIELD = """<world name="field" seed="{seed}"><wall id="w">-8,-10 20,-10 20,10 -8,10 -8,-10</wall>{shape}
  <robot platform="{platform}" x="3" y="0" theta_deg="{theta_deg}"/></world>"""
Moment = tuple[tuple[float, float, float], float, int]  # true pose, wrist's pan, element[3]


class Watcher(Leaf):
    """Writes down each tick what the robot really does."""

    INPUT_PORTS = OUTPUT_PORTS = NO_PORTS
    seen: ClassVar[list[Moment]] = []

    def update(self) -> Status:
        robot = self.robot
        assert robot is not None
        truth, wrist, motion = (robot.newest(name) for name in ("world/state", "wrist/state", "motion/status"))
        if isinstance(truth, WorldState) and isinstance(motion, FVectorState):
            self.seen.append((truth.pose_map_robot, wrist.position[0] if isinstance(wrist, ActuatorState) else 0.0, motion.element[3]))
        return Status.RUNNING


def box(x: float, y: float, length_m: float, width_m: float, deg: float) -> str:
    """A box around a point, turned."""
    c, s = math.cos(math.radians(deg)), math.sin(math.radians(deg))
    corners = [(a * length_m / 2, b * width_m / 2) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return f'<polygon id="o">{" ".join(f"{x + c * a - s * b:.3f},{y + s * a + c * b:.3f}" for a, b in corners)}</polygon>'


@pytest.fixture
def circling(scenario: Play, tmp_path: Path) -> Any:
    """Investigates one shape; gives the run and what was seen while it circled."""

    def play(shape: str, radius_m: float, platform: str, theta_deg: float = 0.0, seed: int = 4) -> tuple[Run, list[Moment]]:
        Watcher.seen.clear()
        (tmp_path / "mission.xml").write_text(MISSION.format(radius_m=radius_m), encoding="utf-8")
        (tmp_path / "world.xml").write_text(FIELD.format(shape=shape, platform=platform, theta_deg=theta_deg, seed=seed), encoding="utf-8")
        run = scenario(str(tmp_path / "world.xml"), mission=str(tmp_path / "mission.xml"), nodes=[Watcher])
        return run, [moment for moment in Watcher.seen if moment[2] == MotionStatus.CIRCLING_OBJECT]

    return play


@pytest.mark.parametrize(
    ("shape", "middle", "radius_m", "platform", "theta_deg"),
    [
        (box(11.0, 5.0, 1.0, 2.0, 80.0), (11.0, 5.0), 2.3, "atrv2", 0.0),
        (box(9.0, -3.0, 3.0, 0.4, 40.0), (9.0, -3.0), 2.8, "atrv2", 60.0),
        ('<circle id="o" x="-3" y="0.5" r="0.4"/>', (-3.0, 0.5), 1.8, "atrv2", 0.0),  # behind it
        (box(8.0, 2.0, 0.3, 0.3, 10.0), (8.0, 2.0), 1.2, "pioneer", 180.0),
    ],
    ids=["a box, not straight ahead", "a bench", "behind the robot", "behind a robot without a wrist"],
)
def test_a_full_circle_around_it_with_the_laser_on_it(
    circling: Any, shape: str, middle: tuple[float, float], radius_m: float, platform: str, theta_deg: float
) -> None:
    run, moments = circling(shape, radius_m, platform, theta_deg)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    poses, pans = np.array([pose for pose, _, _ in moments]), np.array([pan for _, pan, _ in moments])
    assert np.abs(np.hypot(poses[:, 0] - middle[0], poses[:, 1] - middle[1]) - radius_m).max() < 0.2
    around = np.unwrap(np.arctan2(poses[:, 1] - middle[1], poses[:, 0] - middle[0]))
    assert abs(around[-1] - around[0]) > 0.95 * math.tau
    devices = load_robot_file(platform).devices
    limit_rad = math.radians(devices.wrist.pan_limit_deg) if devices.wrist is not None else 0.0
    laser = poses[:, :2] + devices.laser.x_m * np.column_stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])))
    bearing = np.arctan2(middle[1] - laser[:, 1], middle[0] - laser[:, 0]) - poses[:, 2]
    bearing = np.remainder(bearing + math.pi, math.tau) - math.pi
    off = np.abs(np.remainder(bearing - pans + math.pi, math.tau) - math.pi)
    assert off.max() < math.radians(130.0 if devices.wrist is None else 75.0), "turning back to the circle it looks away for a moment"
    driving = np.append(np.hypot(*np.diff(poses[:, :2], axis=0).T) > 0.02, False)
    assert np.median((off - np.maximum(0.0, np.abs(bearing) - limit_rad))[driving]) < math.radians(4.0), "as far as the wrist goes"
    faced = np.unique(np.round((around - around[0])[off < math.radians(4.0)] / (math.tau / 8)))
    assert len(faced) >= 8, "eight times a turn it looks straight at it"


def test_who_is_carried_off_on_the_circle_stands_and_is_lost(scenario: Play, tmp_path: Path) -> None:
    drum = '<circle id="drum" x="6" y="1" r="0.5"/>'
    script = '<script><at t="55"><place id="robot" x="-5" y="-6" theta_deg="70"/></at></script></world>'
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    world.write_text(FIELD.format(seed=1, shape=drum, platform="atrv2", theta_deg=0).replace("</world>", script), encoding="utf-8")
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="main"><Investigate radius_m="2.0"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=120.0)
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "lost", 0), run.text
    assert "CircleObject" in run.text and 55.0 < run.sim_time_s < 65.0
    assert math.dist(run.final_pose[:2], (-5.0, -6.0)) < 0.6


def test_the_nearest_object_whose_circle_is_open_is_taken(scenario: Play, tmp_path: Path) -> None:
    beside_a_wall, open_one = '<circle id="barrel" x="5" y="8.6" r="0.4"/>', '<circle id="drum" x="13" y="0" r="0.4"/>'
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    world.write_text(FIELD.format(seed=1, shape=beside_a_wall + open_one, platform="atrv2", theta_deg=0), encoding="utf-8")
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="main"><Investigate radius_m="2.0"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=300.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert math.dist(run.final_pose[:2], (13.0, 0.0)) < 2.3


def test_an_object_whose_circle_is_not_open_is_named_with_what_is_missing(scenario: Play, tmp_path: Path) -> None:
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    shape = '<circle id="barrel" x="7" y="7.6" r="0.4"/>'
    world.write_text(FIELD.format(seed=1, shape=shape, platform="atrv2", theta_deg=0), encoding="utf-8")
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="main"><Investigate radius_m="2.0"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=120.0)
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "no-object", 0), run.text
    assert "m at 6.9;7." in run.text and "on its circle of 2.0 m" in run.text and "m of room are missing at" in run.text, run.text
