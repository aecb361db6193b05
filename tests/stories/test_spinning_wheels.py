"""Wheels that spin for ever: whatever the robot was to do, it notices that it comes nowhere, and ends with `stuck` by itself."""

from __future__ import annotations

from typing import Any

import pytest

from pluto_bt.scenario import Play

FIELD = """<world name="field" seed="3"><wall id="w">-12,-12 12,-12 12,12 -12,12 -12,-12</wall> <circle id="o" x="2" y="1" r="0.6"/>
  <robot platform="atrv2" x="-6" y="-2"/> <script><at t="{at}"><fault device="base" kind="slip"/></at></script></world>"""
ENDLESS = {  # no duration, no time limit; and when the wheels begin to spin
    "driving some way": ('<DriveVelocity speed_mps="0.3" distance_m="6"/>', 5.0),
    "holding a heading": ('<HoldHeading heading_deg="30" speed_mps="0.3" distance_m="6"/>', 8.0),
    "goto": ('<GoTo goal="9;9"/>', 9.0),
    "circling": ('<Investigate radius_m="2.0"/>', 60.0),
}


@pytest.mark.parametrize(("body", "at_s"), ENDLESS.values(), ids=ENDLESS)
def test_what_has_no_time_limit_ends_when_the_robot_comes_nowhere(scenario: Play, tmp_path: Any, body: str, at_s: float) -> None:
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    world.write_text(FIELD.format(at=at_s), encoding="utf-8")
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="main">{body}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=150.0)
    assert (run.result, run.reason, run.collisions) == ("FAILURE", "stuck", 0), run.text
    assert at_s < run.sim_time_s < at_s + 45.0


def test_a_drive_for_some_time_ends_by_its_time_wherever_it_came(scenario: Play, tmp_path: Any) -> None:
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    world.write_text(FIELD.format(at=2.0), encoding="utf-8")
    body = '<DriveVelocity speed_mps="0.3" duration_s="14"/>'
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="main">{body}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=60.0)
    assert run.result == "SUCCESS", run.text


def test_an_inertial_sensor_that_talks_nonsense_does_not_blind_the_laser_to_wheels_that_spin(scenario: Play, tmp_path: Any) -> None:
    """It says nonsense of the slope too; a laser that is thought to be tilted is no witness."""
    world, mission = tmp_path / "field.xml", tmp_path / "mission.xml"
    garbage = '<at t="7"><fault device="imu" kind="garbage"/></at><at t="8"><fault device="base" kind="slip" for="8"/></at></script>'
    world.write_text(FIELD.format(at=999).replace("</script>", garbage), encoding="utf-8")
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="main"><GoTo goal="7;8"/></BehaviorTree></root>', encoding="utf-8")
    run = scenario(str(world), mission=str(mission), max_time_s=120.0)
    assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
    assert run.said("gyro-refused") and run.said("wheel-slip")
    x, y, _ = run.final_pose
    assert (x - 7.0) ** 2 + (y - 8.0) ** 2 < 1.0
