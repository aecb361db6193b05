"""Wheels that slip for a while, a gyro that jumps, a robot that is carried: it knows where it is, finds its way on, or says that it does not know.

Nowhere may it believe for long to be elsewhere while all is said to be well.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pluto_bt.bench.faults import play_pair
from pluto_bt.blackboard.messages import FVectorState, Pose
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import Runner, make_runner

COURT = """<wall id="rim">-1,-8 18,-8 18,8 -1,8 -1,-8</wall> <circle id="well" x="8" y="0.5" r="0.8"/> <wall id="u">10,-7 14,-7 14,-4 10,-4</wall>
  <circle id="p1" x="13" y="4" r="0.12"/> <circle id="p2" x="13" y="5.5" r="0.12"/>
  <polygon id="bench" height="0.45">4,-5 6,-5 6,-4.5 4,-4.5</polygon>
  <robot name="pluto" platform="{platform}" x="1" y="0"/>"""
STREET = """<wall id="north">0,9.5 8,9.9 15,9.4 24,9.8 34,9.5</wall> <wall id="south">0,-0.4 9,0 18,-0.5 26,-0.1 34,-0.4</wall>
  <polygon id="car1">6,0.4 10.2,0.5 10.2,2.3 6,2.2</polygon> <polygon id="car2">17,0.5 21.2,0.4 21.2,2.2 17,2.3</polygon>
  <circle id="lamp1" x="7" y="8.4" r="0.08"/> <circle id="lamp2" x="14" y="8.4" r="0.08"/> <circle id="lamp3" x="21" y="8.4" r="0.08"/>
  <circle id="lamp4" x="28" y="8.4" r="0.08"/> <circle id="bin" x="14" y="5" r="0.3"/> <robot name="pluto" platform="{platform}" x="2" y="4"/>"""


def slip(at_s: float, share: float, for_s: float) -> str:
    return f'<at t="{at_s}"><fault device="base" kind="slip" value="{share}" for="{for_s}"/></at>'


MOVETO, GOTO = '<MoveTo goal="16;-6" timeout_s="200"/>', '<GoTo goal="30;6" timeout_s="200"/>'
PATH, WALL = '<FollowPath path="1,0;6,4;12,2;15,5;3,6" timeout_s="200"/>', '<WallFollow side="left" length_m="14" timeout_s="150"/>'
GYRO_JUMPS = '<at t="9"><fault device="imu" kind="jump" value="0.04" for="9"/></at>'
CARRIED = '<at t="8"><place id="pluto" x="31" y="3" theta_deg="160"/></at>'
PLAYS = {  # where, on what, the mission, what happens, what must have been said
    "moveto, the wrist sweeping, half of the way": (COURT, "atrv2", MOVETO, slip(10, 0.5, 10), "wheel-slip"),
    "moveto, hardly any way": (COURT, "atrv2", MOVETO, slip(14.3, 0.8, 6), "wheel-slip"),
    "moveto of a robot without a wrist": (COURT, "pioneer", MOVETO, slip(6, 0.6, 12), "wheel-slip"),
    "goto, twice, in a street": (STREET, "pioneer", GOTO, slip(5, 0.35, 5) + slip(18, 0.7, 8), "wheel-slip"),
    "goto, slip and a gyro that jumps": (STREET, "atrv2", GOTO, slip(6, 0.4, 15) + GYRO_JUMPS, "gyro-drift"),
    "along the corners of a path": (COURT, "pioneer", PATH, slip(8, 0.7, 9), "wheel-slip"),
    "along a wall": (COURT, "atrv2", WALL, slip(12, 0.6, 9), "wheel-slip"),
    "carried down a street": (STREET, "atrv2", GOTO, CARRIED, "lost"),
}
WELL_S, WRONG_M = 5.0, 0.5


class Watch:
    """Notes for how long the robot believed to be elsewhere and nothing was said of it."""

    def __init__(self, runner: Runner) -> None:
        self._system = runner.system
        self._since_s: float | None = None
        self.longest_s = 0.0
        runner.system.board.on_change("Localization/Pose", self._note)

    def _note(self) -> None:
        pose, check = (self._system.board.newest(topic) for topic in ("Localization/Pose", "Localization/Check"))
        if pose is None or not isinstance(pose.value, Pose):
            return
        now_s, (x, y, *_) = self._system.clock.now_s(), pose.value.pose
        off_m = math.dist((x, y), self._system.simulator.pose[:2])
        is_well = check is None or not isinstance(check.value, FVectorState) or check.value.element[0] == 0
        if off_m <= WRONG_M or not is_well:
            self._since_s = None
            return
        self._since_s = now_s if self._since_s is None else self._since_s
        self.longest_s = max(self.longest_s, now_s - self._since_s)


@pytest.mark.parametrize(("place", "platform", "body", "script", "word"), PLAYS.values(), ids=PLAYS)
def test_a_robot_that_slips_or_is_carried_finds_its_way_or_says_so(
    tmp_path: Path, place: str, platform: str, body: str, script: str, word: str
) -> None:
    world, mission = tmp_path / "world.xml", tmp_path / "mission.xml"
    world.write_text(f'<world name="w" seed="3">{place.format(platform=platform)}<script>{script}</script></world>', encoding="utf-8")
    mission.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="main">{body}</BehaviorTree></root>', encoding="utf-8")
    said: list[str] = []
    inputs = read_inputs(Request(mission=str(mission), world=str(world)))
    runner = make_runner(inputs, max_time_s=300.0, on_event=lambda event: said.append(event.code))
    watch = Watch(runner)
    result = runner.run()
    assert (result.result, result.reason) == (("FAILURE", "lost") if word == "lost" else ("SUCCESS", "")), result.text
    assert result.collisions == 0 and word in said
    assert watch.longest_s < WELL_S
    assert result.estimated_pose is not None
    assert word == "lost" or math.dist(result.estimated_pose[:2], result.final_pose[:2]) < 0.3


def test_slip_is_noticed_soon_though_the_wrist_looks_at_the_ground(tmp_path: Path) -> None:
    """A look at the ground shows hardly any walls, and lasts two seconds."""
    mission = tmp_path / "mission.xml"
    mission.write_text('<root BTCPP_format="4"><BehaviorTree ID="main"><MoveTo goal="16;-6"/></BehaviorTree></root>', encoding="utf-8")
    for at_s in (10.0, 11.5, 13.0):
        world = tmp_path / f"world{at_s}.xml"
        world.write_text(f'<world name="w">{COURT.format(platform="atrv2")}<script>{slip(at_s, 0.6, 30)}</script></world>', encoding="utf-8")
        told: list[float] = []
        runner = make_runner(
            read_inputs(Request(mission=str(mission), world=str(world))), max_time_s=at_s + 4.0,
            on_event=lambda event, told=told: told.append(event.stamp_s) if event.code == "wheel-slip" else None,
        )  # fmt: skip
        runner.run()
        assert told and 0.0 < told[0] - at_s < 3.0


def test_a_small_jump_of_the_gyro_on_slipping_wheels_in_a_street_drawn_at_random() -> None:
    pair = play_pair(10)
    assert pair.names == ("small gyro jump", "a little slip") and pair.complaints == []
    assert pair.play.result.result == "SUCCESS" and pair.play.error_m() < 0.3
