"""The wrist after a sweep: level and ahead, so that the laser goes on being the witness of the robot's motion."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.scenario import Play

ROOM = '<wall id="room">-3,-5 12,-5 12,5 -3,5 -3,-5</wall>'
MUD = f'<world name="mud">{ROOM}<terrain id="mud" slip="1.0">4,-2 6,-2 6,2 4,2</terrain><robot x="0" y="0"/></world>'
SWEEPS = {
    "once": '<Sequence><SweepWrist/>{go}</Sequence>',
    "with a steep look down": '<Sequence><SweepWrist tilt_deg="25" pan_deg="30"/>{go}</Sequence>',
    "cut off by its time": '<Sequence><ForceSuccess><Timeout msec="2500"><SweepWrist rounds="-1"/></Timeout></ForceSuccess>{go}</Sequence>',
    "looking around": "<Sequence><LookAround/>{go}</Sequence>",
    "the shipped tree": '<Sequence><SubTree ID="Visit" place="1;0" reason="{{first}}"/>{go}</Sequence>',
}  # fmt: skip
VISITS = Path(__file__).parents[2] / "missions" / "visits.xml"
GO = '<GoTo goal="9;0" timeout_s="100" reason="{why}"/>'


@pytest.fixture
def files(tmp_path: Path) -> Any:
    """Writes a world and a mission, gives their paths."""

    def write(world: str, tree: str) -> tuple[str, str]:
        paths = tmp_path / "world.xml", tmp_path / "mission.xml"
        include = f'<include path="{VISITS}"/>' if "Visit" in tree else ""
        mission = f'<root BTCPP_format="4" main_tree_to_execute="M">{include}<BehaviorTree ID="M">{tree}</BehaviorTree></root>'
        for path, text in zip(paths, (world, mission), strict=True):
            path.write_text(text, encoding="utf-8")
        return str(paths[0]), str(paths[1])

    return write


@pytest.mark.parametrize("sweep", SWEEPS.values(), ids=SWEEPS)
def test_after_a_sweep_the_laser_notices_wheels_that_spin_and_goto_does_not_boast(scenario: Play, files: Any, sweep: str) -> None:
    world, mission = files(MUD, sweep.format(go=GO))
    run = scenario(world, mission=mission, max_time_s=200.0)
    assert (run.result, run.reason) == ("FAILURE", "stuck"), run.text
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.5


LONG_ROOM = f'<world name="room">{ROOM}<robot x="-1" y="0"/></world>'
POSTURES = {  # what stands before and between two legs of 5 and 4 m → how often it is said
    "left tilted by the user": ('<PointWrist tilt_deg="10"/><GoTo goal="4;0"/><GoTo goal="8;0"/>', 1),
    "tilted, levelled, tilted again": (
        '<PointWrist tilt_deg="10"/><GoTo goal="2;0"/><PointWrist/><GoTo goal="5;0"/><PointWrist tilt_deg="-5"/><GoTo goal="8.5;0"/>', 2),
    "panned": ('<PointWrist pan_deg="30"/><GoTo goal="4;0"/><GoTo goal="8;0"/>', 0),
    "glances at the ground": ('<SweepWrist/><GoTo goal="4;0"/><SweepWrist/><GoTo goal="8;0"/>', 0),
}  # fmt: skip


@pytest.mark.parametrize(("legs", "times"), POSTURES.values(), ids=POSTURES)
def test_a_laser_that_stays_tilted_while_the_robot_drives_is_told_once_with_the_cure(scenario: Play, files: Any, legs: str, times: int) -> None:
    world, mission = files(LONG_ROOM, f"<Sequence>{legs}</Sequence>")
    run = scenario(world, mission=mission, max_time_s=200.0)
    said = run.said("laser-tilted")
    assert len(said) == times, run.text
    assert all("deg" in line and 'PointWrist with tilt_deg="0"' in line for line in said)


SWEEPING = '<Parallel success_count="1" failure_count="1"><GoTo goal="10;0"/><SweepWrist rounds="-1"/></Parallel>'
SILENT = {  # what the wrist does, and what stands in the way of the legs → how the run ends
    "at rest, on hard ground": ('<GoTo goal="9;0"/>', "", "SUCCESS", ""),
    "at rest, in the mud": ('<GoTo goal="9;0" timeout_s="100"/>', '<terrain id="mud" slip="1.0">4,-2 6,-2 6,2 4,2</terrain>', "FAILURE", "stuck"),
    "sweeping": (SWEEPING, "", "FAILURE", "wrist-stale"),
}


@pytest.mark.parametrize("kind", ["off", "frozen"])
@pytest.mark.parametrize(("tree", "parts", "result", "reason"), SILENT.values(), ids=SILENT)
def test_a_wrist_that_falls_silent_blinds_the_robot_only_where_it_may_have_moved_since(
    scenario: Play, files: Any, tree: str, parts: str, result: str, reason: str, kind: str
) -> None:
    script = f'<script><at t="3"><fault device="wrist" kind="{kind}"/></at></script>'
    world, mission = files(f'<world name="room">{ROOM}{parts}<robot x="-1" y="0"/>{script}</world>', tree)
    run = scenario(world, mission=mission, max_time_s=200.0)
    assert (run.result, run.reason, run.collisions) == (result, reason, 0), run.text
    assert math.dist(run.final_pose[:2], run.estimated_pose[:2]) < 0.5
    assert reason != "wrist-stale" or "the wrist is silent" in run.text
