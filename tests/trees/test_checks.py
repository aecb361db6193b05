"""What only the whole mission tells: entries before any write, branches never reached, branches that both drive (pluto_bt/trees/checks)."""

from __future__ import annotations

import contextlib
import itertools
from typing import Any, ClassVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation

from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.source import XmlAttribute
from pluto_bt.trees import TickError, check_mission, load_mission

OK = "<AlwaysSuccess/>"


def mission(body: str, more: str = "") -> str:
    """A main tree whose body stands in line 2; `more` stands in line 4."""
    return f'<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A">\n{body}\n</BehaviorTree>\n{more}</root>'


def told(body: str, more: str = "", **options: Any) -> list[str]:
    """Each fault as "line:column severity code"."""
    faults = check_mission(mission(body, more), topics=TopicGlobals(), **options)
    return [f"{fault.line}:{fault.column} {fault.severity} {fault.code}" for fault in faults]


def tree(name: str, body: str) -> str:
    """A further tree."""
    return f'<BehaviorTree ID="{name}">{body}</BehaviorTree>'


ENTRIES = [
    # what it shows                                  body, more trees                                                          faults
    ("nothing writes it", '<Sleep msec="{t}"/>', "", ["2:14 error unset-key"]),
    ("written before", '<Sequence><Script code="t := 5"/><Sleep msec="{t}"/></Sequence>', "", []),
    ("written by a script after it", '<Sequence><Sleep msec="{t}"/><Script code="t := 5"/></Sequence>', "", ["2:24 error unset-key"]),
    ("a Fallback's first child may have written", '<Fallback><Script code="t := 5"/><Sleep msec="{t}"/></Fallback>', "",
     ["2:34 warning unreachable"]),
    ("SetBlackboard writes", '<Sequence><SetBlackboard value="5" output_key="t"/><Sleep msec="{t}"/></Sequence>', "", []),
    ("a key that is read itself", '<Sequence><SetBlackboard value="5" output_key="{where}"/></Sequence>', "", ["2:48 error unset-key"]),
    ("copying an entry that nothing writes fails, and may be meant to", '<SetBlackboard value="{x}" output_key="t"/>', "",
     ["2:23 warning unset-key"]),
    ("an output port writes", '<Sequence><GoTo goal="1;2" reason="{why}"/><ScriptCondition code="why == \'\'"/></Sequence>', "", []),
    ("an output port that comes too late", '<Sequence><ScriptCondition code="why == \'\'"/><GoTo goal="1;2" reason="{why}"/></Sequence>', "",
     ["2:34 error unset-key"]),
    ("in a loop the round before may have written",
     f'<Repeat num_cycles="3"><Sequence><Fallback><AlwaysFailure/><ScriptCondition code="n"/></Fallback>'
     f'<Script code="n := 1"/>{OK}</Sequence></Repeat>', "", []),
    ("in a loop the first round comes to it first",
     '<Repeat num_cycles="3"><Sequence><ScriptCondition code="n"/><Script code="n := 1"/></Sequence></Repeat>',
     "", ["2:57 error unset-key"]),
    ("what can fail before a parallel does not change the order inside it",
     '<Sequence><IsStuck/><Parallel><Sleep msec="{t}"/><Script code="t := 2"/></Parallel></Sequence>', "", ["2:44 error unset-key"]),
    ("nor does another fault",
     '<Sequence><Say text="{a}"/><ReactiveSequence><Sleep msec="{t}"/><Script code="t := 2"/></ReactiveSequence></Sequence>', "",
     ["2:22 error unset-key", "2:59 error unset-key"]),
    ("a branch that a parallel may skip",
     '<Parallel><IsStuck/><Sleep msec="{t}" _skipIf="@Localization_Pose_x &gt; 1"/><Script code="t := 2"/></Parallel>', "", []),
    ("a topic is only read", '<Script code="@Localization_Pose_x := 3"/>', "", ["2:15 error read-only"]),
    ("a topic is only read, by any name", '<Script code="a := 1; Localization_Pose_x := 3"/>', "", ["2:23 error read-only"]),
    ("a topic is no place for an output", '<GoTo goal="1;2" reason="{@Localization_Pose_x}"/>', "", ["2:26 error read-only"]),
    ("a reactive condition may be written below it later",
     '<ReactiveSequence><Fallback><IsStuck/><ScriptCondition code="n"/></Fallback><Script code="n := 1"/>'
     "</ReactiveSequence>", "", []),
    ("a script needs its names", '<Script code="a := b + 1"/>', "", ["2:20 error unset-key"]),
    ("in the order of the statements", '<Script code="a := 1; b := a; a := c"/>', "", ["2:36 error unset-key"]),
    ("a name needs itself", '<Script code="a := a + 1"/>', "", ["2:20 error unset-key"]),
    ("+= needs a value", '<Script code="n += 1"/>', "", ["2:15 error unset-key"]),
    ("= needs an entry", '<Script code="n = 1"/>', "", ["2:15 error unset-key"]),
    ("= may use an entry that a port declares", '<Sequence><Script code="n = 1"/><Sleep msec="{n}"/></Sequence>', "", []),
    ("a condition reads before its node writes", '<Script code="n := 1" _skipIf="n == 1"/>', "", ["2:32 error unset-key"]),
    ("a script after the node reads what it wrote", '<Script code="n := 1" _onSuccess="m := n"/>', "", []),
    ("positions behind entities", '<ScriptCondition code="1 &lt; 2 &amp;&amp; nix"/>', "", ["2:44 error unset-key"]),
    ("a text without quotes", '<Script code="mode := fast"/>', "", ["2:23 error unset-key"]),
    ("a mapped input", '<SubTree ID="B" t="{x}"/>', tree("B", '<Sleep msec="{t}"/>'), ["4:35 error unset-key"]),
    ("a literal input", '<SubTree ID="B" t="5"/>', tree("B", '<Repeat num_cycles="{t}"><AlwaysSuccess/></Repeat>'), []),
    ("not mapped", '<Sequence><Script code="t := 5"/><SubTree ID="B"/></Sequence>', tree("B", '<Sleep msec="{t}"/>'), ["4:35 error unset-key"]),
    ("autoremap", '<Sequence><Script code="t := 5"/><SubTree ID="B" _autoremap="1"/></Sequence>', tree("B", '<Sleep msec="{t}"/>'), []),
    ("the root entry from below", '<Sequence><Script code="t := 5"/><SubTree ID="B"/></Sequence>', tree("B", '<Sleep msec="{@t}"/>'), []),
    ("an output of a SubTree", '<Sequence><SubTree ID="B" out="{t}"/><Sleep msec="{t}"/></Sequence>', tree("B", '<Script code="out := 5"/>'), []),
    ("a declared input may be given later", '<Sleep msec="{t}"/>',
     '<TreeNodesModel><SubTree ID="A"><input_port name="t"/></SubTree></TreeNodesModel>', []),
    ("an optional port falls back to its default", '<GoTo goal="1;2" timeout_s="{t}"/>', "", ["2:29 warning unset-key"]),
    ("an empty queue is no error", f'<LoopInt queue="{{q}}" value="{{v}}">{OK}</LoopInt>', "", ["2:17 warning unset-key"]),
    ("an entry that is never updated", f'<SkipUnlessUpdated entry="{{e}}">{OK}</SkipUnlessUpdated>', "", ["2:27 warning unset-key"]),
    ("a topic", '<ScriptCondition code="@Localization_Pose_x > 1"/>', "", []),
    ("a field that the topic does not have", '<ScriptCondition code="@Localization_Pose_q > 1"/>', "", ["2:24 error unknown-topic"]),
    ("a topic that does not exist", '<Sequence><Script code="@batery := 1"/><ScriptCondition code="@battery == 1"/></Sequence>', "",
     ["2:63 error unknown-topic"]),
    ("told once, though the tree is used twice", '<Sequence><SubTree ID="B" name="x"/><SubTree ID="B" name="y"/></Sequence>',
     tree("B", '<Sleep msec="{t}"/>'), ["4:35 error unset-key"]),
    ("an unknown node may write what it names", '<Sequence><Foo out="{t}"/><Sleep msec="{t}"/><Sleep msec="{u}"/></Sequence>', "",
     ["2:11 error unknown-node", "2:59 error unset-key"]),
    ("a node beside what is wrong in another way", '<Sequence><Sleep msec="x"/><Sleep msec="{t}"/></Sequence>', "",
     ["2:24 error bad-literal", "2:41 error unset-key"]),
]  # fmt: skip


@pytest.mark.parametrize(("body", "more", "faults"), [row[1:] for row in ENTRIES], ids=[row[0] for row in ENTRIES])
def test_entries(body: str, more: str, faults: list[str]) -> None:
    assert told(body, more) == faults


ALIASES = [
    # the SubTree tags, outermost first                                   the entry, as it is read, and the tag that gives it its meaning
    ('<SubTree ID="B" t="{q}"/>', '<Sleep msec="{t}"/>', 'nothing writes entry "q", which is read here as "t"', '<text>:2:17'),
    ('<SubTree ID="B" t="{=}"/>', '<Sleep msec="{t}"/>', 'nothing writes entry "t", which is read here', '<text>:2:17'),
    ('<Sequence><SubTree ID="B" t="{q}"/><Script code="q := 5"/></Sequence>', '<Sleep msec="{t}"/>',
     'entry "q" is read here as "t" before anything can have written it', '<text>:2:27'),
    ('<SubTree ID="B" u="{q}"/>', '<SubTree ID="C" t="{u}"/>', 'nothing writes entry "q", which is read here as "t"', '<text>:2:17'),
]  # fmt: skip


@pytest.mark.parametrize(("tag", "body", "message", "place"), ALIASES)
def test_an_entry_that_a_subtree_tag_leads_to_is_told_by_its_own_name(tag: str, body: str, message: str, place: str) -> None:
    faults = check_mission(mission(tag, tree("B", body) + tree("C", '<Sleep msec="{t}"/>')))
    (fault,) = [fault for fault in faults if fault.code == "unset-key"]
    assert fault.message == message and "give the tag a port" not in fault.mend
    assert f"at {place} leads to it" in fault.found


MENDS = [
    ('<Sequence><Script code="place := \'1;2\'"/><GoTo goal="{plce}"/></Sequence>', "", 'did you mean "place"?'),
    ('<ScriptCondition code="@Localization_Pose_q > 1"/>', "", 'did you mean "@Localization_Pose_'),
    ('<Sequence><Script code="t := 5"/><SubTree ID="B"/></Sequence>', tree("B", '<Sleep msec="{t}"/>'), 'map it on the <SubTree> tag: t="{t}"'),
    ('<Sequence><Sleep msec="{t}"/><Script code="t := 5"/></Sequence>', "", "write it earlier"),
    ('<Script code="n = 1"/>', "", "':=' creates the entry"),
    ('<Script code="mode := fast"/>', "", "a text stands in single quotes: 'fast'"),
]


@pytest.mark.parametrize(("body", "more", "mend"), MENDS)
def test_a_fault_of_an_entry_says_how_to_mend_it(body: str, more: str, mend: str) -> None:
    (fault,) = check_mission(mission(body, more), topics=TopicGlobals())
    assert fault.mend.startswith(mend)


class Secretive(BehaviourWithPorts, tag="Secretive"):
    """A user's leaf: it may write what no port tells."""

    INPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def setup(self, **kwargs: Any) -> None:
        self.board = kwargs["blackboard"]

    def update(self) -> Status:
        self.board["t"] = 5
        return Status.SUCCESS


def test_beside_a_users_leaf_a_missing_write_is_only_a_warning() -> None:
    body = '<Sequence><Secretive/><Sleep msec="{t}"/></Sequence>'
    assert told(body, nodes=[Secretive]) == ["2:36 warning unset-key"]
    assert load_mission(mission(body), nodes=[Secretive]).tick_once() == "RUNNING"


REACH = [
    ("<Fallback><AlwaysSuccess/><AlwaysFailure/></Fallback>", ["2:27"]),
    ("<Fallback><AlwaysFailure/><AlwaysSuccess/></Fallback>", []),
    ("<Sequence><AlwaysFailure/><AlwaysSuccess/><AlwaysSuccess/></Sequence>", ["2:27"]),
    ('<Sequence><AlwaysFailure _skipIf="true"/><AlwaysSuccess/></Sequence>', ["2:35"]),
    ('<Sequence><Repeat num_cycles="-1"><IsStuck/></Repeat><AlwaysSuccess/></Sequence>', ["2:54"]),
    ('<Fallback><Repeat num_cycles="-1"><IsStuck/></Repeat><AlwaysSuccess/></Fallback>', []),
    ('<Fallback><RetryUntilSuccessful num_attempts="-1"><IsStuck/></RetryUntilSuccessful><AlwaysSuccess/></Fallback>', ["2:84"]),
    ("<Sequence><KeepRunningUntilFailure><IsStuck/></KeepRunningUntilFailure><AlwaysSuccess/></Sequence>", ["2:72"]),
    ('<Repeat num_cycles="0"><AlwaysSuccess/></Repeat>', ["2:24"]),
    ('<RetryUntilSuccessful num_attempts="0"><AlwaysSuccess/></RetryUntilSuccessful>', ["2:40"]),
    ('<Precondition if="1 == 2"><AlwaysSuccess/></Precondition>', ["2:27"]),
    ('<Precondition if="1 == 1"><AlwaysSuccess/></Precondition>', []),
    ("<IfThenElse><AlwaysSuccess/><IsStuck/><IsTilted/></IfThenElse>", ["2:39"]),
    ("<WhileDoElse><AlwaysFailure/><IsStuck/><IsTilted/></WhileDoElse>", ["2:30"]),
    ("<TryCatch><AlwaysSuccess/><Say text='x'/></TryCatch>", ["2:27"]),
    ("<TryCatch catch_on_halt='true'><AlwaysSuccess/><Say text='x'/></TryCatch>", []),
    ("<Fallback><Inverter><AlwaysFailure/></Inverter><IsStuck/></Fallback>", ["2:48"]),
    ("<Fallback><ForceSuccess><IsStuck/></ForceSuccess><IsStuck/></Fallback>", ["2:50"]),
    ("<Fallback><Timeout msec='10'><AlwaysSuccess/></Timeout><IsStuck/></Fallback>", []),
    ("<Fallback><RunOnce><AlwaysSuccess/></RunOnce><IsStuck/></Fallback>", []),
    ('<AlwaysSuccess _while="1 &gt; 2"/>', ["2:24"]),
    ('<AlwaysSuccess _failureIf="@Localization_Pose_x > 1" _successIf="true"/>', ["2:66"]),
    ('<Sequence><Parallel><AlwaysSuccess/></Parallel><IsStuck/></Sequence>', []),
]


@pytest.mark.parametrize(("body", "places"), REACH)
def test_branches_that_are_never_ticked(body: str, places: list[str]) -> None:
    assert told(body) == [f"{place} warning unreachable" for place in places]


def test_a_tree_that_is_reached_in_one_of_two_places_is_reached() -> None:
    body = '<Fallback><SubTree ID="B"/><AlwaysSuccess/><SubTree ID="B"/></Fallback>'
    faults = check_mission(mission(body, tree("B", "<Sequence><IsStuck/><IsTilted/></Sequence>")))
    assert [(fault.column, fault.code) for fault in faults] == [(44, "unreachable")]


LEAVES = st.sampled_from([OK, "<AlwaysFailure/>", '<ScriptCondition code="a"/>', '<ScriptCondition code="b"/>', '<AlwaysSuccess _skipIf="a"/>',
                          '<AlwaysFailure _skipIf="true"/>', '<Script code="c := 1"/>'])  # fmt: skip
WRAPS = ["Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure", 'Repeat num_cycles="2"', 'RetryUntilSuccessful num_attempts="2"',
 "RunOnce",
         'Precondition if="a"', 'Repeat num_cycles="-1"', 'RetryUntilSuccessful num_attempts="0"', 'Inverter _while="1 &lt; 0"']  # fmt: skip
ROWS = ["Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "SequenceWithMemory", "Parallel", "AsyncFallback", 'Sequence _successIf="b"']


def wrapped(head: str, inner: str) -> str:
    return f"<{head}>{inner}</{head.split()[0]}>"


def branches(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.builds(wrapped, st.sampled_from(WRAPS), inner),
        st.builds(wrapped, st.sampled_from(ROWS), st.lists(inner, min_size=1, max_size=3).map("".join)),
        st.builds(wrapped, st.sampled_from(["IfThenElse", "WhileDoElse"]), st.lists(inner, min_size=3, max_size=3).map("".join)),
        st.builds(wrapped, st.just("TryCatch"), st.lists(inner, min_size=2, max_size=3).map("".join)),
    )


@given(st.recursive(LEAVES, branches, max_leaves=12))
@settings(max_examples=120, deadline=None)
def test_what_is_called_unreachable_is_never_ticked_whatever_the_conditions_say(body: str) -> None:
    text = mission(body)
    lost = {(fault.line, fault.column) for fault in check_mission(text) if fault.code == "unreachable"}
    for a, b in itertools.product((0, 1), repeat=2):
        loaded = load_mission(text, blackboard={"a": a, "b": b})
        places = {one.path: one.plan.element for one in loaded.nodes()}
        for _ in range(4):
            with contextlib.suppress(TickError):  # a condition that is skipped is an error of ticking
                loaded.tick_exactly_once()
            ticked = [places[path] for path, status in loaded.statuses().items() if status not in ("IDLE", "SKIPPED")]
            assert not [one for one in ticked if (one.place.line, one.place.column) in lost]


SCRIPTS = st.sampled_from([OK, '<ScriptCondition code="a"/>', *(f'<Script code="{name} := 1"/>' for name in "xyz"),
                           *(f'<ScriptCondition code="{name} == 1"/>' for name in "xyz"), '<Script code="x := y; z := 0"/>',
                           '<Script code="z := 1" _skipIf="x == 2" _onSuccess="y := z"/>', '<SubTree ID="B" v="{x}" w="{y}"/>'])  # fmt: skip


def holds(attribute: XmlAttribute, places: set[tuple[int, int]]) -> bool:
    """True if one of the places is inside the value."""
    first = attribute.value_place
    return any(line == first.line and first.column <= column < first.column + len(attribute.value) for line, column in places)


@given(st.recursive(SCRIPTS, branches, max_leaves=12))
@settings(max_examples=120, deadline=None)
def test_a_read_that_is_called_too_early_never_succeeds(body: str) -> None:
    text = mission(body.replace("_successIf", "_onSuccess").replace('"b"', '"y := 2"'), tree("B", '<Script code="w := v"/>'))
    faults = [fault for fault in check_mission(text, ports={"a": "1"}) if fault.code == "unset-key"]
    early = {(fault.line, fault.column) for fault in faults}
    for a in (0, 1):
        loaded = load_mission(text, blackboard={"a": a})
        readers = {one.path for one in loaded.nodes() if any(holds(attribute, early) for attribute in one.plan.element.attributes.values())}
        for _ in range(4):
            try:
                loaded.tick_exactly_once()
            except TickError:
                break
            done = [path for path, status in loaded.statuses().items() if path in readers and status in ("SUCCESS", "FAILURE")]
            assert not done


X = '<Script code="x := 1"/>'
CERTAIN = [
    # what it shows                     body                                                                            faults
    ("a text for a number", f"<Sequence>{X}<Script code=\"x := 't'\"/></Sequence>", ["2:48 error script-fails"]),
    ("a number in digits", f"<Sequence>{X}<Script code=\"x := '7'\"/></Sequence>", []),
    ("a number for a text", "<Script code=\"x := 't'; x := 3\"/>", ["2:25 error script-fails"]),
    ("half of a whole number", '<Script code="x := 5; x /= 2"/>', ["2:23 error script-fails"]),
    ("half of an even one", '<Script code="x := 6; x /= 2"/>', []),
    ("bits of a fraction", '<Script code="a := 1.5 &amp; 2"/>', ["2:15 error script-fails"]),
    ("a sum with a text", "<Script code=\"x := 't'; z := x + 1\"/>", ["2:30 error script-fails"]),
    ("a text is no answer", "<ScriptCondition code=\"'t'\"/>", ["2:24 error script-fails"]),
    ("nor is it of a condition", f'<Sequence>{X}<Sleep msec="1" _skipIf="x + 1"/></Sequence>', []),
    ("two is neither true nor false", '<Sequence><Script code="x := 2"/><Sleep msec="1" _skipIf="x"/></Sequence>', ["2:59 error script-fails"]),
    ("a number is no goal", f'<Sequence>{X}<GoTo goal="{{x}}"/></Sequence>', ["2:46 error bad-literal"]),
    ("a time below 0", '<Sequence><Script code="n := -1"/><Sleep msec="{n}"/></Sequence>', ["2:48 error bad-literal"]),
    ("below its limit", '<Sequence><Script code="n := 0.001"/><GoTo goal="4;3" tolerance_m="{n}"/></Sequence>', ["2:68 error bad-literal"]),
    ("through a SubTree", f'<Sequence>{X}<SubTree ID="B" goal="{{x}}"/></Sequence>', ["4:34 error bad-literal"]),
    ("a literal of a SubTree", '<SubTree ID="B" goal="door"/>', ["4:34 error bad-literal"]),
    ("a branch may have changed it",
     f"<Sequence>{X}<Fallback><IsStuck/><Script code=\"x := '7;7'\"/></Fallback><GoTo goal=\"{{x}}\"/></Sequence>", []),
    ("a round before may have changed it",
     f'<Sequence>{X}<Repeat num_cycles="2"><Sequence><Fallback><IsStuck/><Script code="x &amp; 1.5"/></Fallback><GoTo goal="1;2"/>'
     '<Script code="x := 2.0"/></Sequence></Repeat></Sequence>', []),
    ("a leaf has written it", f'<Sequence>{X}<GoTo goal="1;2" reason="{{y}}"/><Script code="y + 1"/></Sequence>', []),
    ("a condition keeps it from being reached", f"<Fallback><Sequence>{X}<ScriptCondition code=\"x == 2\"/><Script code=\"x := 't'\"/></Sequence>"
     "<AlwaysSuccess/></Fallback>", []),
    ("a node that is always passed over", f"<Sequence>{X}<Script code=\"x := 't'\" _skipIf=\"x == 1\"/></Sequence>", []),
    ("an entry that was taken away", f"<Sequence>{X}<UnsetBlackboard key=\"x\"/><Script code=\"x := 't'\"/></Sequence>", []),
    ("a topic is what it is", '<Script code="a := @Localization_Pose_x &amp; 1"/>', []),
]  # fmt: skip


@pytest.mark.parametrize(("body", "faults"), [row[1:] for row in CERTAIN], ids=[row[0] for row in CERTAIN])
def test_values_that_are_certain_must_fit(body: str, faults: list[str]) -> None:
    assert [one for one in told(body, tree("B", '<GoTo goal="{goal}"/>')) if "unused-tree" not in one] == faults


def test_an_input_is_looked_through_at_the_port_it_ends_in() -> None:
    (fault,) = check_mission(mission('<SubTree ID="B" goal="{place}"/>', tree("B", '<GoTo goal="{goal}"/>')), ports={"place": "door"})
    assert (fault.severity, fault.code, fault.line) == ("error", "bad-literal", 4)
    assert fault.message.startswith("entry \"goal\" is text 'door' here")
    assert fault.mend == "it is an input: give another value with --port place=VALUE"


SUMS = st.sampled_from([OK, "<AlwaysFailure/>", '<ScriptCondition code="a"/>', '<Script code="x := 1"/>', "<Script code=\"x := 't'\"/>",
                        '<Script code="x := 2.5"/>', '<Script code="y := x; y /= 2"/>', '<Script code="x &amp; 1"/>', '<Script code="z := x + 1"/>',
                        '<Sleep msec="{z}"/>', "<Script code=\"x := '3'\" _skipIf=\"x == 1\" _onSuccess=\"y := 5\"/>",
                        '<ScriptCondition code="y == 1"/>', '<SubTree ID="B" v="{x}" w="{y}"/>', '<UnsetBlackboard key="x"/>'])  # fmt: skip


@given(st.recursive(SUMS, branches, max_leaves=14))
@settings(max_examples=60, deadline=None)
def test_what_is_said_to_fail_never_succeeds(body: str) -> None:
    text = mission(body.replace("_successIf", "_onSuccess").replace('"b"', '"y := 2"'), tree("B", '<Script code="w := v"/>'))
    surely = {(fault.line, fault.column) for fault in check_mission(text, ports={"a": "1"}) if fault.code in ("script-fails", "bad-literal")}
    for a in (0, 1):
        loaded = load_mission(text, blackboard={"a": a})
        failing = {one.path for one in loaded.nodes() if any(holds(attribute, surely) for attribute in one.plan.element.attributes.values())}
        for _ in range(4):
            try:
                loaded.tick_exactly_once()
            except TickError:
                break
            assert not [path for path, status in loaded.statuses().items() if path in failing and status in ("SUCCESS", "FAILURE")]


DRIVES = [
    ('<Parallel><GoTo goal="1;2"/><DriveVelocity/></Parallel>', ["2:29 error parallel-drive"]),
    ('<Parallel><Say text="x"/><DriveVelocity/></Parallel>', []),
    ('<ParallelAll><Sequence><Say text="x"/><MoveTo goal="1;2"/></Sequence><MakeTurn angle_deg="90"/></ParallelAll>', ["2:70 error parallel-drive"]),
    ('<Parallel><Sequence><Sleep msec="5"/><GoTo goal="1;2"/></Sequence><GoTo goal="1;2"/></Parallel>', ["2:67 warning parallel-drive"]),
    ('<Parallel><GoTo goal="1;2" _skipIf="@Localization_Pose_x > 3"/><GoTo goal="1;2"/></Parallel>', ["2:64 warning parallel-drive"]),
    ('<Parallel success_count="1"><GoTo goal="1;2"/><Sequence><Sleep msec="9"/><Stop/></Sequence></Parallel>', []),
    ('<Parallel><Fallback><GoTo goal="1;2"/><DriveVelocity/></Fallback><SweepWrist/></Parallel>', []),
    ('<ReactiveFallback><GoTo goal="1;2"/><GoTo goal="3;4"/></ReactiveFallback>', []),
    ('<Parallel><Timeout msec="5"><SubTree ID="B"/></Timeout><SubTree ID="B" name="again"/></Parallel>', ["4:22 error parallel-drive"]),
]


@pytest.mark.parametrize(("body", "faults"), DRIVES)
def test_two_parallel_branches_that_both_drive_the_base(body: str, faults: list[str]) -> None:
    assert told(body, tree("B", '<GoTo goal="1;2"/>') if "SubTree" in body else "") == faults


WORDS = [
    ('<TopicCompare topic="ATRV2/Batery" field="voltage_v" value="1"/>', ["2:22 error unknown-word"]),
    ('<TopicCompare topic="ATRV2/Battery" field="voltage" value="1"/>', ["2:44 error unknown-word"]),
    ('<WaitFor topic="Localization/Pose" field="pose.6" value="1"/>', ["2:43 error unknown-word"]),
    ('<WaitFor topic="Localization/Pose" field="pose.5" value="1"/>', []),
    ('<WaitFor topic="motion/status" field="element.3" value="1"/>', []),
    ('<GoTo goal="1;2" timeout_s="60ms"/>', ["2:29 error wrong-unit"]),
    ('<GoTo goal="1;2" timeout_s="60s"/>', ["2:29 warning trailing-text"]),
    ('<MakeTurn angle_deg="90rad"/>', ["2:22 error wrong-unit"]),
    ('<Sleep msec="2s"/>', ["2:14 warning trailing-text"]),
]


@pytest.mark.parametrize(("body", "faults"), WORDS)
def test_words_and_units(body: str, faults: list[str]) -> None:
    assert told(body) == faults


VERSION_3 = [
    ("<SequenceStar><AlwaysSuccess/></SequenceStar>", "old-format", "version 4 has <SequenceWithMemory>"),
    ('<RetryUntilSuccesful num_attempts="3"><AlwaysSuccess/></RetryUntilSuccesful>', "old-format", "version 4 has <RetryUntilSuccessful>"),
    ('<SubTreePlus ID="B" __autoremap="1"/>', "old-format", "version 4 has <SubTree>"),
    ('<Parallel success_threshold="1"><AlwaysSuccess/></Parallel>', "unknown-port", "version 4 has success_count"),
    ('<SubTree ID="B" __shared_blackboard="true"/>', "ignored-attribute", 'version 4 has _autoremap="true"'),
]


@pytest.mark.parametrize(("body", "code", "mend"), VERSION_3)
def test_a_file_of_version_3_is_met_with_a_word(body: str, code: str, mend: str) -> None:
    text = mission(body, tree("B", OK) if "ID=" in body else "").replace('BTCPP_format="4"', 'BTCPP_format="3"')
    faults = check_mission(text)
    assert faults[0].code == "other-format" and "version 3" in faults[0].mend
    assert (code, mend) in [(fault.code, fault.mend) for fault in faults]


MODELS = """<root BTCPP_format="4"><TreeNodesModel>
  <Action ID="Grasp"><input_port name="force_n" type="double" default="5"/><input_port name="fingers" type="unsigned int"/>
    <output_port name="held" type="bool"/><input_port name="pose" type="geometry_msgs::msg::PoseStamped"/></Action>
  <Condition ID="SeesIt"/> <Decorator ID="Gently"/> <Control ID="Either"><input_port name="n" type="std::vector&lt;int&gt;"/></Control>
</TreeNodesModel></root>"""

FOREIGN = [
    ('<Grasp force_n="7.5" fingers="3" held="{h}" pose="0;map;1;2"/>', []),
    ('<Action ID="Grasp" force_n="x"/>', ["2:29 error bad-literal"]),
    ('<Grasp fingers="-1"/>', ["2:17 error bad-literal"]),
    ('<Grasp forcen="1"/>', ["2:8 error unknown-port"]),
    (f"<Grasp>{OK}</Grasp>", ["2:8 error child-count"]),
    ("<Gently><SeesIt/></Gently>", []),
    ("<Gently><SeesIt/><SeesIt/></Gently>", ["2:1 error child-count"]),
    ('<Either n="1;x"><SeesIt/></Either>', ["2:12 error bad-literal"]),
    ("<Grsp/>", ["2:1 error unknown-node"]),
    ('<Sequence><Grasp held="{h}" fingers="{f}"/><Sleep msec="{h}"/></Sequence>', ["2:38 warning unset-key", "2:57 warning type-clash"]),
]  # fmt: skip


@pytest.mark.parametrize(("body", "faults"), FOREIGN)
def test_nodes_of_other_systems_are_known_by_their_model(body: str, faults: list[str], tmp_path: Any) -> None:
    (tmp_path / "models.xml").write_text(MODELS)
    assert told(body, models=[tmp_path / "models.xml"]) == faults


def test_a_model_of_another_node_of_the_same_name_goes_before_ours_but_not_before_the_formats(tmp_path: Any) -> None:
    (tmp_path / "models.xml").write_text('''<root BTCPP_format="4"><TreeNodesModel><Action ID="GoTo"><input_port name="pose"/></Action>
      <Action ID="Say"><input_port name="text"/></Action><Action ID="Sleep"><input_port name="hours"/></Action></TreeNodesModel></root>''')
    models = [tmp_path / "models.xml"]
    assert told('<GoTo pose="a"/>', models=models) == []
    assert told('<GoTo pose="a"/>') == ["2:1 error missing-port", "2:7 error unknown-port"]
    assert told("<Say/>", models=models) == told("<Say/>") == ["2:1 error missing-port"]
    assert told('<Sleep hours="8"/>', models=models) == ["2:1 error missing-port", "2:8 error unknown-port"]


UNUSED = [
    # what it shows                            further trees                                                                  faults in line 4
    ("alone", tree("B", OK), ["1 warning unused-tree"]),
    ("used by an unused one", tree("B", '<SubTree ID="C"/>') + tree("C", OK), ["1 warning unused-tree", "54 warning unused-tree"]),
    ("names what is not there", tree("B", '<SubTree ID="Nix"/>'), ["1 warning unused-tree", "35 warning unknown-tree"]),
    ("a circle beside the main tree", tree("B", '<SubTree ID="C"/>') + tree("C", '<SubTree ID="B"/>'),
     ["1 warning unused-tree", "54 warning unused-tree", "88 warning recursion"]),
    ("a tree of the library is known", tree("B", '<SubTree ID="Escape"/>'), ["1 warning unused-tree"]),
    ("a broken node in it is an error all the same", tree("B", "<Foo/>"), ["22 error unknown-node"]),
]  # fmt: skip


@pytest.mark.parametrize(("more", "faults"), [row[1:] for row in UNUSED], ids=[row[0] for row in UNUSED])
def test_trees_that_the_main_tree_does_not_use(more: str, faults: list[str]) -> None:
    assert told(OK, more) == [f"4:{fault}" for fault in faults]


MODEL = '<TreeNodesModel><SubTree ID="S"><input_port name="place" default="1;2"/></SubTree></TreeNodesModel>'
USES = tree("S", '<Sequence><GoTo goal="{place}"/><Say text="{word}"/><Script code="n := round"/></Sequence>')


@pytest.mark.parametrize(("ports", "faults", "mend"), [
    ('plce="3;4" word="a" round="1"', ["2:17 warning unknown-port"], 'did you mean "place"?'),
    ('word="a" round="1" other="5"', ["2:36 warning unknown-port"], ""),
    ('place="3;4" word="a" round="1"', [], ""),
])  # fmt: skip
def test_a_port_of_a_subtree_that_neither_its_model_nor_anything_in_it_knows(ports: str, faults: list[str], mend: str) -> None:
    body = f'<SubTree ID="S" {ports}/>'
    assert told(body, USES + MODEL) == faults
    assert [fault.mend for fault in check_mission(mission(body, USES + MODEL))] == [mend] * len(faults)
    assert not [one for one in told(body, USES) if "unknown-port" in one], "without a model any port may be meant"


@pytest.mark.parametrize(("cases", "columns"), [
    ('case_1="1" case_2="1"', [64]), ('case_1="1" case_2="2"', []), ('case_1="a" case_2="{b}"', []), ('case_2="x" case_1="x"', [53]),
    ('case_1="1" case_2="1.0"', [64]),
])  # fmt: skip
def test_a_case_that_an_earlier_one_always_takes(cases: str, columns: list[int]) -> None:
    body = f"<Sequence><Script code=\"b := 'v'\"/><Switch2 {cases} variable=\"{{b}}\">{OK * 3}</Switch2></Sequence>"
    assert [one for one in told(body) if "unset-key" not in one] == [f"2:{column} warning unreachable" for column in columns]


def test_where_the_main_tree_is_not_said_each_that_may_be_it_is_looked_at() -> None:
    trees = tree("a.b", OK), tree("M", '<Sequence><Say text="{zz}"/><SubTree ID="M"/></Sequence>'), tree("N", '<SubTree ID="C"/>')
    text = '<root BTCPP_format="4">' + "\n".join([*trees, tree("C", '<GoTo goal="{=}" tolerance_m="{=}"/><Foo/>')]) + "</root>"
    faults = check_mission(text, topics=TopicGlobals())
    assert [f"{one.line} {one.severity} {one.code}" for one in faults] == [
        "1 error no-main-tree", "1 error bad-id", "2 warning unset-key", "2 error recursion", "4 error child-count",
        "4 warning unset-key", "4 warning unset-key", "4 error unknown-node"]  # fmt: skip
    assert faults[0].mend == 'add main_tree_to_execute="M" to <root>, or give --tree'


def test_all_faults_are_told_though_an_included_file_is_missing() -> None:
    """What may be in that file is not called unknown; all else is."""
    text = ('''<root BTCPP_format="4" main_tree_to_execute="A"><include path="nowhere.xml"/><BehaviorTree ID="A"><Sequence>
<SubTree ID="FromThere"/><Foo/><Sleep msec="{t}"/><Sleep msec="x"/><Parallel success_count="2"><AlwaysSuccess/></Parallel>
</Sequence></BehaviorTree></root>''')
    assert [fault.code for fault in check_mission(text)] == ["no-file", "unknown-node", "unset-key", "bad-literal", "threshold"]
    assert check_mission(text.replace('execute="A"', 'execute="FromThere"'))[0].code == "no-file"


@pytest.mark.parametrize(("always", "faults"), [
    ("@Localization_Pose_x &lt; 30 &amp;&amp; n &lt; 3", []),
    ("@Localization_Pose_q &lt; 30", ["4:28 error unknown-topic"]),
    ("m &lt; 30", ["4:28 error unset-key"]),
])  # fmt: skip
def test_what_a_contract_looks_at_should_be_there_some_time(always: str, faults: list[str]) -> None:
    assert told('<Script code="n := 1"/>', f'<Contract name="c" always="{always}"/>') == faults


MAIN_INPUTS = """<root BTCPP_format="4" main_tree_to_execute="M"><BehaviorTree ID="M"><GoTo goal="{place}"/></BehaviorTree>
<TreeNodesModel><SubTree ID="M"><input_port name="place" type="point"/>
<input_port name="goals" type="points" default=""/></SubTree></TreeNodesModel></root>"""


@pytest.mark.parametrize(("ports", "code", "words"), [
    ({"plcae": "4;2"}, "unknown-input", 'did you mean "place"'),
    ({"place": "4;x"}, "bad-input", "x;y"),
    ({"place": "1e12;3"}, "bad-input", "beyond 1e+06 m"),
    ({"place": "4;2", "goals": ""}, "bad-input", "no element"),
    ({"place": "4;2", "goals": "1,2;1e7,2"}, "bad-input", "beyond 1e+06 m"),
])  # fmt: skip
def test_one_slip_in_an_input_is_one_fault(ports: dict[str, str], code: str, words: str) -> None:
    (fault,) = check_mission(MAIN_INPUTS, ports=ports)
    assert fault.code == code and fault.file.startswith("--port") and words in f"{fault.expected} {fault.mend}"
    assert not fault.mend.startswith("expected")
    assert check_mission(MAIN_INPUTS, ports={"place": "4;2"}) == ()


@pytest.mark.parametrize("leaf", ['<GoTo goal="{}"/>', '<NavigateTo goal="{}"/>', '<NavigateTo goal="0;map;{};0;0;0;0;1"/>'])
def test_no_goal_lies_beyond_what_a_world_can_be(leaf: str) -> None:
    assert told(leaf.format("999999;-3")) == []
    (fault,) = told(leaf.format("1e12;-3"))
    assert fault.startswith("2:") and " error " in fault


@pytest.mark.parametrize(("text", "faults"), [
    ("n is {n}", ["2:17 warning braces-in-text"]),
    ("json:{}", []),
    ("a {} b", []),
])  # fmt: skip
def test_an_entry_inside_a_text_is_no_entry(text: str, faults: list[str]) -> None:
    assert told(f'<Say text="{text}"/>') == faults
