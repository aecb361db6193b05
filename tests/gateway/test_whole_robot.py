"""The gateway before a whole robot in lockstep: what clients change, the robot does; what they ask for is there; every line validates."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from pluto_bt import gateway
from pluto_bt.gateway.local import LocalClient, LocalGateway
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.record.box import open_box
from pluto_bt.runner import make_runner
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at

SCHEMA = etree.XMLSchema(etree.parse(str(Path(gateway.__file__).with_name("protocol.xsd"))))
HALL = '<world name="hall"><wall>-6,-6 30,-6 30,6 -6,6 -6,-6</wall><robot platform="pioneer" x="0" y="0" theta_deg="0"/></world>'
AHEAD = '<root BTCPP_format="4"><BehaviorTree ID="main"><GoTo name="ahead" goal="{x};0" max_speed_mps="{speed}"/></BehaviorTree></root>'

BAD = '<root BTCPP_format="4"><BehaviorTree ID="a"><Goto/></BehaviorTree>\n<BehaviorTree ID="a"/></root>'


class Talk:
    """One run in which a client says things at times of the run; all that he hears is held against the schema."""

    def __init__(self, folder: Path, says: dict[float, str], *, x: float = 8.0, speed: float = 0.5, record: str | None = None) -> None:
        (folder / "world.xml").write_text(HALL, encoding="utf-8")
        (folder / "m.xml").write_text(AHEAD.format(x=x, speed=speed), encoding="utf-8")
        self.trace = folder / "trace.jsonl"
        request = Request(str(folder / "m.xml"), world=str(folder / "world.xml"))
        self.runner = make_runner(read_inputs(request), max_time_s=60.0, trace_path=self.trace, record=record)
        self.system = self.runner.system
        self.gateway = LocalGateway(GatewayPort(self.system.context))
        self.client: LocalClient = self.gateway.connect()
        self._says = sorted(says.items())
        self.heard: list[Any] = []
        self.system.board.on_change("world/state", self._turn)
        self.result = self.runner.run()

    def _turn(self) -> None:
        now_s = self.system.clock.now_s()
        while self._says and now_s >= self._says[0][0]:
            self.client.send(self._says.pop(0)[1])
        self.gateway.step(now_s)
        for line in self.client.received().splitlines():
            answer = etree.fromstring(line, etree.XMLParser(huge_tree=True))
            SCHEMA.assertValid(answer)
            self.heard.append(answer)

    def told(self, id: str) -> list[Any]:
        return [answer for answer in self.heard if answer.get("id") == id]

    def speeds(self, between: Callable[[float], bool]) -> list[float]:
        """Forward speeds commanded to the base meanwhile."""
        lines = map(json.loads, self.trace.read_text(encoding="utf-8").splitlines())
        return [line["velocity"][0] for line in lines if line.get("command") == "ATRV2/Drive/Command" and between(line["t"] / 1e9)]


def test_a_speed_limit_counts_at_once_and_goes_back_if_nobody_confirms_it(tmp_path: Path) -> None:
    limit = '<params id="slow" op="set" rev="1" confirm_s="4"><p name="drive.max_speed_mps">0.2</p></params>'
    talk = Talk(tmp_path, {3.0: limit, 5.0: '<params id="get" name="drive.max_speed_mps"/>', 9.0: '<log id="log" since="0" level="info"/>'})
    assert talk.result.result == "SUCCESS"
    (changed,) = talk.told("slow")
    assert (changed.get("rev"), [(p.get("name"), p.text) for p in changed]) == ("2", [("drive.max_speed_mps", "0.2")])
    assert float(talk.told("get")[0].get("confirm_s")) == pytest.approx(2.0, abs=0.1)
    assert max(talk.speeds(lambda t: 2.0 < t < 3.0)) == pytest.approx(0.5, abs=0.01)
    assert max(talk.speeds(lambda t: 4.0 < t < 7.0)) == pytest.approx(0.2, abs=0.01)
    assert max(talk.speeds(lambda t: 8.0 < t < 10.0)) == pytest.approx(0.5, abs=0.01)
    changes = [event.text for event in talk.told("log") if event.get("code") == "params-changed"]
    assert changes == ["drive.max_speed_mps = 0.2", "drive.max_speed_mps = 0.0"]
    assert '"interactive":true' in talk.trace.read_text(encoding="utf-8")


def test_everything_there_is_is_described(tmp_path: Path) -> None:
    asked = {1.0: '<describe id="all"/><describe id="node" node="GoTo"/><describe id="param" param="avoid.*"/><describe id="module" module="drive"/>'}
    talk = Talk(tmp_path, asked, x=1.0)
    kinds = [item.get("kind") for item in talk.told("all")[0]]
    assert {kind: kinds.count(kind) > 10 for kind in ("topic", "request", "node", "param", "module")} == dict.fromkeys(
        ("topic", "request", "node", "param", "module"), True
    )
    (goto,) = talk.told("node")[0]
    ports = {field.get("name"): field for field in goto.iter("field")}
    assert ports["goal"].get("required") == "true" and ports["timeout_s"].get("unit") == "s" and ports["reason"].get("direction") == "out"
    assert goto.findtext("doc")
    live = {item.get("name"): (item.get("live"), item.get("unit"), item.get("range")) for item in talk.told("param")[0]}
    assert live["avoid.margin_m"] == ("true", "m", ">= 0") and live["avoid.laser_stale_s"][0] == "false"
    (drive,) = talk.told("module")[0]
    assert (drive.get("group"), drive.get("critical"), drive.get("needs"), drive.get("period_s")) == ("chain", "true", "filter", "0.05")


def test_a_long_session_validates(tmp_path: Path) -> None:
    typed = {
        0.5: '<hello version="1.0" name="anna" session="s"/><subscribe topic="*" max_rate_hz="1"/><subscribe topic="mission"/>',
        1.0: '<tree id="t" format="xml"/><tree format="ascii"/><tree format="dot"/><modules id="m"/><why id="w"/><why at="0.8"/><why at="999"/>',
        1.5: '<mission op="list"/><mission op="state"/><mission id="f" op="fetch"/><mission op="fetch" name="../../etc/passwd"/>',
        2.0: '<set id="s" topic="operator/word"><value>go</value></set><get id="g" topic="operator/word"/><set topic="tree"><tick>1</tick></set>',
        2.5: '<lease op="acquire" ttl_s="60"/><estop reason="test"/><run node="GoTo" goal="1;1"/><release what="estop"/>',
        2.9: '<log id="log"/>',
        3.0: '<run id="r" node="MakeTurn" angle_deg="20"/>',
        12.0: '<lease op="release"/><mission op="resume"/><module name="gps" op="stop"/><params op="get" name="no.such"/>',
        13.0: f'<mission id="bad" op="check">{BAD}</mission>',
        13.1: '<mission id="inc" op="load"><root BTCPP_format="4"><include path="../secret.xml"/></root></mission>',
    }
    talk = Talk(tmp_path, typed, x=3.0)
    assert talk.result.result == "SUCCESS"
    nodes = {node.get("name"): node for node in talk.told("t")[0]}
    assert nodes["ahead"].get("status") == "RUNNING" and float(nodes["ahead"].get("since_s")) >= 0.0
    # Lockstep: these are seconds of the run, whatever the computer does beside it.
    ages = {module.get("name"): float(module.get("age_s")) for module in talk.told("m")[0]}
    assert ages["drive"] <= 0.05 and ages["executive"] <= 0.1
    assert "<GoTo" in talk.told("f")[0].findtext("document")
    assert talk.told("s")[0].tag == "ok" and talk.told("g")[0].findtext("value") == "go"
    assert talk.told("r")[-1].get("state") == "succeeded"
    cleared = {(event.get("code"), event.get("source")): event.get("cleared") for event in talk.told("log") if event.tag == "event"}
    assert cleared["estop", "anna"] == "true" and cleared["estop-released", "anna"] == "false"
    faults = talk.told("bad")
    assert len(faults) > 1 and {fault.get("line") for fault in faults} == {"1", "2"}
    assert "includes no files" in talk.told("inc")[0].text
    codes = [answer.get("code") for answer in talk.heard if answer.tag == "error"]
    assert codes == ["out-of-range", "bad-mission", "read-only", "estopped", "unknown-module", "unknown-param", *["bad-mission"] * (len(faults) + 1)]
    assert len({answer.get("topic") for answer in talk.heard if answer.tag == "value"}) > 20


UNFIT = {"<GoTo/>": 'port "goal" of <GoTo> is missing', '<GoTo goal="{nix}"/>': 'nothing writes entry "nix"', "<RetryUntilSuccessful><AlwaysSuccess/>"
         "</RetryUntilSuccessful>": "num_attempts"}  # fmt: skip


def test_what_check_refuses_the_gateway_refuses_too_and_the_run_goes_on(tmp_path: Path) -> None:
    """All this loads in BehaviorTree.CPP, and would raise at its first tick."""
    says = {1.0: '<mission op="pause"/><lease op="acquire" ttl_s="60"/>', 2.5: '<run id="run" node="GoTo"/>', 4.0: '<mission op="resume"/>'}
    for number, node in enumerate(UNFIT):
        mission = f'<root BTCPP_format="4"><BehaviorTree ID="m">{node}</BehaviorTree></root>'
        says[2.0 + 0.1 * number] = "".join(f'<mission id="{op}{number}" op="{op}">{mission}</mission>' for op in ("check", "load"))
    model = '<TreeNodesModel><SubTree ID="m"><input_port name="to"/></SubTree></TreeNodesModel>'
    inputs = f'<root BTCPP_format="4"><BehaviorTree ID="m"><GoTo goal="{{to}}"/></BehaviorTree>{model}</root>'
    talk = Talk(tmp_path, {**says, 3.0: f'<mission id="inputs" op="load">{inputs}</mission><mission id="start" op="start"/>'}, x=3.0)
    for number, text in enumerate(UNFIT.values()):
        for (answer,) in (talk.told(f"check{number}"), talk.told(f"load{number}")):
            assert answer.get("code") == "bad-mission" and text in answer.text and int(answer.get("col")) > 1
    (refused,) = talk.told("run")
    assert refused.get("code") == "bad-value" and 'port "goal" of <GoTo> is missing; expected goal="…": x;y, in m' in refused.text
    assert 'input "to"' in talk.told("inputs")[0].text and talk.told("start")[0].get("code") == "wrong-state"
    assert talk.result.result == "SUCCESS"


def test_a_refused_raw_command_names_what_to_stop_first_and_a_second_pause_is_harmless(tmp_path: Path) -> None:
    drive = '<command target="drive" flags="10"><velocity>0.1 0</velocity></command>'
    talk = Talk(tmp_path, {
        1.0: '<mission id="p1" op="pause"/><lease op="acquire" ttl_s="60"/>', 1.5: '<mission id="p2" op="pause"/>',
        2.0: drive.replace(" ", ' id="both" ', 1),
        3.0: '<module name="motion" op="stop"/>', 4.0: drive.replace(" ", ' id="avoid" ', 1), 5.0: '<mission op="abort"/>',
    })  # fmt: skip
    assert [talk.told(id)[0].tag for id in ("p1", "p2")] == ["ok", "ok"]
    assert talk.told("both")[0].text.endswith("first stop motion, then stop avoid")
    assert talk.told("avoid")[0].text.endswith("first stop avoid")


def test_the_summary_is_that_of_the_mission_whose_ticks_it_counts(tmp_path: Path) -> None:
    other = '<root BTCPP_format="4"><BehaviorTree ID="other"><Say name="hi" text="hi"/></BehaviorTree></root>'
    asks = f'<mission op="pause"/><lease op="acquire" ttl_s="60"/><mission op="load">{other}</mission>'
    talk = Talk(tmp_path, {1.0: asks, 2.0: '<mission op="start"/>'})
    assert (talk.result.mission, talk.result.ticks, list(talk.result.leaves)) == ("other", 1, ["hi"])


def test_what_was_stopped_is_not_shown_as_running(tmp_path: Path) -> None:
    """An errand beside a paused mission is stopped: tree and why speak of the mission again, live and replayed; and everybody reads who did it."""
    asks = '<get id="tree{0}" topic="tree"/><why id="why{0}"/>'
    talk = Talk(tmp_path, {
        2.0: '<hello name="anna"/><mission op="pause"/><lease op="acquire" ttl_s="60"/>',
        3.0: '<run node="GoTo" goal="20;0"/>', 6.0: asks.format(1), 7.0: "<stop/><stop/>",
        9.0: asks.format(2) + '<tree id="drawn" format="ascii"/><log id="log" since="0" level="warning"/>', 9.5: '<mission op="abort"/>',
    }, record=str(tmp_path / "a.mcap"))  # fmt: skip
    before, after = ([(node.get("name"), node.get("status")) for node in talk.told(f"tree{i}")[0].iter("node")] for i in (1, 2))
    assert before == [("GoTo", "RUNNING")] and after == [("ahead", "RUNNING")], "paused, it runs on where it stood"
    assert "ahead" in talk.told("drawn")[0].text
    box = open_box(tmp_path / "a.mcap", "a.mcap", Faults())
    assert box is not None
    for i, t_s in (1, 6.0), (2, 9.0):
        causes = [(cause.get("layer"), cause.get("text")) for cause in talk.told(f"why{i}")[0].iter("cause")]
        replayed = [(cause.layer, cause.text) for cause in why_at(box, t_s).causes]
        first = [(layer, text.split()[0]) for layer, text in (causes[0], replayed[0])]
        assert first == [("node", "GoTo::1") if i == 1 else ("operator", "anna")] * 2, "who drives beside a paused mission does not wait for it"
        assert [text.split()[0] for layer, text in (*causes, *replayed) if layer == "node"] == [("GoTo::1", "ahead")[i - 1]] * 2
    events = [(event.get("code"), event.get("source"), event.text) for event in talk.told("log") if event.tag == "event"]
    assert events.count(("operator-stop", "anna", "anna stopped the robot")) == 1


HOSTILE = {
    '<run node="GoTo" goal="nan;nan"/>': "bad-value", '<run node="GoTo" goal="inf;0"/>': "bad-value",
    '<run node="GoTo" goal="1e400;0"/>': "bad-value", '<run node="GoTo" goal="1;1" max_speed_mps="nan"/>': "bad-value",
    '<run node="GoTo goal=\'3;3\'/>&lt;include path=\'/etc/passwd\'/>&lt;GoTo" goal="1;1"/>': "unknown-node",
    '<run node="../GoTo"/>': "unknown-node", '<run node="../GoTo" />': "unknown-node",
    '<command target="motion" flags="2"><position>nan 0</position></command>': "bad-value",
    '<command target="motion" flags="2"><position>1e400 0</position></command>': "bad-value",
    '<command target="motion" flags="2"><position>1e7 0</position></command>': "out-of-range",
    '<command target="motion" flags="44"><velocity>1e300 2</velocity></command>': "out-of-range",
    '<command target="wrist" flags="3"><position>0 -1e6.0001</position></command>': "bad-value",
    '<command target="drive" flags="0"><force>-1e9</force></command>': "out-of-range",
    '<run node="GoTo" goal="1e7;0"/>': "bad-value", '<run node="NavigateTo" goal="0;-1000001"/>': "bad-value",
    '<run node="MoveTo" goal="0;1e300"/>': "bad-value", '<run node="SetPose" pose="1e7;0;0"/>': "bad-value",
    '<run node="Explore" rectangle="1e7;2"/>': "bad-value", '<run node="Follow" target="person" distance_m="1e9"/>': "bad-value",
    '<command target="motion" flags="99999999999"/>': "invalid", '<command target="base" flags="0"/>': "invalid",
    '<mission op="load" name="../../../../etc/passwd"/>': "bad-mission", '<mission op="load">/etc/passwd</mission>': "bad-mission",
    '<mission op="load" name="patrol.xml/../t01.xml"/>': "bad-mission", '<set topic="operator/word"/>': "invalid",
}  # fmt: skip


def test_no_hostile_request_moves_the_robot(tmp_path: Path) -> None:
    hostile = [text.replace(" ", f' id="h{number}" ', 1) for number, text in enumerate(HOSTILE)]
    talk = Talk(tmp_path, {1.0: '<mission op="pause"/><lease op="acquire" ttl_s="60"/>', 3.0: "".join(hostile), 8.0: '<mission op="abort"/>'}, x=20.0)
    told = {text: talk.told(f"h{number}")[0].get("code") for number, text in enumerate(HOSTILE)}
    assert told == HOSTILE
    assert set(talk.speeds(lambda t: 2.9 < t < 8.0)) <= {0.0}
    assert "root:" not in str([answer.text for answer in talk.heard])


def test_a_mission_that_needs_inputs_is_started_with_them(tmp_path: Path) -> None:
    given = '<p name="goals">3,0;5,0</p> <p name="rounds">1</p>'
    mine = """<root BTCPP_format="4"><BehaviorTree ID="Main"><Say text="{what}"/></BehaviorTree>
<TreeNodesModel><SubTree ID="Main"><input_port name="what"/></SubTree></TreeNodesModel></root>"""
    talk = Talk(tmp_path, {
        0.5: '<mission id="bare" op="load" name="patrol.xml"/><mission id="odd" op="check" name="patrol.xml"><p name="gaols">3,0</p></mission>',
        0.6: f'<mission id="wrong" op="load" name="patrol.xml">{given.replace("5,0", "five")}</mission>',
        0.7: '<mission id="twice" op="load" name="patrol.xml"><p name="a">1</p><p name="a">2</p></mission>',
        0.8: '<mission id="deep" op="load" name="patrol.xml"><p name="a"><b/></p></mission>',
        0.9: f"<mission id='mine' op='check'><p name='what'>a &lt; b</p>\n{mine}</mission><mission id='not' op='check'>{mine}</mission>",
        1.0: f'<mission id="load" op="load" name="patrol.xml">{given}</mission><mission op="pause"/><mission id="start" op="start"/>',
    }, x=30.0)  # fmt: skip
    codes = {id: (talk.told(id)[0].get("code"), talk.told(id)[0].text) for id in ("bare", "odd", "wrong", "twice", "deep", "not")}
    assert {id: code for id, (code, _) in codes.items()} == {
        "bare": "bad-mission", "odd": "bad-mission", "wrong": "bad-mission", "twice": "invalid", "deep": "invalid", "not": "bad-mission",
    }  # fmt: skip
    assert 'give it by <p name="NAME">VALUE</p>' in codes["bare"][1] and "did you mean \"goals\"?" in codes["odd"][1]
    assert [talk.told(id)[0].tag for id in ("mine", "load", "start")] == ["ok"] * 3
    state = talk.system.executive.core.mission
    assert state is not None and (state.state, talk.result.final_pose[0]) == ("succeeded", pytest.approx(5.0, abs=0.5))
