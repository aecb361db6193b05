"""SubTrees, scopes and the blackboard: bt_xml.md, sections 3 and 4. Notation: tests/trees/harness.py."""

from __future__ import annotations

from typing import Any

import pytest

from pluto_bt.runtime import VirtualClock
from pluto_bt.source import Fault
from pluto_bt.trees import MissionError, TickError, check_mission, load_mission
from tests.trees.harness import Bench

SCOPES = [
    # what it shows                      main tree, then the others                                                root entries afterwards
    ("nothing is shared unless mapped",
     '<Sequence><Script code="x := 1"/><Fallback><SubTree ID="B"/><AlwaysSuccess/></Fallback></Sequence>',
     'B { <Script code="y := 2"/> }', {"x": 1}),
    ("a mapped name reads and writes the parent's entry",
     '<Sequence><Script code="x := 1"/><SubTree ID="B" n="{x}"/></Sequence>',
     'B { <Script code="n += 1; n2 := n"/> }', {"x": 2}),
    ("{=} maps the same name",
     '<Sequence><Script code="n := 1"/><SubTree ID="B" n="{=}"/></Sequence>',
     'B { <Script code="n += 1"/> }', {"n": 2}),
    ("a new name under a mapping is made in the parent",
     '<SubTree ID="B" out="{answer}"/>', 'B { <Script code="out := 42"/> }', {"answer": 42}),
    ("mappings go through two levels",
     '<SubTree ID="B" a="{top}"/>', 'B { <SubTree ID="C" b="{a}"/> } C { <Script code="b := 7"/> }', {"top": 7}),
    ("_autoremap lets unmapped names fall through, but not private ones",
     '<Sequence><Script code="x := 1; _p := 1"/><SubTree ID="B" _autoremap="true"/></Sequence>',
     'B { <Script code="x += 1; z := 3; _p := 9"/> }', {"x": 2, "_p": 1, "z": 3}),
    ("a literal stays local even with _autoremap",
     '<Sequence><Script code="n := 1"/><SubTree ID="B" n="5" _autoremap="1"/></Sequence>',
     'B { <Script code="n += 1; seen := n"/> }', {"n": 1, "seen": 6}),
    ("literals are whole numbers, reals or texts",
     '<SubTree ID="B" a="007" b="1e3" c="true" d="1;2" _autoremap="true"/>',
     "B { <Script code=\"ra := a; rb := b; rc := c; rd := d\"/> }", {"ra": 7, "rb": 1000.0, "rc": "true", "rd": "1;2"}),
    ("@ means the root scope from any depth",
     '<SubTree ID="B"/>', 'B { <SubTree ID="C"/> } C { <Script code="@g := 5"/> }', {"g": 5}),
    ("a mapping may lead to the root scope",
     '<SubTree ID="B"/>', 'B { <SubTree ID="C" x="{@g}"/> } C { <Script code="x := 5"/> }', {"g": 5}),
    ("conditions on a SubTree tag are those of the parent",
     '<Sequence><Script code="skip := true"/><SubTree ID="B" _skipIf="skip"/></Sequence>',
     'B { <Script code="nowhere = 1"/> }', {"skip": 1.0}),
    ("SetBlackboard stores text, and copies with its kind",
     '<Sequence><Script code="x := 1.5"/><SetBlackboard value="42" output_key="a"/><SetBlackboard value="{x}" output_key="b"/>'
     '<SetBlackboard value="{nothing}" output_key="c" _onFailure="f := 1"/></Sequence>',
     "", {"x": 1.5, "a": "42", "b": 1.5, "f": 1}),
    ("output_key in braces names the entry that holds the key",
     '<Sequence><Script code="where := \'there\'"/><SetBlackboard value="1" output_key="{where}"/></Sequence>',
     "", {"where": "there", "there": "1"}),
    ("UnsetBlackboard removes the local entry, and succeeds without one",
     '<Sequence><Script code="x := 1; y := 2"/><UnsetBlackboard key="x"/><UnsetBlackboard key="x"/></Sequence>', "", {"y": 2}),
    ("a typed entry takes the parsed text",
     '<Sequence><Repeat num_cycles="{n}"><Script code="count := 1"/></Repeat></Sequence>', "", {"n": 2, "count": 1}),
]  # fmt: skip


@pytest.mark.parametrize(("body", "trees", "entries"), [row[1:] for row in SCOPES], ids=[row[0] for row in SCOPES])
def test_scopes(body: str, trees: str, entries: dict[str, Any]) -> None:
    bench = Bench(body, trees, blackboard={"n": 2} if "{n}" in body and "Repeat" in body else None)
    bench.mission.tick_once()
    assert dict(bench.mission.blackboard) == entries


def test_a_subtree_passes_its_childs_answer_also_skipped() -> None:
    bench = Bench('<SubTree ID="B"/>', "B { a:RSKF }")
    assert bench.run("aR → R; aS → S; aK → K; aF → F") == "aR → R; aS → S; aK → K; aF → F"


def test_paths_name_the_subtrees_and_number_what_has_no_name() -> None:
    bench = Bench('<Sequence name="top"><SubTree ID="B" name="left"/><SubTree ID="B"/>a:S</Sequence>', "B { <Inverter><AlwaysFailure/></Inverter> }")
    bench.mission.tick_once()
    assert bench.mission.statuses() == {
        "top": "SUCCESS",
        "left": "SUCCESS",
        "left/Inverter::3": "SUCCESS",
        "left/AlwaysFailure::4": "FAILURE",
        "B::5": "SUCCESS",
        "B::5/Inverter::6": "SUCCESS",
        "B::5/AlwaysFailure::7": "FAILURE",
        "a": "SUCCESS",
    }


def test_two_missions_share_nothing() -> None:
    one, two = (Bench('<Sequence><Script code="x := n"/><Sleep msec="100"/></Sequence>', blackboard={"n": n}) for n in (1, 2))
    assert one.tick() == two.tick() == "→ R"
    one.clock.advance(1.0)
    assert one.tick() == "→ S"
    assert two.tick() == "→ R"
    assert (one.mission.blackboard["x"], two.mission.blackboard["x"]) == (1, 2)


KINDS = [
    # entry n before; assigned afterwards; what n then is
    (1, 2, 2),
    (1, 2.0, 2),
    (1, "7", 7),
    (1.5, 2, 2.0),
    ("a", "b", "b"),
    (True, False, False),
]


@pytest.mark.parametrize(("before", "assigned", "after"), KINDS)
def test_an_entry_keeps_its_kind(before: Any, assigned: Any, after: Any) -> None:
    board = Bench("<AlwaysSuccess/>", blackboard={"n": before}).mission.blackboard
    board["n"] = assigned
    assert (board["n"], type(board["n"])) == (after, type(after))


@pytest.mark.parametrize(("before", "assigned"), [(1, 2.5), (1, "x"), (1, 2**40), (1.5, "x"), (True, 2)])
def test_a_value_of_another_kind_is_refused(before: Any, assigned: Any) -> None:
    board = Bench("<AlwaysSuccess/>", blackboard={"n": before}).mission.blackboard
    with pytest.raises(ValueError, match=r"is no (int|double|bool)"):
        board["n"] = assigned
    assert board["n"] == before


class FakeTopics:
    """Topics of a robot that has written only its pose."""

    def names(self) -> list[str]:
        return ["Localization/Pose", "Localization_Pose_x", "sick/scan"]

    def get(self, name: str) -> Any:
        return {"Localization/Pose": "a pose", "Localization_Pose_x": 2.5}[name]


def test_topics_are_global_read_only_entries() -> None:
    bench = Bench('<SubTree ID="B"/>', 'B { <ScriptCondition code="@Localization_Pose_x > 2"/> }', topics=FakeTopics())
    assert bench.tick() == "→ S"
    assert bench.mission.blackboard["Localization/Pose"] == "a pose"
    assert "sick/scan" not in bench.mission.blackboard


def test_a_mission_cannot_write_a_topic() -> None:
    bench = Bench('<Script code="@Localization_Pose_x := 0"/>', topics=FakeTopics())
    with pytest.raises(TickError, match="topic 'Localization_Pose_x' is read-only"):
        bench.mission.tick_once()


CLASHES = [
    ('<Sequence><Sleep msec="{n}"/><Repeat num_cycles="{n}"><AlwaysSuccess/></Repeat></Sequence>', "", 'entry "n" holds unsigned int'),
    ('<SubTree ID="B" v="1"/>', 'B { <Switch2 variable="{v}" case_1="1" case_2="2"><AlwaysSuccess/><AlwaysSuccess/><AlwaysSuccess/></Switch2> }',
     'entry "v" holds int'),
]  # fmt: skip


@pytest.mark.parametrize(("body", "trees", "message"), CLASHES)
def test_two_kinds_on_one_key_are_refused(body: str, trees: str, message: str) -> None:
    with pytest.raises(MissionError) as caught:
        Bench(body, trees)
    assert caught.value.faults[0].message.startswith(message)


PACED = '<BehaviorTree ID="B"><RateController hz="{hz}"><AlwaysSuccess/></RateController></BehaviorTree>'


def _faults_of_digits(declared: str) -> tuple[Fault, ...]:
    model = f'<TreeNodesModel><SubTree ID="B"><input_port name="hz" type="{declared}"/></SubTree></TreeNodesModel>' if declared else ""
    main = '<BehaviorTree ID="A">\n<SubTree ID="B" hz="40"/></BehaviorTree>\n'
    return check_mission(f'<root BTCPP_format="4" main_tree_to_execute="A">{main}{PACED}{model}</root>')


@pytest.mark.parametrize("declared", ["double", "float"])
def test_digits_are_a_real_number_where_the_model_declares_one(declared: str) -> None:
    assert _faults_of_digits(declared) == ()


def test_a_clash_is_told_at_the_literal_that_makes_it() -> None:
    (fault,) = _faults_of_digits("")
    assert (fault.line, fault.code) == (2, "type-clash") and "<text>:3:42 needs double" in fault.message and '"40.0"' in fault.mend


TOLD = """<BehaviorTree ID="B">
  <Sequence><SetBlackboard value="{text}" output_key="@said"/><Say text="{text}"/></Sequence></BehaviorTree>"""


def _text_mission(declared: str) -> str:
    model = f'<SubTree ID="B"><input_port name="text" type="{declared}"/></SubTree><SubTree ID="A"><input_port name="m" type="{declared}"/></SubTree>'
    main = '<BehaviorTree ID="A"><Sequence><SubTree ID="B" text="05"/>\n<SubTree ID="B" text="{m}"/></Sequence></BehaviorTree>\n'
    return f'<root BTCPP_format="4" main_tree_to_execute="A">{main}{TOLD}<TreeNodesModel>{model if declared else ""}</TreeNodesModel></root>'


@pytest.mark.parametrize("declared", ["string", "std::string"])
def test_digits_are_text_where_the_model_declares_a_string(declared: str) -> None:
    assert check_mission(_text_mission(declared), ports={"m": "042"}) == ()
    mission = load_mission(_text_mission(declared), ports={"m": "042"}, clock=VirtualClock())
    mission.tick_once()
    assert mission.blackboard["said"] == "042"


def test_who_gives_digits_to_a_text_is_told_how_they_become_text() -> None:
    faults = [fault for fault in check_mission(_text_mission(""), ports={"m": "042"}) if fault.code == "type-clash"]
    assert len(faults) == 2 and all('TreeNodesModel with type="string"' in fault.mend for fault in faults)
