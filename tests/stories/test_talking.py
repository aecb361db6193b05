"""Stories of people and programs that talk to a robot while it drives: real processes, real sockets."""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import IO

import pytest

from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.errors import WrongStateError
from pluto_bt.gateway.proxies import DriveProxy

RUN = [sys.executable, "-m", "pluto_bt", "run", "patrol.xml", "--port", "goals=8,3;13.5,3;10.5,8;2,3.5", "--port", "rounds=50",
       "--realtime", "--speed", "4", "--gateway", "127.0.0.1:0", "--json"]  # fmt: skip


class Robot:
    """A run in a process of its own."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(RUN, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr is not None
        self.port = int(_line_with(self.process.stderr, r"listening on 127\.0\.0\.1:(\d+)"))

    def client(self) -> Client:
        return Client(port=self.port, timeout_s=20.0)

    def pluto(self, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-m", "pluto_bt", *words], capture_output=True, text=True, timeout=60, check=False)

    def end(self, number: signal.Signals = signal.SIGINT) -> tuple[int, dict[str, object]]:
        self.process.send_signal(number)
        out, _ = self.process.communicate(timeout=60)
        return self.process.returncode, json.loads(out.splitlines()[-1])


def _line_with(stream: IO[str], pattern: str) -> str:
    for line in stream:
        found = re.search(pattern, line)
        if found:
            return found[1]
    raise AssertionError(f"the run ended without a line like {pattern}")


@pytest.fixture
def robot() -> Iterator[Robot]:
    one = Robot()
    yield one
    if one.process.poll() is None:
        one.process.kill()
        one.process.communicate()


def wait_for_speed(client: Client, is_such: Callable[[float], bool]) -> None:
    """Until the robot has such a speed; two minutes of its own time at the most."""
    client.subscribe("ATRV2/Drive/Raw", max_rate_hz=10)
    speeds = []
    while len(speeds) < 1200:
        value = client.receive(30.0)
        assert value is not None, "nothing was told of the speed any more"
        if value.tag == "value":
            speeds.append(abs(float((value.findtext("velocity") or "0").split()[0])))
            if is_such(speeds[-1]):
                return
    raise AssertionError(f"it never had such a speed: {speeds[::100]}")


def wait_until_it_moves(client: Client) -> None:
    wait_for_speed(client, lambda speed_mps: speed_mps > 0.2)


def test_a_client_stops_the_robot_sends_it_on_an_errand_and_lets_the_mission_go_on(robot: Robot) -> None:
    with robot.client() as client:
        wait_until_it_moves(client)
        with pytest.raises(GatewayError) as refused:
            client.lease("acquire", ttl_s=60)
            client.request("run", node="MakeTurn", angle_deg="20")
        assert refused.value.code == "wrong-state", "a mission runs"
        with pytest.raises(WrongStateError, match="a mission is running; pause it first"):
            DriveProxy(client).set_velocity(0.1, 0.0)
        client.request("stop")
        wait_for_speed(client, lambda speed_mps: speed_mps <= 0.01)
        state = client.request("mission", op="state")
        assert (state.get("state"), state.get("reason")) == ("paused", "operator-stop")
        client.request("run", node="MakeTurn", angle_deg="30")
        assert _result(client) == "succeeded"
        with pytest.raises(GatewayError) as refused:
            client.request("run", node="GoTu", goal="1;1")
        assert refused.value.code == "unknown-node" and "GoTo" in refused.value.text
        client.request("mission", op="resume")
        wait_until_it_moves(client)
    code, result = robot.end()
    assert (code, result["result"], result["reason"], result["collisions"]) == (130, "STOPPED", "interrupted", 0)


def test_a_stop_and_a_resume_in_one_breath_let_the_mission_go_on(robot: Robot) -> None:
    with robot.client() as client:
        for _ in range(4):
            wait_until_it_moves(client)
            client.request("stop")
            client.request("mission", op="resume")
        wait_until_it_moves(client)
        state = client.request("mission", op="state")
        assert (state.get("state"), state.get("step")) == ("running", "go"), "it neither failed nor backed off"


def _result(client: Client) -> str:
    while True:
        message = client.receive(30.0)
        assert message is not None, "no result came"
        if message.tag == "result":
            return str(message.get("state"))


def test_the_shell_and_ps_are_clients_too(robot: Robot) -> None:
    where = f"127.0.0.1:{robot.port}"
    assert robot.pluto("shell", where, "pose").stdout.startswith("x ")
    stopped = robot.pluto("shell", where, "stop")
    assert (stopped.returncode, stopped.stdout) == (0, "stopped\n")
    assert robot.pluto("shell", where, "fly").returncode == 2
    listed = robot.pluto("ps", "--gateway", where, "--json")
    modules = {row["name"]: row["state"] for row in json.loads(listed.stdout)["modules"]}
    assert modules["drive"] == modules["executive"] == modules["gateway"] == "running"
    assert "GoTo" in robot.pluto("shell", where, "tree").stdout
    assert robot.pluto("stop", "--gateway", where).stdout == "stopped\n"
    assert robot.pluto("module", "stop", "compass", "--gateway", where).stdout == "compass stopped\n"
    refused = robot.pluto("module", "start", "compas", "--gateway", where)
    assert (refused.returncode, refused.stderr) == (1, 'pluto module: unknown-module: no module "compas"; did you mean "compass"?\n')
    drawn = robot.pluto("tree", "--gateway", where, "--format", "ascii").stdout
    assert re.match(r'\{c\} Sequence "patrol"  \[\* RUNNING [\d.]+ s', drawn), drawn


def test_rubbish_and_silent_clients_disturb_nobody(robot: Robot) -> None:
    silent = [socket.create_connection(("127.0.0.1", robot.port)) for _ in range(10)]
    for rubbish in (b"GET / HTTP/1.1\r\n\r\n", b"\x16\x03\x01\x02\x00\x01", b"<!DOCTYPE x>", b"\xff\xfe<", b"<ping>" * 300):
        with socket.create_connection(("127.0.0.1", robot.port), timeout=60) as one:
            one.sendall(rubbish)
            assert b'fatal="true"' in one.recv(65536)
    with robot.client() as client:
        wait_until_it_moves(client)
        assert client.request("ping", t="1").tag == "pong"
    for one in silent:
        one.close()
    code, result = robot.end(signal.SIGTERM)
    assert (code, result["collisions"]) == (130, 0)


def test_a_port_in_use_ends_the_run_before_it_begins() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        words = [*RUN[:-2], f"127.0.0.1:{taken.getsockname()[1]}", "--json"]
        ended = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode == 2
    assert "cannot listen on" in ended.stderr and json.loads(ended.stdout)["result"] == "REFUSED"
