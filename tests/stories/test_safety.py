"""What stops the robot, and how fast: every row of docs/safety.md is played, and the obstacles that it must not touch."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import Runner, make_runner
from tests.safety_cases import CAUSES, DRIVING, ROBOT, SPEED_MPS, T_S, Cause, braking_s, fault

MAX_TIME_S = 14.0
STILL_MPS = 0.01
FIELD = """<world name="field" seed="1">
  <wall id="fence">-5,-10 60,-10 60,10 -5,10 -5,-10</wall>
  <polygon id="kerb" height="0.15" absent="true">0,-9 0.5,-9 0.5,9 0,9</polygon>
  <polygon id="table" height="0.5" absent="true">0,-9 0.5,-9 0.5,9 0,9</polygon>
  <polygon id="house" absent="true">0,-9 0.5,-9 0.5,9 0,9</polygon>
  <robot platform="{platform}" x="0" y="0" theta_deg="0"/>
  <script>{script}</script>
</world>"""
MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main">{tree}</BehaviorTree></root>'


class SaysItOnce(Leaf, tag="SaysItOnce"):
    """A bad leaf: commands a velocity once and then only waits."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS

    def initialise(self) -> None:
        assert self.robot is not None
        self.robot.command(30, velocity=(SPEED_MPS, 0.0))

    def update(self) -> Status:
        return Status.RUNNING


class Drive:
    """One drive over the field, with the speed at every step of the simulator."""

    def __init__(self, folder: Path, script: str = "", tree: str = DRIVING, platform: str = "atrv2", stop_at_s: float = math.inf,
                 max_time_s: float = MAX_TIME_S) -> None:  # fmt: skip
        (folder / "world.xml").write_text(FIELD.format(script=script, platform=platform), encoding="utf-8")
        (folder / "mission.xml").write_text(MISSION.format(tree=tree), encoding="utf-8")
        inputs = read_inputs(Request(str(folder / "mission.xml"), world=str(folder / "world.xml")))
        self.runner: Runner = make_runner(inputs, max_time_s=max_time_s, nodes=[SaysItOnce])
        self.speeds: list[tuple[float, float]] = []
        self._stop_at_s = stop_at_s
        self.runner.system.board.on_change("world/state", self._note)
        self.result = self.runner.run()

    def _note(self) -> None:
        simulator = self.runner.system.simulator
        self.speeds.append((simulator.time_s, abs(simulator.velocity[0])))
        if simulator.time_s >= self._stop_at_s:
            self._stop_at_s = math.inf
            self.runner.system.stop_robot("operator")

    def speed_at(self, t_s: float) -> float:
        """m/s."""
        return next(speed for t, speed in self.speeds if t >= t_s - 1e-6)

    def rest_after_s(self, from_s: float) -> float:
        """From `from_s` until it moved for the last time."""
        return max(t for t, speed in self.speeds if speed > STILL_MPS) - from_s


@pytest.mark.parametrize("cause", CAUSES, ids=[cause.name for cause in CAUSES])
def test_the_robot_stands_in_time(cause: Cause, tmp_path: Path) -> None:
    drive = Drive(tmp_path, cause.script, cause.tree, stop_at_s=T_S if cause.stop else math.inf)
    if cause.from_s:
        assert drive.speed_at(cause.from_s) == pytest.approx(SPEED_MPS, abs=0.02), "it drives when the cause sets in"
    took_s = drive.rest_after_s(cause.from_s)
    assert took_s <= cause.limit_s, "in the time that the parameters promise"
    assert took_s == pytest.approx(cause.measured_s, abs=0.16), "and in the time that docs/safety.md shows"
    assert f"{drive.result.result} {drive.result.reason}" == cause.result
    assert drive.result.collisions == 0


@pytest.mark.parametrize("module", ["drive", "avoid", "motion", "local", "executive"])
def test_each_critical_module_that_raises_stops_the_robot_at_once(module: str, tmp_path: Path) -> None:
    drive = Drive(tmp_path, fault(f"module:{module}", "raise"))
    assert drive.rest_after_s(T_S) <= braking_s(ROBOT)
    assert (drive.result.result, drive.result.reason, drive.result.exit_code) == ("STOPPED", "module-error", 3)


@pytest.mark.parametrize("module", ["drive", "executive"])
def test_after_a_module_that_raises_for_a_moment_the_robot_stands_and_then_goes_on(module: str, tmp_path: Path) -> None:
    drive = Drive(tmp_path, f'<at t="{T_S:g}"><fault device="module:{module}" kind="raise" for="0.3"/></at>')
    assert drive.speed_at(T_S + braking_s(ROBOT)) <= STILL_MPS, "once it stood"
    assert max(speed for t, speed in drive.speeds if t > T_S + 3.0) == pytest.approx(SPEED_MPS, abs=0.02)


@pytest.mark.parametrize(("thing", "avoid"), [("house", "both"), ("house", "laser"), ("table", "sonar"), ("table", "both")])
def test_what_drops_into_the_way_is_not_touched(thing: str, avoid: str, tmp_path: Path) -> None:
    script = f'<at t="{T_S:g}"><place id="{thing}" x="7" y="0"/></at>'  # its face is 2.3 m before the front
    drive = Drive(tmp_path, script, DRIVING.replace("/>", f' avoid="{avoid}"/>'))
    assert drive.result.collisions == drive.result.hit_by == 0
    assert 0.0 < drive.runner.system.simulator.min_clearance_m < 1.0, "it came near"


@pytest.mark.parametrize("kind", ["velocity", "goto"])
def test_what_no_sensor_sees_is_felt_by_the_bumper_and_the_robot_stands(kind: str, tmp_path: Path) -> None:
    tree = DRIVING if kind == "goto" else '<DriveVelocity speed_mps="0.9" max_speed_mps="0.9"/>'
    drive = Drive(tmp_path, f'<at t="{T_S:g}"><place id="kerb" x="6.5" y="0"/></at>', tree)
    assert len(drive.runner.system.simulator.collisions) == 1, "contact is not avoided, nothing could see it"
    contact_s = drive.runner.system.simulator.collisions[0].t_s
    assert drive.rest_after_s(contact_s) <= 0.1
    assert drive.result.reason == "bumper"


def test_a_car_without_range_sensors_stops_where_its_map_ends(tmp_path: Path) -> None:
    world = Path(tmp_path / "hall.xml")
    world.write_text("""<world name="hall" seed="1"><area id="floor" kind="map">0,0 4,0 4,8 0,8</area>
      <marker id="1" x="2" y="1" theta_deg="90"/><marker id="2" x="2" y="3" theta_deg="90"/>
      <robot platform="car" x="2" y="1" theta_deg="90"/></world>""", encoding="utf-8")  # fmt: skip
    mission = tmp_path / "mission.xml"
    mission.write_text(MISSION.format(tree='<CarGoTo goal="2;9" reason="{why}"/>'), encoding="utf-8")
    runner = make_runner(read_inputs(Request(str(mission), world=str(world))), max_time_s=60.0)
    result: Any = runner.run()
    assert (result.result, result.reason, result.distance_m) == ("FAILURE", "outside-map", 0.0)
