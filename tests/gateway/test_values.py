"""Every message and every reply as XML: the contract's children, and the schema over all of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_type_hints
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from pluto_bt import gateway
from pluto_bt.blackboard import messages as m
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.gateway import replies, wire
from pluto_bt.gateway.describe import describe, described
from pluto_bt.gateway.encode import encode
from pluto_bt.gateway.read_values import message_of
from pluto_bt.gateway.requests import Describe
from pluto_bt.gateway.values import body_of, fields_of, value_line
from pluto_bt.modules.catalogue import catalogue

SCHEMA = etree.XMLSchema(etree.parse(str(Path(gateway.__file__).with_name("protocol.xsd"))))
NASTY = "a <b> & \"c\" 'd'\n\t\x00\x1b\ud800é\U0001f916"


def read(line: bytes) -> Any:
    assert line.endswith(b"\n") and line.count(b"\n") == 1
    element = etree.fromstring(line)
    SCHEMA.assertValid(element)
    return element


def children(value: m.Message) -> list[tuple[str, str | None]]:
    return [(child.tag, child.text) for child in read(value_line("t", 1, value.stamp_s, 0.0, body_of(value)))]


def test_values_have_the_children_of_the_contract() -> None:
    command = m.ActuatorState(1.0, 32, (3.0, 4.5), (0.5, 0.0), (0.1, 0.2), (1.0,))
    expected = [("flags", "32"), ("position", "3.0 4.5"), ("velocity", "0.5 0.0"), ("acceleration", "0.1 0.2"), ("force", "1.0")]
    assert children(command) == expected
    assert [tag for tag, _ in children(m.Pose(1.0))] == ["pose", "covariance", "setter"]
    assert len((children(m.LaserPose(1.0))[0][1] or "").split()) == 8
    scan = m.LaserScan(1.0, -1.5, 0.5, m.read_only([1.25, -1.0, np.inf]), 3)
    assert children(scan) == [("angle_min", "-1.5"), ("angle_step", "0.5"), ("ranges", "1.25 -1.0 INF")]
    assert children(m.BatteryState(1.0, 12.5)) == [("voltage_v", "12.5")]
    assert children(m.BumperState(1.0, True, False)) == [("front", "true"), ("back", "false")]


def test_a_link_status_says_its_codes_by_name() -> None:
    status = m.FVectorState(1.0, (0.2, 0.0), (0, -1, -2, 11), "", "")
    line = value_line("motion/status", 812, 41.2, 0.031, body_of(status))
    assert line == (
        b'<value topic="motion/status" seq="812" stamp="41.200000" age="0.031" dropped="0"><data>0.2 0.0</data><element>0 -1 -2 11</element>'
        b'<status element="0" code="0" name="normal"/><status element="1" code="-1" name="running"/>'
        b'<status element="2" code="-2" name="near-goal"/><status element="3" code="11" name="approaching-object"/></value>\n'
    )


@pytest.mark.parametrize("topic", TOPICS, ids=lambda topic: topic.name)
def test_every_topic_crosses_the_wire_and_validates(topic: Any) -> None:
    needed = {"ranges_m": m.read_only([1.0, 2.5])} if topic.type is m.LaserScan else {}
    value = topic.type(stamp_s=1.5, **needed, **({"angle_min_rad": 0.0, "angle_step_rad": 0.1} if needed else {}))
    assert wire.unpack_value(topic.name, wire.pack_value(value)) == value
    tags = {tag for tag, _ in children(value)} - {"status"}
    described = {field["name"] for field in fields_of(topic.type)}
    assert tags <= described and set(get_type_hints(topic.type)) >= {"stamp_s"}


FILLED: list[m.Message] = [
    m.ActuatorState(1.5, 32, (3.0, -4.5), (0.5, 0.0), (0.1, 0.2), (1.0, 2.0)),
    m.FVectorState(1.5, (0.2, 1e-9, 3.0), (0, -1, -2, 11), "stuck", "a <b> & c"),
    m.LaserPose(1.5, (1.0, 2.0, 0.25, -3.0, 0.1, 0.2, 0.3, -0.4), tuple(map(float, range(9))), 2),
    m.LaserScan(1.5, -1.5, 0.5, m.read_only([1.25, -1.0, np.inf]), 3),
    m.ImuState(1.5, 1.0, bias_known=True, turn_rates_radps=(0.1, 0.2, 0.3)),
    m.LocalMapState(1.5, 1.0, 2.0, 0.25, 2, 3, bytes([0, 1, 2, 3, 60, 38]), 0.5),
    m.TreeState(1.5, 7, (m.NodeState("a/b", "GoTo", "b", 2, "RUNNING", "2 m left", 1.25), m.NodeState("c", "Say", "c", 2, "IDLE", "", 0.0))),
    m.ModulesState(1.5, (m.ModuleState("base", "io", "running", 5, 1, 0, 0.25, "back again"),)),
    m.WorldState(1.5, (1.0, 2.0, 3.0), (0.5, 0.1), 0.25, 1, 2),
]


@pytest.mark.parametrize("value", FILLED, ids=lambda value: type(value).__name__)
def test_a_message_is_read_back_as_it_was(value: m.Message) -> None:
    line = value_line("t", 1, value.stamp_s, 0.0, body_of(value))
    assert message_of(type(value), ElementTree.fromstring(line)) == value
    empty = ElementTree.fromstring(value_line("t", 1, value.stamp_s, 0.0, ""))
    if not isinstance(value, m.LaserScan):
        assert message_of(type(value), empty) == type(value)(stamp_s=1.5)


@pytest.mark.parametrize("broken", ["<value><voltage_v>much</voltage_v></value>", '<value stamp="now"/>'])
def test_a_value_that_is_none_is_refused(broken: str) -> None:
    with pytest.raises(ValueError):
        message_of(m.BatteryState, ElementTree.fromstring(broken))


EVERY_REPLY: list[replies.AnyReply] = [
    replies.Hello(id=NASTY, robot=NASTY, session="s", time_s=1.0, capabilities=("get",)),
    replies.Pong(t=NASTY, time_s=0.0),
    replies.Ok(id="1", text=NASTY),
    *[replies.Error(code=code, text=NASTY, line=3, column=7) for code in (*replies.CODES, *replies.FATAL_CODES)],
    replies.LeaseState(holder=NASTY, mine=True, epoch=3, expires_s=1.5),
    replies.Ack(run="r1"),
    replies.Progress(run="r1", state="running", text=NASTY),
    *[replies.Result(run="r1", state=state, reason="stuck", text=NASTY, outputs=(("reason", NASTY),)) for state in replies.RUN_FINAL],
    replies.Mission(state=m.MissionState(0.0, NASTY, 2, "paused"), names=(NASTY,)),
    replies.Tree(tick=3, format="ascii", text=NASTY),
    replies.Tree(tick=3, format="xml", nodes=(m.NodeState(NASTY, "GoTo", NASTY, 1, "RUNNING", NASTY, 1.0),)),
    replies.Modules(state=m.ModulesState(0.0, (m.ModuleState("base", "chain", "running", 1, 0, 0, 0.1, NASTY),))),
    replies.Why(is_moving=False, causes=(replies.Cause("sensor", "laser-stale", NASTY, 4.2, 0.5, NASTY), replies.Cause("node", "running", "", 0.0))),
    replies.LogLine(seq=1, event=m.Event(1.0, "warning", "say", "x", NASTY), is_cleared=True),
    replies.ParamsState(rev=3, confirm_s=1.5, rows=(replies.Param("a.b_m", NASTY, "a number", "m", ">= 0", "1", True),)),
    replies.Mission(state=m.MissionState(0.0), text=NASTY),
    describe(Describe(), described([topic.name for topic in TOPICS], catalogue(()))),
]


@pytest.mark.parametrize("reply", EVERY_REPLY, ids=lambda reply: type(reply).__name__)
def test_every_reply_is_one_line_that_validates(reply: replies.AnyReply) -> None:
    read(encode(reply))


def test_the_table_of_replies_is_complete() -> None:
    assert {type(reply) for reply in EVERY_REPLY} | {replies.Value} == set(replies.AnyReply.__args__)  # type: ignore[attr-defined]


@given(st.text(), st.floats(), st.lists(st.floats(), min_size=1, max_size=5))
def test_texts_and_numbers_come_back_as_they_went(text: str, number: float, many: list[float]) -> None:
    event = read(value_line("t", 1, 0.0, 0.0, body_of(m.Event(0.0, text=text))))
    kept = "".join(c if c in "\t\n\r" or (c >= " " and not 0xD800 <= ord(c) <= 0xDFFF and c not in "\ufffe\uffff") else "\ufffd" for c in text)
    assert (event.findtext("text") or "") == kept
    voltage = read(value_line("t", 1, 0.0, 0.0, body_of(m.BatteryState(0.0, number)))).findtext("voltage_v")
    assert float(voltage) == number or number != number
    sonar = read(value_line("t", 1, 0.0, 0.0, body_of(m.SonarState(0.0, tuple(many))))).findtext("ranges_m")
    assert np.array_equal([float(word) for word in sonar.split()], many, equal_nan=True)
