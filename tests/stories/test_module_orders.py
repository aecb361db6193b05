"""A mission starts and stops modules."""

from __future__ import annotations

from pathlib import Path

import pytest

from pluto_bt.scenario import Play, Run

WORLD = '<world name="room"><wall id="room">-3,-5 12,-5 12,5 -3,5 -3,-5</wall><robot x="0" y="0"/></world>'
MISSION = '<root BTCPP_format="4"><BehaviorTree ID="M">{}</BehaviorTree></root>'


def played(scenario: Play, folder: Path, tree: str) -> Run:
    (folder / "world.xml").write_text(WORLD, encoding="utf-8")
    (folder / "mission.xml").write_text(MISSION.format(tree), encoding="utf-8")
    return scenario(folder / "world.xml", mission=folder / "mission.xml", platform="atrv2")


def test_a_link_that_a_mission_stops_holds_the_robot_till_it_starts_it_again(scenario: Play, tmp_path: Path) -> None:
    go = '<GoTo goal="{};0" timeout_s="30" reason="{{why}}"/>'
    tree = f"""<Sequence>
      {go.format(1)} <StopModule module="avoid"/>
      <Inverter>{go.format(2)}</Inverter> <Script code="first := why"/>
      <StartModule module="avoid"/> {go.format(2)}
    </Sequence>"""
    run = played(scenario, tmp_path, tree)
    assert (run.result, run.reason, run.collisions) == ("SUCCESS", "", 0)
    assert run.blackboard["first"] == "chain-stopped"
    assert run.at(run.sim_time_s).distance_to(2.0, 0.0) < 0.3


def test_what_a_module_needs_is_started_with_it(scenario: Play, tmp_path: Path) -> None:
    tree = """<Sequence><StopModule module="avoid"/><StopModule module="drive"/><StartModule module="motion"/><StartModule module="avoid"/>
      <GoTo goal="1;0" timeout_s="30"/></Sequence>"""
    assert played(scenario, tmp_path, tree).result == "SUCCESS"


@pytest.mark.parametrize(
    ("node", "words"),
    [('<StartModule module="avoyd"/>', 'no module "avoyd"; did you mean "avoid"?'), ('<StopModule module="executive"/>', "runs this mission")],
)
def test_an_order_that_cannot_be_given_says_why(scenario: Play, tmp_path: Path, node: str, words: str) -> None:
    """The names are known from the first second of the run."""
    run = played(scenario, tmp_path, f'<Sequence><Sleep msec="1500"/>{node}</Sequence>')
    assert (run.result, run.reason) == ("FAILURE", "bad-command")
    assert words in run.text
