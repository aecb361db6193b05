"""The monitor's protocol by its bytes, tick by tick, without sockets and without a robot."""

from __future__ import annotations

from xml.etree import ElementTree

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.groot.protocol import REQUEST, Desk
from pluto_bt.groot.snapshot import KEPT_CHANGES, STATUS, Shown
from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import Mission, load_mission

TEXT = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main"><Sequence>
    <Script code="n := 2; words := 'a &amp; b'; place := 1.5"/>
    <SubTree ID="Part" name="one" who="{words}" far="3;4"/>
    <SubTree ID="Part" who="two"/>
    <AlwaysSuccess name="last" _skipIf="n == 2"/>
  </Sequence></BehaviorTree>
  <BehaviorTree ID="Part"><Sequence name="part">
    <Sleep name="rest" msec="100"/><SubTree ID="Inner" name="deep"/><Inverter><AlwaysFailure name="no"/></Inverter>
  </Sequence></BehaviorTree>
  <BehaviorTree ID="Inner"><AlwaysSuccess name="quick"/></BehaviorTree>
</root>"""
ID = bytes(range(16))


class Rig:
    """A mission that is ticked by hand, and a desk that shows it."""

    def __init__(self, text: str = TEXT) -> None:
        self.clock = VirtualClock()
        self.mission: Mission = load_mission(text, clock=self.clock)
        self.shown = Shown(self.mission, ID)
        self.desk = Desk(self.clock.now_ns, lambda: 1_700_000_000_000_000)
        self.desk.shown = self.shown

    def tick(self, advance_s: float = 0.0) -> str:
        self.clock.advance(advance_s)
        status = self.mission.tick_once()
        self.shown.after_tick(self.clock.now_ns())
        return status

    def ask(self, kind: bytes, *more: bytes) -> list[bytes]:
        return self.desk.answer([REQUEST.pack(2, kind, 7), *more])

    def statuses(self) -> dict[str, int]:
        names = {one.plan.uid: one.path for one in self.mission.nodes()}
        return {names[uid]: code for uid, code in STATUS.iter_unpack(self.ask(b"S")[1])}

    def changes(self) -> list[tuple[int, str, int]]:
        names, data = {one.plan.uid: one.path for one in self.mission.nodes()}, self.ask(b"t")[1]
        rows = [data[i : i + 9] for i in range(0, len(data), 9)]
        return [(int.from_bytes(row[:6], "little"), names[STATUS.unpack(row[6:])[0]], STATUS.unpack(row[6:])[1]) for row in rows]


ANY_RIG = Rig()


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_reply_repeats_the_head_and_names_the_tree(rig: Rig) -> None:
    reply = rig.desk.answer([b"\x09S\x01\x02\x03\x04"])
    assert reply[0] == b"\x02S\x01\x02\x03\x04" + ID, "the protocol byte of the request is not looked at"
    assert rig.ask(b"A") == rig.ask(b"A") and len(rig.ask(b"X")) == 1, "no payload, no second part"


@pytest.mark.parametrize(
    ("parts", "text"),
    [([], "wrong request header"), ([b""], "wrong request header"), ([b"\x02S\x00\x00\x00"], "wrong request header"),
     ([b"\x02S\x00\x00\x00\x00\x00"], "wrong request header"), ([b"\x02?\x00\x00\x00\x00"], "Request not recognized"),
     ([b"\x02B\x00\x00\x00\x00"], "must be 2 parts message"), ([b"\x02r\x00\x00\x00\x00"], "must be 2 parts message"),
     ([b"\x02I\x00\x00\x00\x00"], "must be 2 parts message"), ([b"\x02R\x00\x00\x00\x00", b"{}"], "Node ID not found"),
     ([b"\x02U\x00\x00\x00\x00", b"{}"], "Node ID not found"), ([b"\x02r\x00\x00\x00\x00", b"go"], "expected start or stop"),
     ([b"\x02I\x00\x00\x00\x00", b"{}"], "break-points are not served: this monitor only looks on")],
)  # fmt: skip
def test_an_error_is_two_parts_of_text(rig: Rig, parts: list[bytes], text: str) -> None:
    assert rig.desk.answer(parts) == [b"error", text.encode()]


@given(st.lists(st.one_of(st.binary(max_size=12), st.builds(lambda kind, tail: b"\x02" + kind + tail, st.binary(min_size=1, max_size=1),
                                                            st.binary(min_size=4, max_size=4))), max_size=3))  # fmt: skip
def test_whatever_is_sent_gets_an_answer(parts: list[bytes]) -> None:
    reply = ANY_RIG.desk.answer(parts)
    assert reply and all(isinstance(part, bytes) for part in reply)
    assert reply[0] == b"error" or len(reply[0]) == 22


def test_before_there_is_a_tree_it_says_so() -> None:
    desk = Desk(lambda: 0, lambda: 0)
    assert desk.answer([REQUEST.pack(2, b"T", 1)]) == [b"error", b"there is no tree yet"]
    assert desk.answer([REQUEST.pack(2, b"D", 1)]) == [REQUEST.pack(2, b"D", 1) + bytes(16), b"[]"]


def test_the_order_is_by_instance_and_depth_first_inside(rig: Rig) -> None:
    assert list(rig.statuses()) == [
        "Sequence::1", "Script::2", "one", "Part::10", "last",
        "one/part", "one/rest", "one/deep", "one/Inverter::8", "one/no", "one/deep/quick",
        "Part::10/part", "Part::10/rest", "Part::10/deep", "Part::10/Inverter::15", "Part::10/no", "Part::10/deep/quick",
    ]  # fmt: skip


def test_statuses_tell_what_a_node_was_before_it_became_idle(rig: Rig) -> None:
    assert set(rig.statuses().values()) == {0}
    assert rig.tick() == "RUNNING"  # [S R [R [R..]]]
    first = rig.statuses()
    assert (first["Sequence::1"], first["Script::2"], first["one"], first["one/rest"], first["one/no"]) == (1, 2, 1, 1, 0)
    assert rig.tick(0.1) == "RUNNING"
    second = rig.statuses()
    assert (second["one"], second["one/rest"], second["one/deep/quick"], second["one/no"]) == (2, 12, 12, 13)
    rig.mission.halt()
    rig.shown.after_tick(0)
    third = rig.statuses()
    assert (third["Sequence::1"], third["Part::10/rest"], third["one"], third["last"]) == (11, 11, 12, 0)


def test_a_skipped_node_stays_idle(rig: Rig) -> None:
    for _ in range(3):
        status = rig.tick(0.1)
    assert status == "SUCCESS" and rig.statuses()["last"] == 0


def test_recorded_changes_tell_also_what_one_tick_began_and_ended(rig: Rig) -> None:
    assert rig.changes() == [], "nobody records"
    assert rig.ask(b"r", b"start")[1] == b"1700000000000000"
    rig.tick(0.25)
    assert (250_000, "one/rest", 1) in rig.changes()
    rig.tick(0.1)
    told = rig.changes()
    assert [(at, code) for at, path, code in told if path == "one/no"] == [(350_000, 3), (350_000, 0)]
    assert [(at, code) for at, path, code in told if path == "one/rest"] == [(350_000, 2), (350_000, 0)]
    assert rig.changes() == [], "they are told once"
    assert len(rig.ask(b"r", b"stop")) == 1
    rig.tick(0.1)
    assert rig.changes() == []


def test_no_more_than_the_last_thousand_changes_are_kept() -> None:
    leaves = "".join(f'<AlwaysSuccess name="a{i}"/>' for i in range(400))
    rig = Rig(f'<root BTCPP_format="4"><BehaviorTree ID="T"><AsyncSequence>{leaves}</AsyncSequence></BehaviorTree></root>')
    rig.ask(b"r", b"start")
    for _ in range(3):
        while rig.mission.tick_exactly_once() == "RUNNING":
            rig.shown.after_tick(0)
        rig.shown.after_tick(0)
    assert len(rig.changes()) == KEPT_CHANGES


def boards(rig: Rig, names: str) -> object:
    return msgspec.msgpack.decode(rig.ask(b"B", names.encode())[1])


def test_blackboards_are_told_by_instance(rig: Rig) -> None:
    main = {"n": 2, "words": "a & b", "place": 1.5}
    rig.tick()
    assert boards(rig, "Main") == {"Main": main}
    assert boards(rig, "one;nobody") == {"one": {"far": "3;4"}, "ROOT": main}, "with the root above it; unknown names are left out"
    assert boards(rig, "Part::10;Main") == {"Part::10": {"who": "two"}, "Main": main, "ROOT": main}
    assert boards(rig, "one/deep") == {"one/deep": None, "ROOT": main}, "an empty one is nil"
    assert boards(rig, "") == {}


def test_the_tree_has_every_instance_number_port_and_model(rig: Rig) -> None:
    root = ElementTree.fromstring(rig.ask(b"T")[1])
    trees = {tree.get("_fullpath"): tree for tree in root.findall("BehaviorTree")}
    assert [(tree.get("ID"), path) for path, tree in trees.items()] == [
        ("Main", ""), ("Part", "one"), ("Inner", "one/deep"), ("Part", "Part::10"), ("Inner", "Part::10/deep"),
    ]  # fmt: skip
    subtree = trees[""].find(".//SubTree")
    assert subtree is not None and subtree.attrib == {"ID": "Part", "_fullpath": "one", "_uid": "3", "who": "{words}", "far": "3;4"}
    last = trees[""].find(".//AlwaysSuccess")
    assert last is not None and last.attrib == {"name": "last", "_uid": "17", "_skipIf": "n == 2"}
    numbers = [int(node.get("_uid", "0")) for tree in trees.values() for node in tree.iter() if node.get("_uid")]
    assert sorted(numbers) == list(range(1, 18)) and list(dict(STATUS.iter_unpack(rig.ask(b"S")[1]))) != sorted(numbers)
    models = {(model.tag, model.get("ID")) for model in root.find("TreeNodesModel") or ()}
    assert {("Control", "Sequence"), ("Action", "GoTo"), ("Decorator", "Inverter"), ("Action", "Sleep")} <= models


def test_defaults_are_written_out() -> None:
    rig = Rig('<root BTCPP_format="4"><BehaviorTree ID="T"><GoTo goal="1;2"/></BehaviorTree></root>')
    goto = ElementTree.fromstring(rig.ask(b"T")[1]).find(".//GoTo")
    assert goto is not None and goto.get("tolerance_m") == "0.3" and goto.get("goal") == "1;2" and goto.get("avoid") == "both"


def test_a_value_that_is_no_number_or_text_is_told_as_a_mission_would_write_it() -> None:
    rig = Rig('<root BTCPP_format="4"><BehaviorTree ID="T"><Script code="x := 1"/></BehaviorTree></root>')
    rig.mission.blackboard["place"], rig.mission.blackboard["huge"] = (1.0, 2.5), 2**70
    assert boards(rig, "T") == {"T": {"place": "1.0;2.5", "huge": str(2**70)}}
