"""The life of a py_trees leaf in a mission: DESIGN.md, section 6."""

from __future__ import annotations

import re
from typing import Any, ClassVar

import py_trees
import pytest
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, NoDataAvailable, PortInformation

from pluto_bt.behaviours.ports import Port
from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import MissionError, TickError, load_mission


def mission_of(body: str, *nodes: Any, **kwargs: Any) -> Any:
    """A mission of one tree."""
    return load_mission(f'<root BTCPP_format="4"><BehaviorTree ID="Main">\n{body}\n</BehaviorTree></root>', nodes=nodes, file="m.xml", **kwargs)


class Diary(BehaviourWithPorts, tag="DiaryLeaf"):
    """Writes down everything that is done to it."""

    INPUT_PORTS: ClassVar = {"answers": PortInformation(data_type=str)}
    OUTPUT_PORTS: ClassVar = {"out": PortInformation(data_type=int, required=False)}
    pages: ClassVar[list[str]] = []

    def __init__(self, name: str) -> None:
        super().__init__(name=name)
        self.pages.append(f"init {name}")

    def setup(self, **kwargs: Any) -> None:
        self.pages.append(f"setup {sorted(kwargs)} {self.get_input('answers')}")
        self.answers = iter(self.get_input("answers"))

    def initialise(self) -> None:
        self.pages.append("initialise")

    def update(self) -> Status:
        letter = next(self.answers)
        self.pages.append(f"update {letter}")
        return {"R": Status.RUNNING, "S": Status.SUCCESS, "F": Status.FAILURE, "K": Status.INVALID}[letter]

    def terminate(self, new_status: Status) -> None:
        self.pages.append(f"terminate {self.status.name}→{new_status.name} {self.get_input('answers')}")


@pytest.fixture
def pages() -> list[str]:
    Diary.pages.clear()
    return Diary.pages


def test_a_leaf_is_built_with_its_name_set_up_begun_updated_and_ended(pages: list[str]) -> None:
    mission = mission_of('<DiaryLeaf name="d" answers="RSS"/>', Diary, clock=VirtualClock())
    assert pages == ["init d", "setup ['blackboard', 'clock'] RSS"]
    pages.clear()
    assert [mission.tick_once() for _ in range(3)] == ["RUNNING", "SUCCESS", "SUCCESS"]
    assert pages == [
        "initialise", "update R", "update S", "terminate RUNNING→SUCCESS RSS",
        "initialise", "update S", "terminate INVALID→SUCCESS RSS",
    ]  # fmt: skip


def test_without_a_name_it_has_that_of_its_type(pages: list[str]) -> None:
    mission_of('<DiaryLeaf answers="S"/>', Diary)
    assert pages[0] == "init DiaryLeaf"


def test_only_a_running_leaf_is_terminated_by_a_halt(pages: list[str]) -> None:
    mission = mission_of('<Sequence><DiaryLeaf name="one" answers="SR"/><DiaryLeaf name="two" answers="R"/></Sequence>', Diary)
    mission.tick_once()
    pages.clear()
    mission.halt()
    assert pages == ["terminate RUNNING→INVALID R"]
    mission.halt()
    assert len(pages) == 1


def test_invalid_means_skipped_and_ends_nothing(pages: list[str]) -> None:
    mission = mission_of('<DiaryLeaf answers="KK"/>', Diary)
    pages.clear()
    assert [mission.tick_once(), mission.tick_once()] == ["SKIPPED", "SKIPPED"]
    assert pages == ["initialise", "update K", "initialise", "update K"]
    assert mission.statuses() == {"DiaryLeaf::1": "SKIPPED"}


class Broken(BehaviourWithPorts, tag="Broken"):
    """Breaks its promise in the way that its port says."""

    INPUT_PORTS: ClassVar = {"how": PortInformation(data_type=str)}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def update(self) -> Any:
        if self.get_input("how") == "raise":
            raise RuntimeError("no more")
        return {"none": None, "word": "SUCCESS", "skip": Status.INVALID}.get(self.get_input("how"))


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("raise", "RuntimeError: no more (test_leaf_life.py:98)"),
        ("none", "update() returned None, which is no status"),
        ("word", "update() returned 'SUCCESS', which is no status"),
    ],
)
def test_a_broken_leaf_halts_the_tree_and_is_named(pages: list[str], how: str, reason: str) -> None:
    mission = mission_of(f'<Parallel>\n<DiaryLeaf answers="RR"/><Sequence><Broken name="b" how="{how}"/></Sequence></Parallel>', Diary, Broken)
    with pytest.raises(TickError) as caught:
        mission.tick_once()
    error = caught.value
    assert (error.path, error.type, error.file, error.line, error.reason) == ("b", "Broken", "m.xml", 3, reason)
    assert not isinstance(error, MissionError)
    assert str(error) == f"node 'b' (Broken) at m.xml:3: {reason}"
    assert pages[-1] == "terminate RUNNING→INVALID RR"
    assert {node.status for node in mission.root.iterate()} == {Status.INVALID}


class Ports(BehaviourWithPorts, tag="Ports"):
    """Shows what its ports give."""

    INPUT_PORTS: ClassVar = {
        "number": Port(float, required=False, unit="m", ge=0.0, le=10.0),
        "goal": Port(tuple[float, float], required=False),
        "goals": Port(list[tuple[float, float]], required=False),
        "pose": Port(tuple[float, float, float], required=False),
        "side": Port(str, required=False, choices=("left", "right")),
        "flag": Port(bool, required=False, default_value=True),
        "numbers": Port(list[int], required=False),
    }
    OUTPUT_PORTS: ClassVar = {"reason": Port(str, required=False), "length": Port(float, required=False)}
    INOUT_PORTS: ClassVar = {"visits": Port(int, required=False)}

    def update(self) -> Status:
        self.seen = {}
        for name in (*self.INPUT_PORTS, "visits"):
            try:
                self.seen[name] = self.get_input(name)
            except NoDataAvailable:
                continue
        self._set_output("reason", "no-path")
        self._set_output("length", 3)
        self._set_output("visits", self.seen.get("visits", 0) + 1)
        return Status.FAILURE


LITERALS = [
    # attribute                          value that the leaf gets
    ('number="2.5"', {"number": 2.5}),
    ('number="3"', {"number": 3.0}),
    ('goal="1;2"', {"goal": (1.0, 2.0)}),
    ('goal="1.5,-2"', {"goal": (1.5, -2.0)}),
    ('goals="1,2;3,4"', {"goals": [(1.0, 2.0), (3.0, 4.0)]}),
    ('pose="1;2;90"', {"pose": (1.0, 2.0, 90.0)}),
    ('side="left"', {"side": "left"}),
    ('flag="0"', {"flag": False}),
    ('numbers="1;2;3;"', {"numbers": [1, 2, 3]}),
]


@pytest.mark.parametrize(("attribute", "seen"), LITERALS)
def test_a_literal_is_read_as_the_port_says(attribute: str, seen: dict[str, Any]) -> None:
    mission = mission_of(f"<Ports {attribute}/>", Ports)
    mission.tick_once()
    assert mission.root.seen == {"flag": True} | seen


ENTRIES = [
    # value of the entry                 port       value that the leaf gets
    ("2.5", "number", 2.5),
    ("1;2", "goal", (1.0, 2.0)),
    ((1, 2), "goal", (1.0, 2.0)),
    ([(1, 2), (3, 4)], "goals", [(1.0, 2.0), (3.0, 4.0)]),
    ("1,2;3,4", "goals", [(1.0, 2.0), (3.0, 4.0)]),
    ("true", "flag", True),
    ([1, 2], "numbers", [1, 2]),
    (7, "visits", 7),
]


@pytest.mark.parametrize(("value", "port", "seen"), ENTRIES)
def test_an_entry_is_converted_to_what_the_port_says(value: Any, port: str, seen: Any) -> None:
    mission = mission_of(f'<Ports {port}="{{x}}"/>', Ports, blackboard={"x": value})
    mission.tick_once()
    assert mission.root.seen[port] == seen


def test_outputs_reach_their_entries_and_the_deciding_reason() -> None:
    mission = mission_of('<Fallback><Ports name="p" reason="{why}" length="{=}" visits="{n}"/></Fallback>', Ports, blackboard={"n": 4})
    assert mission.tick_once() == "FAILURE"
    assert dict(mission.blackboard) == {"n": 5, "why": "no-path", "length": 3.0}
    assert mission.deciding_reason() == "no-path"
    assert mission.root.children[0].get_last_output("reason") == "no-path"


def test_an_entry_out_of_range_is_an_error_of_the_tick() -> None:
    mission = mission_of('<Ports number="{x}"/>', Ports, blackboard={"x": "11"})
    with pytest.raises(TickError, match="outside what port 'number' allows: 11 is above 10"):
        mission.tick_once()


def test_py_trees_shows_and_visits_a_mission() -> None:
    mission = mission_of('<Sequence name="top"><AlwaysSuccess name="a"/><Ports name="p"/><AlwaysSuccess name="never"/></Sequence>', Ports)
    visited = [(node.name, node.status) for node in mission.root.tick()]
    assert [name for name, _ in visited] == ["a", "p", "top"]
    shown = py_trees.display.unicode_tree(mission.root, show_status=True)
    assert [line.split()[1] for line in shown.splitlines() if line] == ["top", "a", "p", "never"]
    visitor = py_trees.visitors.SnapshotVisitor()
    tree = py_trees.trees.BehaviourTree(mission.root)
    tree.visitors.append(visitor)
    tree.tick()
    assert len(visitor.visited) == 3
    assert py_trees.display.xhtml_tree(mission.root)
    assert py_trees.display.dot_tree(mission.root).to_string()


class OwnTick(BehaviourWithPorts, tag="OwnTick"):
    """A foreign leaf that overrides `tick` itself."""

    INPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def update(self) -> Status:
        raise AssertionError("its own tick does not call it")

    def tick(self) -> Any:
        self.status = Status.SUCCESS if self.status is Status.RUNNING else Status.RUNNING
        yield self


def test_a_leaf_that_overrides_tick_is_ticked_by_it() -> None:
    mission = mission_of("<Sequence><OwnTick/></Sequence>", OwnTick)
    assert [mission.tick_once(), mission.tick_once()] == ["RUNNING", "SUCCESS"]


def test_node_states_tell_since_when() -> None:
    clock = VirtualClock()
    mission = mission_of('<Sequence name="s"><Sleep name="z" msec="500"/><AlwaysSuccess name="a"/></Sequence>', clock=clock)
    clock.advance(1.0)
    mission.tick_once()
    first = mission.node_states()
    clock.advance(0.2)
    mission.tick_once()
    assert mission.node_states() == first
    facts = [(state.path, state.depth, state.status, state.since_s) for state in first]
    assert facts == [("s", 1, "RUNNING", 1.0), ("z", 2, "RUNNING", 1.0), ("a", 2, "IDLE", 0.0)]
    assert mission.active_leaf() == "z"


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("<Sequence><AlwaysSuccess/><AlwaysFailure name='here'/></Sequence>", "here"),
        ("<Fallback><AlwaysFailure name='first'/><AlwaysFailure name='second'/></Fallback>", "second"),
        ("<Sequence><Inverter><AlwaysSuccess name='too good'/></Inverter></Sequence>", "too good"),
        ("<Sequence><AlwaysSuccess name='x' _failureIf='true'/></Sequence>", "x"),
        ("<AlwaysSuccess/>", ""),
        ("<RecoveryNode name='r'><AlwaysFailure name='work'/><AlwaysFailure name='cure'/></RecoveryNode>", "work"),
        ("<RecoveryNode><PipelineSequence><AlwaysFailure name='deep'/></PipelineSequence>"
         "<RoundRobin name='cures'><AlwaysSuccess/></RoundRobin></RecoveryNode>", "deep"),
        ("<RoundRobin name='past its end'><AlwaysSuccess/></RoundRobin>", "failed"),
    ],
)  # fmt: skip
def test_the_node_that_decided_a_failure_is_named(body: str, reason: str) -> None:
    mission = mission_of(body)
    mission.tick_once()
    assert mission.deciding_reason() == reason


def test_a_leaf_without_a_port_for_its_reason_gives_it_all_the_same() -> None:
    mission = mission_of('<RecoveryNode><ComputePathToPose goal="1;2" path="{p}"/><AlwaysFailure name="no cure"/></RecoveryNode>')
    mission.tick_once()
    assert mission.deciding_reason() == "not-connected"


def test_a_timeout_is_the_reason_of_its_failure() -> None:
    clock = VirtualClock()
    mission = mission_of('<Sequence><Timeout msec="100"><Sleep msec="1000"/></Timeout></Sequence>', clock=clock)
    mission.tick_once()
    clock.advance(0.1)
    assert (mission.tick_once(), mission.deciding_reason()) == ("FAILURE", "timeout")


def test_an_error_in_a_halt_hook_between_ticks_is_told_at_the_next_tick() -> None:
    class Clumsy(BehaviourWithPorts, tag="Clumsy"):
        INPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}
        OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

        def update(self) -> Status:
            return Status.RUNNING

        def terminate(self, new_status: Status) -> None:
            raise ValueError("dropped it")

    clock = VirtualClock()
    mission = mission_of('<Timeout msec="100"><Clumsy/></Timeout>', Clumsy, clock=clock)
    mission.tick_once()
    clock.advance(1.0)
    with pytest.raises(TickError, match=r"node 'Clumsy::2' \(Clumsy\) at m.xml:2: ValueError: dropped it"):
        mission.tick_once()


@pytest.mark.parametrize("where", ["__init__", "setup"])
def test_a_leaf_that_cannot_be_made_is_a_fault_of_the_mission(where: str) -> None:
    def explode(self: Any, *args: Any, **kwargs: Any) -> None:
        raise OSError("no such device")

    members = {"INPUT_PORTS": {}, "OUTPUT_PORTS": {}, "update": lambda self: Status.SUCCESS, where: explode}
    fragile = type("Fragile", (BehaviourWithPorts,), members, register=False)
    with pytest.raises(MissionError) as caught:
        mission_of("<Fragile/>", fragile)
    fault = caught.value.faults[0]
    assert (fault.line, fault.column) == (2, 1)
    assert re.search(r"OSError: no such device \(test_leaf_life.py:\d+\)$", fault.message)


def test_values_of_one_leaf_do_not_leak_into_another() -> None:
    """Mutable literals and defaults are copied for each reader."""

    class Appends(BehaviourWithPorts, tag="Appends"):
        INPUT_PORTS: ClassVar = {"a": Port(list[int], required=False), "b": Port(list[int], required=False, default_value=[])}
        OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

        def update(self) -> Status:
            for port in ("a", "b"):
                self.get_input(port).append(9)
            self.seen = [self.get_input("a"), self.get_input("b")]
            return Status.SUCCESS

    mission = mission_of('<Sequence><Appends a="1;2"/><Appends a="1;2"/></Sequence>', Appends)
    mission.tick_once()
    assert [leaf.seen for leaf in mission.root.children] == [[[1, 2], []]] * 2


def test_a_tick_that_would_never_end_is_an_error() -> None:
    mission = mission_of('<Repeat num_cycles="-1"><AlwaysSuccess/></Repeat>')
    with pytest.raises(TickError, match="a tick does not end"):
        mission.tick_once()


class NeedsAGoal(BehaviourWithPorts):
    """Reads its port and is done."""

    INPUT_PORTS: ClassVar = {"goal": Port(tuple[float, float])}
    OUTPUT_PORTS: ClassVar = {}

    def update(self) -> Status:
        self.get_input("goal")
        return Status.SUCCESS


@pytest.mark.parametrize(
    ("ports", "text"),
    [
        ('goal="{place}"', "port 'goal': 'door' is no point: expected x;y"),
        ('goal="{nothing}"', 'port "goal" of "out" has no value: entry '),
    ],
)
def test_a_port_that_cannot_be_read_is_told_without_words_of_python(ports: str, text: str) -> None:
    text_of_mission = f'<root BTCPP_format="4"><BehaviorTree ID="A"><NeedsAGoal name="out" {ports}/></BehaviorTree></root>'
    mission = load_mission(text_of_mission, nodes=[NeedsAGoal], clock=VirtualClock(), blackboard={"place": "door"})
    with pytest.raises(TickError) as caught:
        mission.tick_once()
    assert caught.value.reason.startswith(text) and ".py:" not in caught.value.reason


def test_an_input_without_value_fails_a_leaf_of_the_library_and_is_an_error_of_anybody_elses() -> None:
    class Theirs(BehaviourWithPorts, tag="Theirs"):
        INPUT_PORTS: ClassVar = {"text": Port(str, required=True)}
        OUTPUT_PORTS: ClassVar = {}

        def update(self) -> Status:
            return Status.SUCCESS if self.get_input("text") else Status.FAILURE

    say, theirs = (mission_of(f'<{node} name="n" text="{{word}}"/>', Theirs) for node in ("Say", "Theirs"))
    assert say.tick_once() == "FAILURE" and say.root.feedback_message.startswith('no-input: port "text" of "n" has no value')
    with pytest.raises(TickError, match=r'port "text" of "n" has no value: .* write it on every way'):
        theirs.tick_once()
