"""Every kind of mission is stopped in its middle, and goes on: by an operator's stop, an emergency stop, a pause.

What holds it is latched and has one word everywhere; letting go of an emergency stop moves nothing; resume lets the mission end as if nothing had
been.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.blackboard.messages import ActuatorState, Event, MissionState
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.runner import make_runner
from tests.trees.clinging import Clings

HALL = """<world name="hall" seed="1"><wall id="fence">-6,-4 6,-4 6,4 -6,4 -6,-4</wall> <circle id="post" x="0.5" y="0.2" r="0.15"/>
  <circle id="drum" x="2.5" y="-1.2" r="0.4"/> <area id="floor" kind="map">-6,-4 6,-4 6,4 -6,4</area>
  <marker id="1" x="-4" y="0" theta_deg="0"/> <marker id="2" x="-1" y="-2" theta_deg="0"/> <marker id="3" x="2" y="-2.5" theta_deg="0"/>
  <robot platform="{platform}" x="{x}" y="0" theta_deg="0"/></world>"""
MISSION = '<root BTCPP_format="4"><BehaviorTree ID="main">{body}</BehaviorTree></root>'


@dataclass(frozen=True)
class Kind:
    """One kind of mission, and how its end is known."""

    body: str
    ended_well: Callable[[Any], bool]
    platform: str = "atrv2"
    stop_s: float = 5.0
    x_m: float = -4.5


def near(x: float, y: float, within_m: float = 0.5) -> Callable[[Any], bool]:
    return lambda result: math.dist(result.final_pose[:2], (x, y)) < within_m


KINDS = {
    "GoTo": Kind('<GoTo goal="4;0.5"/>', near(4.0, 0.5)),
    "MoveTo": Kind('<MoveTo goal="4.5;2.5"/>', near(4.5, 2.5), "pioneer", stop_s=8.0),
    "Explore": Kind('<Explore rectangle="2;6"/>', near(-4.5, 0.0, 0.8), "pioneer", stop_s=8.0),
    "Investigate": Kind('<Investigate radius_m="1.2"/>', lambda result: result.distance_m > 6.0, "pioneer", stop_s=14.0, x_m=-1.5),
    "CarGoTo": Kind('<CarGoTo goal="2.5;-2"/>', near(2.5, -2.0, 1.1), "car", stop_s=5.0),
    "DriveVelocity": Kind('<DriveVelocity speed_mps="0.3" distance_m="3"/>', near(-1.5, 0.0)),
    "HoldHeading": Kind('<HoldHeading heading_deg="10" speed_mps="0.3" duration_s="9"/>', lambda result: 2.0 < result.distance_m < 3.0),
    "MakeTurn": Kind('<MakeTurn angle_deg="170"/>', lambda result: abs(math.degrees(result.final_pose[2]) + 170.0) < 15.0, stop_s=1.5),
}


class Stopped:
    """A run that is stopped at `stop_s`, let go of 2 s later, and resumed 4 s later."""

    def __init__(self, kind: Kind, folder: Path, stop: Callable[[GatewayPort], None], let_go: Callable[[GatewayPort], None]) -> None:
        (folder / "world.xml").write_text(HALL.format(platform=kind.platform, x=kind.x_m), encoding="utf-8")
        (folder / "mission.xml").write_text(MISSION.format(body=kind.body), encoding="utf-8")
        self.runner = make_runner(read_inputs(Request(str(folder / "mission.xml"), world=str(folder / "world.xml"))), max_time_s=400.0)
        self.system = self.runner.system
        self._port = GatewayPort(self.system.context)
        at = kind.stop_s
        self._plan: list[tuple[float, Callable[[GatewayPort], None]]] = [
            (at, stop),
            (at + 3.0, self._note),
            (at + 3.5, let_go),
            (at + 5.5, self._note),
            (at + 6.0, lambda port: port.mission("resume", "", "", "test")),
        ]
        self.noted: list[tuple[str, str, str, tuple[float, ...]]] = []  # mission's state and reason, filter's reason, velocities
        self.told: list[tuple[float, tuple[float, float]]] = []
        self.system.board.on_change("world/state", self._act)
        self.system.board.on_change("ATRV2/Drive/Command", self._hear)
        self.result = self.runner.run()

    def _act(self) -> None:
        while self._plan and self.system.simulator.time_s >= self._plan[0][0]:
            self._plan.pop(0)[1](self._port)

    def _hear(self) -> None:
        sample = self.system.board.newest("ATRV2/Drive/Command")
        if sample is not None and isinstance(sample.value, ActuatorState):
            self.told.append((self.system.clock.now_s(), sample.value.velocity))

    def _note(self, port: GatewayPort) -> None:
        mission, verdict = self.system.board.newest("mission/state"), self.system.board.newest("filter/status")
        assert mission is not None and isinstance(mission.value, MissionState) and verdict is not None
        self.noted.append((mission.value.state, mission.value.reason, verdict.value.reason, self.system.simulator.velocity))  # type: ignore[attr-defined]

    def commanded_in(self, from_s: float, to_s: float) -> list[tuple[float, float]]:
        """Every velocity that was told to the base meanwhile."""
        return [velocity for t, velocity in self.told if from_s <= t < to_s]


WAYS: dict[str, tuple[Callable[[GatewayPort], None], Callable[[GatewayPort], None], str, str]] = {
    # how it is stopped, what is done two seconds before it is resumed, reason of the mission, word of the stop filter
    "operator stop": (lambda port: port.stop("test"), lambda port: None, "operator-stop", "operator-stop"),
    "emergency stop": (lambda port: port.estop("test", "a child"), lambda port: port.release_estop("test"), "estop", "estop"),
    "pause": (lambda port: port.mission("pause", "", "", "test"), lambda port: None, "operator-stop", ""),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", KINDS)
def test_a_mission_that_is_stopped_stands_says_why_and_goes_on(name: str, way: str, tmp_path: Path) -> None:
    kind = KINDS[name]
    stop, let_go, reason, word = WAYS[way]
    run = Stopped(kind, tmp_path, stop, let_go)
    at = kind.stop_s
    assert any(velocity != (0.0, 0.0) for velocity in run.commanded_in(at - 1.0, at)) or run.told[-1][0] > at, "it was at work"
    assert all(velocity == (0.0, 0.0) for velocity in run.commanded_in(at + 0.1, at + 6.0)), "nothing moves before somebody resumes"
    for state, why, verdict, speed in run.noted:
        assert (state, why) == ("paused", reason)
        assert verdict in (word, "operator-stop", ""), "an emergency stop that was let go leaves the operator's stop"
        assert speed == pytest.approx((0.0, 0.0), abs=1e-3)
    assert run.noted[0][2] == word
    assert (run.result.result, run.result.reason, run.result.collisions) == ("SUCCESS", "", 0), run.result.text
    assert kind.ended_well(run.result), run.result.final_pose


def test_a_stop_without_resume_ends_with_the_run_and_the_word_stays(tmp_path: Path) -> None:
    kind = Kind('<Timeout msec="9000"><GoTo goal="4;0.5"/></Timeout>', near(4.0, 0.5))
    run = Stopped(kind, tmp_path, lambda port: port.stop("test"), lambda port: port.mission("abort", "", "", "test"))
    assert (run.result.result, run.result.reason) == ("STOPPED", "stopped")
    assert run.result.exit_code == 1


def test_a_run_whose_time_is_over_ends_as_such_also_if_a_leaf_raises_while_it_lets_go(tmp_path: Path) -> None:
    """The robot drives meanwhile, and must come to rest."""
    path = tmp_path / "m.xml"
    body = '<Parallel success_count="2"><DriveVelocity speed_mps="0.4"/><Clings/></Parallel>'
    path.write_text(MISSION.format(body=body), encoding="utf-8")
    (tmp_path / "hall.xml").write_text(HALL.format(platform="atrv2", x=-4.5), encoding="utf-8")
    events: list[Event] = []
    runner = make_runner(
        read_inputs(Request(str(path), world=str(tmp_path / "hall.xml")), nodes=[Clings]), nodes=[Clings], max_time_s=3.0, on_event=events.append
    )
    result = runner.run()
    assert (result.result, result.reason) == ("STOPPED", "max-time")
    assert [event.code for event in events if event.level == "error"] == ["max-time", "leaf-error"]
    assert result.distance_m > 0.5 and runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3)
