"""Stories of clients, in one thread and without sockets: lease, runs, stop, idempotency, subscriptions, bounds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from pluto_bt import gateway
from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.access import Access
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.local import LocalClient, LocalGateway
from pluto_bt.gateway.port import RunState

from .conftest import whole
from .robot import FakeRobot

SCHEMA = etree.XMLSchema(etree.parse(str(Path(gateway.__file__).with_name("protocol.xsd"))))
RUN = '<run id="7" node="GoTo" goal="3;4" deadline_s="60"/>'


class Story:
    """A robot, its gateway, and clients who speak and are answered; every answer is held against the schema."""

    def __init__(self, limits: Limits | None = None, token: str = "") -> None:
        self.robot = FakeRobot()
        self.gateway = LocalGateway(self.robot, limits, whole(token))
        self.step(0.0)

    def client(self, hello: str = "") -> LocalClient:
        client = self.gateway.connect()
        if hello:
            assert self.says(client, hello)[0].tag == "hello"
        return client

    def step(self, seconds: float = 0.02) -> None:
        self.robot.time_s = round(self.robot.time_s + seconds, 6)
        self.gateway.step(self.robot.time_s)

    def says(self, client: LocalClient, text: str) -> list[Any]:
        client.send(text)
        self.step()
        return self.hears(client)

    def hears(self, client: LocalClient, room_bytes: int = 1 << 20) -> list[Any]:
        answers = [etree.fromstring(line) for line in client.received(room_bytes).splitlines()]
        for answer in answers:
            SCHEMA.assertValid(answer)
        return answers


def brief(answers: list[Any]) -> list[str]:
    """Tag, and the code of an error or the state of a result."""
    return [" ".join(word for word in (a.tag, a.get("code"), a.get("state"), a.get("reason")) if word) for a in answers]


@pytest.fixture
def story() -> Story:
    return Story()


def test_a_person_types_a_session(story: Story) -> None:
    nc = story.client()
    story.robot.write("Localization/Pose", m.Pose(0.02, (1.0, 2.0, 0.0, 0.5, 0.0, 0.0)))
    typed = '<?xml version="1.0"?>\n<hello version="1.0"/>\n<ping t="9" id="a"/><get topic="Localization/Pose" id="b"/>\n'
    hello, pong, value = story.says(nc, typed)
    assert (hello.get("robot"), hello.get("version"), pong.get("t"), pong.get("id")) == ("pluto", "1.0", "9", "a")
    assert (value.get("id"), value.get("stamp"), value.findtext("pose")) == ("b", "0.020000", "1.0 2.0 0.0 0.5 0.0 0.0")
    assert brief(story.says(nc, "<ping/><get/><gett/>text")) == ["pong", "error invalid", "error unknown-element", "error not-well-formed"]


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ("<get/>", 'invalid <get>: expected the attribute "topic"; attributes of <get>: id, topic'),
        ('<get topik="x"/>', 'invalid <get>: unknown attribute "topik"; expected one of: id, topic; did you mean "topic"?'),
        ('<lease op="grab"/>', 'invalid <lease op="grab">: expected one of acquire, take, renew, query, release, found "grab"'),
        ('<lease op="acquire" ttl_s="nan"/>', 'invalid <lease ttl_s="nan">: expected float >= 0.1, found "nan"'),
        ('<subscribe topic="tree" max_rate_hz="-1"/>', 'invalid <subscribe max_rate_hz="-1">: expected float >= 0.0, found "-1"'),
        ('<subscribe topic="motion/stat"/>', 'unknown-topic unknown topic "motion/stat"; did you mean "motion/status"?'),
        ("<ping>hello</ping>", "invalid <ping>: expected no text, found 'hello'"),
        ("<ping><a/></ping>", "invalid <ping>: expected no elements, found <a>"),
        ("<command target='drive' flags='0'><velocity>1</velocity></command>", "bad-value <command>: <velocity>: expected 2 numbers, found 1"),
        ("<command target='drive' flags='0'><force>inf</force></command>", "bad-value <command>: <force>: expected finite numbers, found 'inf'"),
        ("<describe node='GoTu'/>", 'unknown-node unknown node "GoTu"; <describe/> lists all'),
        ("<describe node='a' topic='b'/>", "invalid <describe>: expected at most one of topic, node, param, module, found topic, node"),
        ("<params op='set'><q name='a'>1</q></params>", 'invalid <params>: expected <p name="…">, found <q name>'),
        ("<params op='set'><p>1</p></params>", 'invalid <params>: expected <p name="…">, found <p>'),
        ("<params op='set' confirm_s='1e9'/>", 'invalid <params confirm_s="1e9">: expected float <= 3600.0, found "1e9"'),
        ("<set topic='operator/word'><word>x</word></set>", "invalid expected at least one of the fields <value>, found word"),
        ("<set topic='tree'><a b='1'>x</a></set>", 'invalid <set>: expected each of its elements once, with a text alone; look at "a"'),
        ("<set topic='sick/scan'><value>x</value></set>", "read-only sick/scan is not the gateway's"),
        ("<get topic='sick/scan'/>", 'no-value "sick/scan" has no value yet'),
        ("<tree/>", "no-value there is no tree yet"),
        ("<module name='slem' op='stop'/>", 'unknown-module unknown module "slem"'),
        ("<unsubscribe topic='tree'/>", 'invalid expected a topic or pattern that was subscribed to, found "tree"'),
        (RUN, 'no-lease the lease is held by nobody; acquire it first: <lease op="acquire"/>'),
    ],
)
def test_a_wrong_message_is_told_what_is_wrong_and_the_stream_goes_on(story: Story, message: str, expected: str) -> None:
    client = story.client()
    error, pong = sorted(story.says(client, message + "<ping t='1'/>"), key=lambda answer: answer.tag)
    assert f"{error.get('code')} {error.text}" == expected
    assert (error.get("fatal"), pong.tag) == ("false", "pong")


def test_a_run_goes_from_lease_to_result(story: Story) -> None:
    client = story.client()
    assert brief(story.says(client, '<lease op="acquire" ttl_s="5"/>' + RUN)) == ["lease_state", "ack", "progress running"]
    assert story.robot.did == [("run", "GoTo", {"goal": "3;4"}, 60.0)]
    story.robot.runs["r1"] = RunState("failed", "stuck", "a wall", (("reason", "stuck"),))
    (result,) = story.says(client, "")
    assert (result.get("id"), result.get("run"), result.get("state"), result.get("reason")) == ("7", "r1", "failed", "stuck")
    assert [(out.get("name"), out.text) for out in result] == [("reason", "stuck")]


def test_one_client_drives_at_a_time(story: Story) -> None:
    anna, ben = story.client('<hello name="anna"/>'), story.client('<hello name="ben"/>')
    (mine,) = story.says(anna, '<lease op="acquire"/>')
    assert (mine.get("holder"), mine.get("mine"), mine.get("epoch")) == ("anna", "true", "1")
    assert brief(story.says(ben, '<lease op="acquire"/>' + RUN)) == ["error lease-held", "error no-lease"]
    story.says(anna, RUN)
    (taken,) = story.says(ben, '<lease op="take"/>')
    assert (taken.get("holder"), taken.get("epoch")) == ("ben", "2")
    assert brief(story.hears(anna)) == ["result preempted preempted"]
    assert ("stop", "the lease of anna was taken by ben") in story.robot.did
    assert brief(story.says(anna, '<lease op="renew"/>')) == ["error no-lease"]
    assert story.says(ben, '<lease op="release"/>')[0].get("holder") == ""


@pytest.mark.parametrize(
    ("on_loss", "did", "heard"),
    [
        ("stop", [("stop", "the lease of #1 ran out"), ("cancel", "r1", "cancelled")], ["result cancelled cancelled"]),
        ("pause", [("cancel", "r1", "cancelled")], ["result cancelled cancelled"]),
        ("continue", [], []),
    ],
)
def test_a_lease_that_runs_out_does_what_its_holder_wished(story: Story, on_loss: str, did: list[Any], heard: list[str]) -> None:
    client = story.client()
    story.says(client, f'<lease op="acquire" ttl_s="2" on_loss="{on_loss}"/>{RUN}')
    story.step(1.9)
    story.says(client, '<lease op="renew"/>')
    story.robot.did.clear()
    story.step(1.9)
    assert story.robot.did == []
    story.step(0.2)
    assert story.robot.did == did
    assert brief(story.hears(client)) == heard


def test_a_lease_ends_with_its_connection(story: Story) -> None:
    client = story.client()
    story.says(client, '<lease op="acquire" ttl_s="60"/>')
    client.close()
    story.step()
    assert story.robot.did == [("stop", "the lease of #1 ended with his connection")]
    assert story.says(story.client(), '<lease op="acquire"/>')[0].get("mine") == "true"


def test_anyone_stops_at_once_and_what_the_stop_overtook_does_not_move(story: Story) -> None:
    driver, passer = story.client(), story.client()
    story.says(driver, '<lease op="acquire" ttl_s="60"/>' + RUN)
    story.robot.did.clear()
    driver.send('<run id="8" node="GoTo" goal="5;5"/><command target="drive" flags="0"/>')
    passer.send('<stop id="s"/>')
    assert story.robot.did == [("stop", "client 2")]  # before any step
    story.step()
    assert [answer.get("id") for answer in story.hears(passer)] == ["s"]
    assert brief(story.hears(driver)) == ["result cancelled stopped", "error wrong-state", "error wrong-state"]
    assert not [deed for deed in story.robot.did if deed[0] in ("run", "command")]


def test_a_run_that_is_asked_for_after_a_stop_is_not_cancelled_by_it(story: Story) -> None:
    driver = story.client()
    story.says(driver, '<lease op="acquire" ttl_s="60"/>')
    assert brief(story.says(driver, "<stop/>" + RUN)) == ["ok", "ack", "progress running"]


def test_estop_latches_until_the_holder_releases_it(story: Story) -> None:
    driver, passer = story.client(), story.client('<hello name="passer"/>')
    story.says(driver, '<lease op="acquire" ttl_s="60"/>')
    assert brief(story.says(passer, '<estop reason="smoke"/>')) == ["ok"]
    (error,) = story.says(driver, RUN)
    assert error.get("code") == "estopped" and "smoke" in error.text
    assert brief(story.says(passer, '<release what="estop"/>')) == ["error no-lease"]
    assert brief(story.says(driver, '<release what="estop"/>' + RUN)) == ["ok", "ack", "progress running"]


def test_a_mission_that_runs_keeps_commands_out(story: Story) -> None:
    client = story.client()
    story.robot.mission_now = m.MissionState(0.0, "patrol", 1, "running", "", "Patrol/GoTo")
    command = '<command target="drive" flags="0"><velocity>0.1 0</velocity></command>'
    assert brief(story.says(client, '<lease op="acquire"/>' + RUN + command)) == ["lease_state", "error wrong-state", "error wrong-state"]
    story.robot.mission_now = m.MissionState(0.0, "patrol", 1, "paused")
    assert brief(story.says(client, command + '<mission op="state"/><mission op="list"/>')) == ["ok", "mission_state paused", "mission_state paused"]
    assert story.robot.did == [("command", "drive", 0, (0.1, 0.0))]


def test_a_repeated_id_of_a_session_acts_once_also_after_a_reconnect(story: Story) -> None:
    client = story.client('<hello name="a" session="s1"/>')
    story.says(client, '<lease op="acquire" ttl_s="60" on_loss="continue"/>' + RUN)
    client.close()
    again = story.client('<hello name="a" session="s1"/>')
    assert brief(story.says(again, RUN)) == ["ack", "progress running"]
    story.robot.runs["r1"] = RunState("succeeded")
    assert brief(story.says(again, "")) == ["result succeeded"]
    assert brief(story.says(again, RUN)) == ["ack", "result succeeded"]
    assert brief(story.says(again, RUN.replace("3;4", "5;6"))) == ["error conflict"]
    assert [deed[0] for deed in story.robot.did] == ["run"]


def test_a_refused_request_may_be_tried_again_under_its_id(story: Story) -> None:
    client = story.client('<hello session="s1"/>')
    assert brief(story.says(client, RUN)) == ["error no-lease"]
    assert brief(story.says(client, '<lease op="acquire"/>' + RUN)) == ["lease_state", "ack", "progress running"]


def test_without_a_session_ids_are_only_echoed(story: Story) -> None:
    client = story.client()
    story.says(client, '<lease op="acquire" ttl_s="60"/>' + RUN)
    assert sorted(brief(story.says(client, RUN))) == ["ack", "progress running", "result preempted preempted"]
    assert [deed[0] for deed in story.robot.did] == ["run", "run"]


def pose_at(story: Story, x_m: float) -> None:
    story.robot.write("Localization/Pose", m.Pose(story.robot.time_s, (x_m, 0.0, 0.0, 0.0, 0.0, 0.0)))


def test_a_subscriber_sees_values_at_his_rate_and_only_what_matches(story: Story) -> None:
    each, slow, changes = story.client(), story.client(), story.client()
    story.says(each, '<subscribe id="e" topic="Localization/*"/>')
    story.says(slow, '<subscribe topic="Localization/Pose" max_rate_hz="5"/>')
    story.says(changes, '<subscribe topic="Localization/Pose" on_change="true"/>')
    story.robot.write("ATRV2/Battery", m.BatteryState(0.0, 12.0))
    heard: dict[str, list[str]] = {"each": [], "slow": [], "changes": []}
    for i in range(50):  # one second at 50 Hz; the pose changes every tenth time
        pose_at(story, float(i // 10))
        story.step()
        for name, client in (("each", each), ("slow", slow), ("changes", changes)):
            heard[name] += [answer.get("seq") for answer in story.hears(client)]
    assert heard["each"] == [str(i) for i in range(1, 51)]
    assert heard["changes"] == ["1", "11", "21", "31", "41"]
    assert 5 <= len(heard["slow"]) <= 6
    assert brief(story.says(each, '<unsubscribe topic="Localization/*"/>')) == ["ok"]
    pose_at(story, 99.0)
    assert story.says(each, "") == []


def test_a_slow_reader_loses_old_values_never_replies_or_events(story: Story) -> None:
    client = story.client()
    story.says(client, '<subscribe topic="Localization/Pose"/><subscribe topic="events"/>')
    lines = []
    for i in range(20):
        pose_at(story, float(i))
        story.robot.says(f"line {i}")
        client.send(f'<ping t="{i}"/>')
        story.step()
        lines += story.hears(client, room_bytes=0)
    assert [line.get("t") for line in lines if line.tag == "pong"] == [str(i) for i in range(20)]
    assert [line.findtext("text") for line in lines if line.get("topic") == "events"] == [f"line {i}" for i in range(20)]
    assert not [line for line in lines if line.get("topic") == "Localization/Pose"]
    (value,) = story.hears(client)
    assert (value.get("seq"), value.get("dropped")) == ("20", "19")
    pose_at(story, 0.0)
    assert story.says(client, "")[0].get("dropped") == "0"


def test_mission_tree_events_and_modules_are_shown(story: Story) -> None:
    client = story.client()
    story.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "running", "", "a/b"))
    story.robot.write("tree", m.TreeState(0.0, 5, (m.NodeState("a", "Sequence", "a", 0, "RUNNING", "", 0.0),)))
    story.robot.says("ouch", "error")
    story.robot.says("fine")
    value, tree, drawn, modules, ok, event = story.says(
        client, '<get topic="mission"/><tree/><tree format="ascii"/><modules/><log level="warning" id="l"/>'
    )
    assert (value.get("topic"), value.findtext("state"), tree[0].get("kind"), modules[0].get("name")) == ("mission", "running", "Sequence", "base")
    assert drawn.text == "Sequence\n  GoTo <3;4>"
    assert (ok.get("id"), event.get("id"), event.get("level"), event.text) == ("l", "l", "error", "ouch")
    items = story.says(client, '<describe topic="Localization/*"/>')[0]
    assert [item.get("name") for item in items][:1] == ["Localization/Dead-Reckoning"] and len(items) == 6


def test_a_mission_comes_through_as_it_was_written(story: Story) -> None:
    client = story.client()
    text = '<root BTCPP_format="4">\n  <BehaviorTree ID="a>b"><Script code="x &lt; 1"/></BehaviorTree></root>'
    assert brief(story.says(client, f'<mission op="load" name="m">{text}</mission>')) == ["ok"]
    assert story.robot.did == [("mission", "load", "m", text)]


def test_a_flood_is_cut_but_the_stop_behind_it_is_heard(story: Story) -> None:
    client = story.client()
    client.send("<ping t='1'/>" * 300 + "<stop/>")
    assert story.robot.did == [("stop", "client 1")]
    answers = story.hears(client)
    assert brief(answers) == ["pong"] * 200 + ["error rate-limit"]
    assert answers[-1].get("fatal") == "true"


@pytest.mark.parametrize("cut", [1, 7, 4096])
def test_however_a_flood_is_cut_its_stops_are_heard(story: Story, cut: int) -> None:
    client = story.client()
    flood = b"<ping/>" * 250 + b"<estop/>" + b"<ping/><stopper/>" * 3
    for at in range(0, len(flood), cut):
        client.send(flood[at : at + cut])
    assert story.robot.did == [("estop", "client 1", "")]


def test_a_flood_of_stops_is_a_few_stops_and_every_one_is_answered(story: Story) -> None:
    client = story.client()
    client.send("".join(f'<stop id="{i}"/>' for i in range(500)))
    story.step()
    story.step()
    assert [answer.get("id") for answer in story.hears(client)] == [str(i) for i in range(500)]
    assert story.robot.did == [("stop", "client 1")] * 2


def test_more_requests_than_the_executive_takes_are_busy() -> None:
    story = Story(Limits(outstanding=3))
    assert brief(story.says(story.client(), "<modules/>" * 5)) == ["error busy", "error busy", "modules", "modules", "modules"]


def test_who_asks_for_long_work_waits_for_it_himself(story: Story) -> None:
    def read_for_a_second(*_: object) -> None:
        story.robot.time_s += 1.0

    story.robot.mission = read_for_a_second  # type: ignore[method-assign]
    busy, other = story.client(), story.client()
    busy.send('<mission op="check"><root/></mission>' * 20)
    other.send('<lease op="query"/>')
    story.step()
    story.step()
    assert brief(story.hears(other)) == ["lease_state"]
    assert len(story.hears(busy)) <= 2


def test_answers_to_one_question_do_not_fill_a_step(story: Story) -> None:
    for number in range(200):
        story.robot.says(f"word {number}")
    client = story.client()
    client.send("<log/>" * 10)
    story.step()
    assert len(story.hears(client)) < 2 * 256
    for _ in range(9):
        story.step()
    assert [answer.tag for answer in story.hears(client)].count("ok") > 6


def test_the_last_places_are_for_operators() -> None:
    story = Story(Limits(clients=3, operator_places=2))
    story.client("<hello/>")
    assert brief(story.says(story.client(), "<ping/>")) == ["error too-many-connections"]
    stranger, operator = story.client(), story.client('<hello name="operator"/>')
    assert brief(story.says(stranger, "<stop/>")) == ["ok"]
    assert brief(story.hears(story.client())) == ["error too-many-connections"]
    assert brief(story.says(operator, "<ping/>")) == ["pong"]


def test_a_token_is_demanded_where_one_is_set() -> None:
    story = Story(token="secret")
    assert brief(story.says(story.client(), "<ping/>")) == ["error unauthorised"]
    assert brief(story.says(story.client(), '<hello token="guess"/>')) == ["error unauthorised"]
    assert brief(story.says(story.client(), "<stop/>")) == ["ok"]
    assert brief(story.says(story.client('<hello token="secret"/>'), "<ping/>")) == ["pong"]


def test_another_major_version_is_refused(story: Story) -> None:
    assert brief(story.says(story.client(), '<hello version="2.0"/>')) == ["error unsupported-version"]


def test_a_robot_that_raises_is_an_internal_error_and_no_more(story: Story) -> None:
    client = story.client()
    story.robot.modules = lambda: 1 / 0  # type: ignore[method-assign,assignment,return-value]
    (error,) = story.says(client, "<modules/>")
    assert (error.get("code"), error.text) == ("internal", "ZeroDivisionError: division by zero")


@pytest.mark.parametrize(
    ("token", "after_s", "unread_bytes", "code"),
    [
        ("", 59.9, 0, ""), ("", 60.0, 0, "timeout"), ("", 1.0, 512 * 1024, ""), ("", 1.0, 512 * 1024 + 1, "slow-consumer"),
        ("secret", 2.9, 0, ""), ("secret", 3.0, 0, "timeout"),
    ],
)  # fmt: skip
def test_silence_and_unread_replies_end_a_connection(token: str, after_s: float, unread_bytes: int, code: str) -> None:
    session = Story(token=token).gateway.hub.open(0.0)
    session.tick(after_s, unread_bytes)
    said = session.to_send(after_s, 0)
    assert (session.closing, said != b"") == (code != "", code != "")
    assert code == "" or etree.fromstring(said).get("code") == code


def test_a_stranger_in_an_operators_place_gives_way() -> None:
    story = Story(Limits(clients=3, operator_places=2))
    strangers = [story.client() for _ in range(3)]
    operator = story.client('<hello name="shell"/>')
    assert [brief(story.hears(stranger)) for stranger in strangers] == [[], ["error too-many-connections"], []]
    assert brief(story.says(operator, "<ping/>")) == ["pong"]


def test_what_a_client_has_just_changed_is_what_he_gets(story: Story) -> None:
    client = story.client()
    for i in range(30):
        (ok, value) = story.says(client, f'<set topic="operator/word"><value>{i}</value></set><get topic="operator/word"/>')
        assert (ok.tag, value.findtext("value")) == ("ok", str(i))
        for _ in range(i % 15):
            story.step()


@pytest.mark.parametrize("rate", ["1e-310", "5e-324", "0.0009"])
def test_a_rate_of_nearly_nothing_is_refused_and_nobody_else_notices(story: Story, rate: str) -> None:
    odd, other = story.client(), story.client()
    story.says(other, '<subscribe topic="Localization/Pose"/>')
    answers = story.says(odd, f'<subscribe topic="Localization/Pose"/><subscribe topic="Localization/*" max_rate_hz="{rate}"/>')
    assert brief(answers) == ["ok", "error invalid"] and "at least 0.001" in answers[1].text
    odd.close()
    pose_at(story, 1.0)
    assert brief(story.says(other, "")) == ["value"]


def test_a_fault_of_ours_ends_the_connection_that_met_it(story: Story, monkeypatch: pytest.MonkeyPatch) -> None:
    client, other = story.client(), story.client()
    story.says(client, '<subscribe topic="Localization/Pose"/>')
    monkeypatch.setattr(story.gateway.hub, "describe", lambda request: 1 / 0)
    (error,) = story.says(client, '<describe id="d"/><ping/>')
    assert (error.get("code"), error.get("id"), client.is_over) == ("internal", "d", True)
    client.close()
    pose_at(story, 1.0)
    assert brief(story.says(other, "<ping/>")) == ["pong"]


def test_a_session_is_not_a_connection_whatever_it_is_called(story: Story) -> None:
    driver, other = story.client(), story.client('<hello session="#1"/>')
    story.says(driver, '<lease op="acquire" ttl_s="60"/>')
    command = '<command target="drive" flags="0"><velocity>0.1 0</velocity></command>'
    assert brief(story.says(other, command)) == ["error no-lease"]


def test_a_session_belongs_to_its_person() -> None:
    story = Story(token="secret")
    access = story.gateway.hub.access = Access().with_token("anna", "a" * 16).with_token("bert", "b" * 16)
    assert len(access.keys) == 2
    anna, bert = (story.client(f'<hello session="s" token="{letter * 16}"/>') for letter in "ab")
    story.says(anna, '<lease op="acquire" ttl_s="60"/>')
    command = '<command id="1" target="drive" flags="0"><velocity>0.1 0</velocity></command>'
    assert brief(story.says(bert, command)) == ["error no-lease"]
    assert brief(story.says(anna, command)) == ["ok"]


def test_a_lease_stays_while_its_session_has_a_connection(story: Story) -> None:
    older, newer = story.client('<hello session="s"/>'), story.client('<hello session="s"/>')
    story.says(older, '<lease op="acquire" ttl_s="60"/>')
    assert story.says(newer, '<lease op="query"/>')[0].get("mine") == "true"
    newer.close()
    story.step()
    assert brief(story.says(older, RUN)) == ["ack", "progress running"]
    older.close()
    story.step()
    assert ("cancel", "r1", "cancelled") in story.robot.did


def test_one_client_has_one_great_document_under_way(story: Story) -> None:
    client = story.client()
    document = f'<mission op="check"><root><!--{" " * 600_000}--></root></mission>'
    assert brief(story.says(client, document * 2 + "<modules/>")) == ["error busy", "ok", "modules"]
    assert brief(story.says(client, document)) == ["ok"]


def test_who_asks_again_and_again_is_answered_by_the_gateway_itself(story: Story) -> None:
    """After the executive's first answers nothing that it said is newer than what the gateway knows."""
    story.robot.write("Localization/Pose", m.Pose(0.02, (1.0, 2.0, 0.0, 0.5, 0.0, 0.0)))
    asked = "".join(f'<get topic="Localization/Pose" id="{i}"/>' for i in range(50))
    clients = [story.client() for _ in range(4)]
    for client in clients:
        client.send(asked)
    heard = [0] * len(clients)
    for _ in range(8):
        story.step()
        heard = [count + len(story.hears(client)) for count, client in zip(heard, clients, strict=True)]
    assert heard == [50] * len(clients)
    for client in clients:
        client.send(asked)
        assert [value.get("id") for value in story.hears(client)] == [str(i) for i in range(50)], "no step of the robot was needed"


def test_a_value_that_is_older_than_an_answer_is_not_given(story: Story) -> None:
    client = story.client()
    story.robot.write("Localization/Pose", m.Pose(0.02, (1.0, 2.0, 0.0, 0.5, 0.0, 0.0)))
    for _ in range(3):
        story.says(client, '<get topic="Localization/Pose"/>')
    client.send('<modules/><get topic="Localization/Pose"/>')
    assert story.hears(client) == [], "the executive is asked, and the answers keep their order"
    story.robot.write("Localization/Pose", m.Pose(0.04, (3.0, 2.0, 0.0, 0.5, 0.0, 0.0)))
    story.step()
    modules, value = story.hears(client)
    assert (modules.tag, value.findtext("pose")) == ("modules", "3.0 2.0 0.0 0.5 0.0 0.0")
