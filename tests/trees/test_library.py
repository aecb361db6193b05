"""The library's own trees: found by ID without an include; a mission's own tree of that name goes first."""

from __future__ import annotations

import pytest

from pluto_bt.trees import MissionError, check_mission, load_mission
from pluto_bt.trees.loader.library import FOLDER, library_trees

ESCAPE = '<root BTCPP_format="4"><BehaviorTree ID="Main">{body}</BehaviorTree>{more}</root>'


def paths(text: str) -> set[str]:
    return {node.path for node in load_mission(text).nodes()}


def test_there_is_an_escape() -> None:
    assert "escape" in library_trees()


@pytest.mark.parametrize("name", library_trees())
def test_each_file_of_the_library_is_a_mission_without_errors(name: str) -> None:
    assert [fault for fault in check_mission(FOLDER / f"{name}.xml") if fault.severity == "error"] == []


def test_a_mission_uses_a_tree_of_the_library_by_its_id() -> None:
    text = ESCAPE.format(body='<SubTree ID="Escape" name="flee" speed_mps="0.2"/>', more="")
    assert check_mission(text) == ()
    assert "flee/straight back" in paths(text)


def test_the_missions_own_tree_of_that_name_goes_first() -> None:
    own = '<BehaviorTree ID="Escape"><AlwaysSuccess name="mine"/></BehaviorTree>'
    text = ESCAPE.format(body='<SubTree ID="Escape" name="flee"/>', more=own).replace("<root ", '<root main_tree_to_execute="Main" ')
    assert check_mission(text) == ()
    assert paths(text) == {"flee", "flee/mine"}


def test_the_main_tree_is_never_one_of_the_library() -> None:
    other = '<BehaviorTree ID="Other"><SubTree ID="Escape"/></BehaviorTree>'
    text = ESCAPE.format(body='<Sequence><SubTree ID="Other"/></Sequence>', more=other)
    assert "Main" in repr(load_mission(text).name)


def test_a_name_that_nobody_knows_is_a_fault() -> None:
    with pytest.raises(MissionError, match="there is no tree 'Escpae'"):
        load_mission(ESCAPE.format(body='<SubTree ID="Escpae"/>', more=""))
