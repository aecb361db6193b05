"""A client of the monitor beside a real run: over the loopback, in threads and in lockstep."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
import zmq
from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts

from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.cli import main
from pluto_bt.doors import Doors
from pluto_bt.gateway.listen import Address
from pluto_bt.groot.protocol import Desk
from pluto_bt.groot.server import Server
from pluto_bt.modules.groot import Groot
from pluto_bt.runtime import VirtualClock
from pluto_bt.scenario import Play
from pluto_bt.source import InputError
from tests.groot.client import GrootClient

MISSION = """<root BTCPP_format="4" main_tree_to_execute="Out"><BehaviorTree ID="Out"><Sequence name="all">
  <SubTree ID="Leg" name="leg" place="3;0"/><GrootStoryReleased name="released"/>
  </Sequence></BehaviorTree><BehaviorTree ID="Leg"><GoTo name="go" goal="{place}" reason="{why}"/></BehaviorTree></root>"""


class Released(BehaviourWithPorts, tag="GrootStoryReleased"):
    """Waits until the test has seen enough."""

    INPUT_PORTS = NO_PORTS
    OUTPUT_PORTS = NO_PORTS
    enough = threading.Event()

    def update(self) -> Status:
        return Status.SUCCESS if self.enough.is_set() else Status.RUNNING


def free_neighbours() -> int:
    """A port that was free a moment ago, and the one after it too."""
    for _ in range(50):
        with socket.socket() as one, socket.socket() as other:
            one.bind(("127.0.0.1", 0))
            port: int = one.getsockname()[1]
            try:
                other.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port
    raise AssertionError("no two free ports side by side")


@pytest.fixture
def play(scenario: Play, tmp_path: Any) -> Iterator[Any]:
    """Starts a run with a monitor in the background: play(...) gives its port; the run must be over soon after the test."""
    runs: list[threading.Thread] = []
    Released.enough.clear()

    def start(**how: Any) -> tuple[int, list[Any]]:
        (tmp_path / "m.xml").write_text(MISSION, encoding="utf-8")
        port, done = free_neighbours(), []

        def go() -> None:
            done.append(scenario("ideal.xml", mission=str(tmp_path / "m.xml"), groot=f"127.0.0.1:{port}", nodes=(Released,), **how))

        runs.append(threading.Thread(target=go))
        runs[-1].start()
        return port, done

    yield start
    Released.enough.set()
    for run in runs:
        run.join(timeout=120.0)
        assert not run.is_alive()


def test_a_client_follows_a_run_in_threads(play: Any) -> None:
    port, done = play(realtime=True, speed=3.0, max_time_s=1800.0)
    with GrootClient(port) as client:
        while client.ask(b"T").error:
            pass  # the run has not begun; each question takes its time
        tree = client.tree()
        names = {int(node.get("_uid", "0")): node.get("name") or node.get("_fullpath") for node in tree.iter() if node.get("_uid")}
        assert list(names.values()) == ["all", "leg", "released", "go"]
        assert client.ask(b"r", b"start").payload
        seen = {name: {0} for name in names.values()}
        while 12 not in seen["go"]:
            for uid, code in client.statuses().items():
                seen[names[uid]].add(code)
        assert {1, 2, 12} - seen["go"] <= {2} and 1 in seen["all"] and 2 in seen["leg"]
        changes = [(names[uid], code) for _, uid, code in client.changes()]
        assert ("go", 2) in changes and ("released", 1) in changes
        assert client.boards("leg", "Out") == {"leg": {"place": "3;0", "why": ""}, "Out": None, "ROOT": None}
        first = client.ask(b"S").tree_id
        assert len(first) == 16 and client.ask(b"D").tree_id == first
    Released.enough.set()
    while not done:
        pass_time(port)
    assert done[0].said("groot-client") == ["a monitor looks on"]
    assert done[0].result == "SUCCESS" and done[0].collisions == 0


def pass_time(port: int) -> None:
    """Waits a moment without asking a clock: nobody answers on this port."""
    with zmq.Context() as context, context.socket(zmq.SUB) as quiet:
        quiet.connect(f"tcp://127.0.0.1:{port + 1}")
        quiet.poll(100)


def test_a_monitor_changes_nothing_of_a_run(scenario: Play, play: Any) -> None:
    port, done = play(max_time_s=20.0)
    while not done:
        pass_time(port)
    alone = scenario("ideal.xml", mission=done[0].runner.inputs.mission_path.as_posix(), nodes=(Released,), max_time_s=20.0)
    assert alone.trace_sha256 == done[0].trace_sha256


def test_the_module_can_be_stopped_and_started_again() -> None:
    clock, executive = VirtualClock(), SimpleNamespace(on_ticked=None)
    system = SimpleNamespace(options=SimpleNamespace(doors=Doors(groot=Address("127.0.0.1", 0))), executive=executive)
    module = Groot(cast(Any, SimpleNamespace(system=system, clock=clock, say=lambda *words: None)))
    for _ in range(2):
        module.start(0.0)
        assert executive.on_ticked is not None
        with GrootClient(module.address.port) as client:
            assert client.ask(b"T").error == "there is no tree yet"
        module.stop()
        assert executive.on_ticked is None


def test_two_monitors_cannot_have_one_port() -> None:
    desk = Desk(lambda: 0, lambda: 0)
    server = Server(desk, "127.0.0.1", 0)
    try:
        with pytest.raises(InputError) as refused:
            Server(desk, "127.0.0.1", server.port)
        assert "cannot listen on" in str(refused.value) and "give another port" in str(refused.value)
    finally:
        server.stop()
    again = Server(desk, "127.0.0.1", server.port)
    again.stop()


@pytest.mark.parametrize(
    ("text", "told"),
    [("0.0.0.0:1667", "does not listen on 0.0.0.0"), ("65535", "needs the port after"), ("127.0.0.1:x", "bad address"), (":99999", "bad address")],
)  # fmt: skip
def test_a_bad_address_is_refused_before_anything_moves(text: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "t01_say_hello.xml", "--groot", text]) == 2
    assert told in capsys.readouterr().err


def test_a_port_in_use_ends_the_run_before_it_begins(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        assert main(["run", "t01_say_hello.xml", "--groot", str(taken.getsockname()[1] - 1)]) == 2
    assert "cannot listen on" in capsys.readouterr().err
