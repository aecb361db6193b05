"""What the checker says: whole reports, with the place of the very attribute (bt_xml.md, sections 1 to 3 and 10)."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.trees import MissionError, check_mission, load_mission


def one_tree(body: str, attributes: str = 'BTCPP_format="4"') -> str:
    """A mission of one tree; the body stands on line 2."""
    return f'<root {attributes}><BehaviorTree ID="Main">\n{body}\n</BehaviorTree></root>'


def shown(text: str, **kwargs: object) -> list[str]:
    """Each fault as `line:column severity code: message`."""
    faults = check_mission(text, **kwargs)  # type: ignore[arg-type]
    return [f"{fault.line}:{fault.column} {fault.severity} {fault.code}: {fault.message}" for fault in faults]


def test_a_whole_report() -> None:
    text = one_tree('<Sequence>\n  <Sleep name="a nap" msce="10"/>\n</Sequence>')
    with pytest.raises(MissionError) as caught:
        load_mission(text, file="nap.xml")
    assert str(caught.value) == (
        'nap.xml:3:23: error: unknown port "msce" of <Sleep>\n'
        '        <Sleep name="a nap" msce="10"/>\n'
        "                            ^\n"
        "      expected  one of: msec\n"
        "      found     msce\n"
        '      mend      did you mean "msec"?'
    )


REFUSED = [
    # body                                                        faults
    ("<Sequenc><AlwaysSuccess/></Sequenc>", ["2:1 error unknown-node: unknown node <Sequenc>"]),
    ('<Action ID="Slep" msec="1"/>', ["2:13 error unknown-node: unknown node <Slep>"]),
    ("<Action/>", ["2:1 error missing-id: <Action> needs an ID"]),
    ('<Sleep ID="Sleep" msec="1"/>', ["2:8 error id-in-compact-form: <Sleep> takes no ID"]),
    ("<Sequence/>", ["2:1 error child-count: <Sequence> must have a child"]),
    ("<Inverter><AlwaysSuccess/><AlwaysSuccess/></Inverter>", ["2:1 error child-count: decorator <Inverter> must have exactly one child"]),
    ("<Inverter/>", ["2:1 error child-count: decorator <Inverter> must have exactly one child"]),
    ("<AlwaysSuccess><AlwaysSuccess/></AlwaysSuccess>", ["2:16 error child-count: <AlwaysSuccess> has no children"]),
    ("<TryCatch><AlwaysSuccess/></TryCatch>", ["2:1 error child-count: <TryCatch> needs something to try and a clean-up"]),
    ('<Sleep msec="-5"/>', ['2:14 error bad-literal: "-5" does not fit port "msec"']),
    ('<Sleep msec="+5"/>', ['2:14 error bad-literal: "+5" does not fit port "msec"']),
    ('<Sleep msec=" 5"/>', ['2:14 error bad-literal: " 5" does not fit port "msec"']),
    ('<Sleep msec=" {x} "/>', ['2:14 error bad-literal: " {x} " does not fit port "msec"']),
    ('<Sleep msec="{}"/>', ['2:14 error bad-literal: "{}" does not fit port "msec"']),
    ('<Sleep msec="99999999999"/>', ['2:14 error bad-literal: "99999999999" does not fit port "msec"']),
    ('<Repeat num_cycles="many"><AlwaysSuccess/></Repeat>', ['2:21 error bad-literal: "many" does not fit port "num_cycles"']),
    ('<RunOnce then_skip="yes"><AlwaysSuccess/></RunOnce>', ['2:21 error bad-literal: "yes" does not fit port "then_skip"']),
    ("<Script/>", ['2:1 error missing-port: port "code" of <Script> is missing']),
    ("<Precondition><AlwaysSuccess/></Precondition>", ['2:1 error missing-port: port "if" of <Precondition> is missing']),
    ("<WasEntryUpdated/>", ['2:1 error missing-port: port "entry" of <WasEntryUpdated> is missing']),
    ("<LoopInt><AlwaysSuccess/></LoopInt>", ['2:1 error missing-port: port "queue" of <LoopInt> is missing']),
    ('<LoopInt queue="1;x"><AlwaysSuccess/></LoopInt>', ['2:17 error bad-literal: "1;x" does not fit port "queue"']),
    ('<Script code="a := 1 +"/>', ["2:23 error script-syntax: script of code: an operand is missing"]),
    ('<AlwaysSuccess _skipIf="a % 2"/>', ["2:27 error script-syntax: script of _skipIf: unexpected character '%'"]),
    ('<ReactiveSequence><Action ID="AlwaysSuccess"/></ReactiveSequence>',
     ["2:19 error explicit-form: BehaviorTree.CPP refuses the explicit form directly under <ReactiveSequence>"]),
    ('<SubTree ID="Nowhere"/>', ["2:14 error unknown-tree: there is no tree 'Nowhere'"]),
    ("<SubTree/>", ["2:1 error missing-id: <SubTree> needs an ID"]),
    ('<SubTree ID="Sequence"/>', ["2:14 error id-is-node: 'Sequence' is a node type, not a tree"]),
    ('<SubTree ID="Main"/>', ["2:14 error recursion: tree 'Main' contains itself"]),
    ('<SubTree ID="Main"><AlwaysSuccess/></SubTree>',
     ["2:14 error recursion: tree 'Main' contains itself", "2:20 error child-count: a <SubTree> has no children"]),
    ('<SetBlackboard value="1" output_key="{@a@b}"/>', ["2:38 error bad-key: key '@a@b' has more than one '@'"]),
    ("<AlwaysSuccess/><AlwaysSuccess/>", ["1:24 error child-count: tree 'Main' must have exactly one child"]),
]  # fmt: skip


@pytest.mark.parametrize(("body", "faults"), REFUSED)
def test_refused_at_load(body: str, faults: list[str]) -> None:
    assert shown(one_tree(body)) == faults
    with pytest.raises(MissionError):
        load_mission(one_tree(body))


ONLY_WHILE_TICKING = [
    ("<Sleep/>", ['2:1 error missing-port: port "msec" of <Sleep> is missing']),
    ("<IfThenElse><AlwaysSuccess/></IfThenElse>", ["2:1 error child-count: <IfThenElse> has the wrong number of children"]),
    ('<Switch2 variable="x"><AlwaysSuccess/></Switch2>', ["2:1 error child-count: <Switch2> has the wrong number of children"]),
    ('<Parallel success_count="2"><AlwaysSuccess/></Parallel>', ["2:26 error threshold: success_count is more than the number of children"]),
    ('<ParallelAll max_failures="5"><AlwaysSuccess/></ParallelAll>', ["2:28 error threshold: max_failures is more than the number of children"]),
    ('<Precondition if="true" else="WRONG"><AlwaysSuccess/></Precondition>', ['2:31 error bad-literal: "WRONG" does not fit port "else"']),
]


@pytest.mark.parametrize(("body", "faults"), ONLY_WHILE_TICKING)
def test_an_error_of_ticking_is_told_by_check_but_does_not_stop_loading(body: str, faults: list[str]) -> None:
    assert shown(one_tree(body)) == faults
    load_mission(one_tree(body))


WARNINGS = [
    ('<Sleep msec="10abc"/>', ['2:14 warning trailing-text: "10abc" is read as 10']),
    ('<Repeat num_cycles="1.9"><AlwaysSuccess/></Repeat>', ['2:21 warning trailing-text: "1.9" is read as 1']),
    ('<AlwaysSuccess _skipif="true"/>', ['2:16 warning ignored-attribute: attribute "_skipif" is ignored']),
    ("<Switch2><AlwaysSuccess/><AlwaysSuccess/><AlwaysSuccess/></Switch2>",
     ["2:1 warning missing-port: <Switch2> without variable always takes its last child"]),
    ('<Parallel failure_count="2"><AlwaysSuccess/><AlwaysSuccess/></Parallel>',
     ["2:26 warning unreachable-threshold: failure_count 2 has no effect: 1 failures already end it"]),
]  # fmt: skip


@pytest.mark.parametrize(("body", "faults"), WARNINGS)
def test_what_is_silently_accepted_elsewhere_is_a_warning(body: str, faults: list[str]) -> None:
    assert shown(one_tree(body)) == faults
    load_mission(one_tree(body))


GOOD = '<BehaviorTree ID="A"><AlwaysSuccess/></BehaviorTree>'
DOCUMENTS = [
    # document                                                          faults
    (f"<root>{GOOD}</root>", ["1:1 warning no-format: BTCPP_format is missing"]),
    (f'<root BTCPP_format="3">{GOOD}</root>', ["1:21 warning other-format: the file says it is of another format"]),
    (f'<mission BTCPP_format="4">{GOOD}</mission>', ["1:1 error bad-root: the root element is <mission>"]),
    ('<root BTCPP_format="4"/>', ["1:1 error no-tree: the mission has no tree"]),
    ('<root BTCPP_format="4"><BehaviorTree><AlwaysSuccess/></BehaviorTree></root>', []),
    (f'<root BTCPP_format="4"><BehaviorTree><AlwaysSuccess/></BehaviorTree>{GOOD}</root>', ["1:24 error missing-id: this tree has no ID"]),
    (f'<root BTCPP_format="4">{GOOD}{GOOD}</root>', ["1:94 warning duplicate-id: tree 'A' replaces the one at <text>:1"]),
    ('<root BTCPP_format="4"><BehaviorTree ID="a b"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:42 error bad-id: 'a b' cannot be the ID of a tree"]),
    ('<root BTCPP_format="4"><BehaviorTree ID="Root"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:42 error bad-id: 'Root' cannot be the ID of a tree"]),
    ('<root BTCPP_format="4"><BehaviorTree ID="Sleep"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:42 error id-is-node: tree 'Sleep' has the name of a node type"]),
    (f'<root BTCPP_format="4" main_tree_to_execute="B">{GOOD}</root>', ["1:46 error unknown-tree: there is no tree 'B'"]),
    (f'<root BTCPP_format="4">{GOOD}<BehaviorTree ID="B"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:1 error no-main-tree: which tree is the main one is not said"]),
    (f'<root BTCPP_format="4">{GOOD}<BehaviorTree ID="B"><SubTree ID="A"/></BehaviorTree></root>', []),
    (f'<root BTCPP_format="4" main_tree_to_execute="A">{GOOD}<BehaviorTree ID="B"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:101 warning unused-tree: tree 'B' is not used"]),
    (f'<root BTCPP_format="4"><TreeNodesModel/><TreeNodesModel/>{GOOD}</root>', ["1:41 error second-model: a second <TreeNodesModel>"]),
    (f'<root BTCPP_format="4"><TreeNodesModel><SubTree ID="A"><input_port/></SubTree></TreeNodesModel>{GOOD}</root>',
     ["1:56 error missing-name: this port has no name"]),
    (f'<root BTCPP_format="4"><TreeNodesModel><Action ID="X"><input_prt name="a"/></Action></TreeNodesModel>{GOOD}</root>',
     ["1:55 warning unknown-element: <input_prt> means nothing in a model and is ignored"]),
    (f'<root BTCPP_format="4"><Behaviortree/>{GOOD}</root>', ["1:24 warning unknown-element: <Behaviortree> means nothing here and is ignored"]),
    ('<root BTCPP_format="4" main_tree_to_execute="A"><TreeNodesModel><SubTree ID="B"><input_port name="n"/></SubTree></TreeNodesModel>'
     '<BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree><BehaviorTree ID="B"><AlwaysSuccess/></BehaviorTree></root>',
     ['1:151 error missing-port: <SubTree ID="B"> needs port "n"']),
    ('<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A"><Sequence><SubTree ID="B" name="x"/><SubTree ID="B" name="x"/></Sequence>'
     '</BehaviorTree><BehaviorTree ID="B"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:128 error duplicate-path: two SubTrees have the path 'x'; the other is at <text>:1:80"]),
    ('<root BTCPP_format="4"><include/><BehaviorTree ID="A"><AlwaysSuccess/></BehaviorTree></root>',
     ["1:24 error missing-path: this include has no path"]),
    ('<root BTCPP_format="4"><include path="nowhere.xml"/></root>', ["1:39 error no-file: there is no file 'nowhere.xml'"]),
    ('<root BTCPP_format="4"><include path="x.xml" ros_pkg="nav"/></root>', ["1:46 error ros-package: there are no ROS packages here"]),
]  # fmt: skip


@pytest.mark.parametrize(("document", "faults"), DOCUMENTS)
def test_documents(document: str, faults: list[str]) -> None:
    assert shown(document) == faults


def test_a_model_gives_defaults_to_a_subtree_and_autoremap_switches_its_checks_off() -> None:
    text = (
        '<root BTCPP_format="4" main_tree_to_execute="A"><TreeNodesModel><SubTree ID="B"><input_port name="n" default="7"/>'
        '<output_port name="out" default="{answer}"/></SubTree></TreeNodesModel><BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree>'
        '<BehaviorTree ID="B"><Script code="out := n"/></BehaviorTree></root>'
    )
    mission = load_mission(text)
    mission.tick_once()
    assert dict(mission.blackboard) == {"answer": 7}


INPUTS = (
    '<root BTCPP_format="4"><TreeNodesModel><SubTree ID="Main"><input_port name="goals">where to drive</input_port>'
    '<input_port name="max_loops" default="-1"/></SubTree></TreeNodesModel>'
    '<BehaviorTree ID="Main"><Script code="seen := max_loops"/></BehaviorTree></root>'
)


def test_inputs_of_the_main_tree_are_typed_and_defaulted() -> None:
    mission = load_mission(INPUTS, ports={"goals": "1,2;3,4"})
    assert dict(mission.blackboard) == {"goals": "1,2;3,4", "max_loops": -1}
    assert mission.blackboard.writes("goals") == 1


@pytest.mark.parametrize(
    ("ports", "message"),
    [({}, 'input "goals" of \'Main\' is not given'), ({"goals": "1,2", "max_lops": "3"}, 'tree \'Main\' has no input "max_lops"')],
)
def test_inputs_that_are_missing_or_unknown(ports: dict[str, str], message: str) -> None:
    with pytest.raises(MissionError) as caught:
        load_mission(INPUTS, ports=ports)
    assert caught.value.faults[0].message == message


def test_faults_in_included_files_name_the_file(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "main.xml").write_text('<root BTCPP_format="4" main_tree_to_execute="A">\n<include path="parts/b.xml"/>\n'
                                       '<BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree></root>')  # fmt: skip
    (tmp_path / "parts/b.xml").write_text('<root BTCPP_format="4">\n<include path="c.xml"/>'
                                          '<BehaviorTree ID="B">\n  <SubTree ID="C"/></BehaviorTree></root>')  # fmt: skip
    (tmp_path / "parts/c.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="C">\n   <Slep msec="1"/></BehaviorTree></root>')
    fault = check_mission(tmp_path / "main.xml", file="main.xml")[0]
    assert (fault.file, fault.line, fault.column, fault.mend) == ("parts/c.xml", 2, 4, 'did you mean "Sleep"?')


def test_includes_in_a_circle_are_refused_and_one_file_may_be_included_twice(tmp_path: Path) -> None:
    head = '<root BTCPP_format="4" main_tree_to_execute="A">'
    (tmp_path / "a.xml").write_text(f'{head}<include path="b.xml"/><include path="c.xml"/>{GOOD}</root>')
    (tmp_path / "b.xml").write_text('<root BTCPP_format="4"><include path="c.xml"/></root>')
    (tmp_path / "c.xml").write_text('<root BTCPP_format="4"/>')
    assert check_mission(tmp_path / "a.xml") == ()
    (tmp_path / "c.xml").write_text('<root BTCPP_format="4"><include path="a.xml"/></root>')
    fault = check_mission(tmp_path / "a.xml")[0]
    assert (fault.code, fault.found) == ("include-cycle", "a.xml → b.xml → c.xml → a.xml")


def test_the_including_file_wins_over_the_included_one(tmp_path: Path) -> None:
    (tmp_path / "lib.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="A"><AlwaysFailure/></BehaviorTree></root>')
    (tmp_path / "main.xml").write_text(f'<root BTCPP_format="4"><include path="lib.xml"/>{GOOD}</root>')
    assert load_mission(tmp_path / "main.xml").tick_once() == "SUCCESS"


NEAR = 'did you mean "library.xml"?'


@pytest.mark.parametrize(("path", "mend"), [("nofile.xml", ""), ("libary.xml", NEAR), ("LIBRARY.xml", NEAR)])
def test_only_a_name_that_is_near_is_proposed_for_a_missing_include(tmp_path: Path, path: str, mend: str) -> None:
    for name in ("old", "library", "uni"):
        (tmp_path / f"{name}.xml").write_text(f'<root BTCPP_format="4">{GOOD}</root>')
    (tmp_path / "main.xml").write_text(f'<root BTCPP_format="4"><include path="{path}"/>{GOOD}</root>')
    with pytest.raises(MissionError) as caught:
        load_mission(tmp_path / "main.xml")
    assert [(fault.code, fault.mend) for fault in caught.value.faults if fault.severity == "error"] == [("no-file", mend)]


def test_a_missing_file_is_a_fault() -> None:
    with pytest.raises(MissionError, match=r"nowhere\.xml"):
        load_mission("nowhere.xml")


def test_subtrees_that_double_each_time_are_refused_quickly() -> None:
    twice = '<BehaviorTree ID="T{}"><Sequence><SubTree ID="T{}"/><SubTree ID="T{}"/></Sequence></BehaviorTree>'
    trees = "".join(twice.format(i, i + 1, i + 1) for i in range(40))
    text = f'<root BTCPP_format="4" main_tree_to_execute="T0">{trees}<BehaviorTree ID="T40"><AlwaysSuccess/></BehaviorTree></root>'
    assert [fault.code for fault in check_mission(text)] == ["too-many-nodes"]


def test_very_deep_nesting_is_a_fault_and_no_crash() -> None:
    deep = "<Sequence>" * 300 + "<AlwaysSuccess/>" + "</Sequence>" * 300
    assert [fault.code for fault in check_mission(one_tree(deep))] == ["too-deep"]
    trees = "".join(f'<BehaviorTree ID="T{i}"><SubTree ID="T{i + 1}"/></BehaviorTree>' for i in range(400))
    text = f'<root BTCPP_format="4" main_tree_to_execute="T0">{trees}<BehaviorTree ID="T400"><AlwaysSuccess/></BehaviorTree></root>'
    assert [fault.code for fault in check_mission(text)] == ["too-deep"]
    nested = "<ForceSuccess>" * 250 + "<AlwaysFailure/>" + "</ForceSuccess>" * 250
    assert load_mission(one_tree(nested)).tick_once() == "SUCCESS"


def test_official_files_with_raw_signs_in_attributes_load() -> None:
    mission = load_mission(one_tree('<Script code="a:=1; b:=2; ok := a<b && b!=a" _skipIf="1 < 0"/>'))
    mission.tick_once()
    assert mission.blackboard["ok"] == 1.0


WORDS = st.sampled_from([
    '<root BTCPP_format="4">', "</root>", '<BehaviorTree ID="A">', "</BehaviorTree>", "<Sequence>", "</Sequence>", "<Sleep msec=", '"1"/>',
    '<SubTree ID="A"/>', '<Script code="x:=', '"', "{x}", "<include path='a.xml'/>", "<TreeNodesModel>", "</TreeNodesModel>", "&", "\n",
])  # fmt: skip


@given(st.lists(WORDS, max_size=14).map("".join))
@settings(max_examples=150)
def test_any_text_is_loaded_or_refused_with_faults(text: str) -> None:
    try:
        load_mission("<" + text if not text.startswith("<") else text)
    except MissionError as error:
        assert error.faults
