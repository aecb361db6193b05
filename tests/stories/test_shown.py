"""What a run shows of itself to people who look on: the path, the rectangle, the words of the nodes, the web console."""

from __future__ import annotations

from pathlib import Path

import pytest

from pluto_bt.blackboard.messages import Message, PathState, RectangleState, TreeState
from pluto_bt.record.box import open_box
from pluto_bt.scenario import Play
from pluto_bt.source import Faults

MISSION = """<root BTCPP_format="4"><BehaviorTree ID="main"><Sequence>
  <SetRectangle rectangle="3;10" home="2;3.5;0"/> <NavigateTo name="go" goal="6;3.5"/> <SetRectangle rectangle="0;0"/>
</Sequence></BehaviorTree></root>"""


def shown(path: Path, topic: str) -> list[Message]:
    """Every value of a topic in the black box of a run."""
    box = open_box(path, str(path), Faults())
    assert box is not None
    return [sample.value for sample in box.samples([topic])[topic]]


def test_the_path_and_the_rectangle_are_shown_while_they_are_in_force(scenario: Play, tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(MISSION, encoding="utf-8")
    run = scenario("yard.xml", mission=str(tmp_path / "m.xml"), record=tmp_path / "a.mcap")
    assert run.result == "SUCCESS", run.text
    first, *_, last = shown(tmp_path / "a.mcap", "map/path")
    assert isinstance(first, PathState) and isinstance(last, PathState)
    assert first.points_m[:2] == pytest.approx((2.0, 3.5), abs=0.3) and first.points_m[-2:] == pytest.approx((6.0, 3.5), abs=0.1)
    assert last.points_m == (), "nobody follows it any more"
    set_one, removed = shown(tmp_path / "a.mcap", "motion/rectangle")
    assert isinstance(set_one, RectangleState) and isinstance(removed, RectangleState)
    assert (set_one.base_m, set_one.height_m, set_one.home) == (3.0, 10.0, (2.0, 3.5, 0.0)) and removed.base_m == 0.0


def test_a_run_in_lockstep_has_a_console_without_a_gateway_for_programs(scenario: Play, tmp_path: Path) -> None:
    run = scenario("yard.xml", mission="patrol.xml", ports={"goals": "4,3.5"}, web="127.0.0.1:0", record=tmp_path / "a.mcap")
    codes = [event.code for event in run.events]
    assert run.result == "SUCCESS" and "web-console" in codes and "gateway" not in codes
    trees = [tree for tree in shown(tmp_path / "a.mcap", "tree") if isinstance(tree, TreeState)]
    words = {node.feedback for tree in trees for node in tree.nodes if node.name == "go" and "m to go" in node.feedback}
    assert len(words) >= 2, "what a leaf says is shown while its status stays the same"
