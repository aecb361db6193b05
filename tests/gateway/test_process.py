"""The gateway as it runs on the robot: its own process, real sockets, clients who behave and clients who do not."""

from __future__ import annotations

import errno
import os
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.access import Access
from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.errors import TurnedAwayError
from pluto_bt.gateway.exchange import Exchange
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.link import GatewayLink
from pluto_bt.gateway.listen import Address, open_listener, parse_address
from pluto_bt.gateway.wire import pack
from pluto_bt.source import InputError

from .conftest import Running
from .robot import FakeRobot

WAIT_S = 60.0


def talk(address: Address, data: bytes) -> bytes:
    """Send, half-close, and read until the gateway closes: what `nc -N` does."""
    with socket.create_connection(address, timeout=WAIT_S) as connection:
        connection.sendall(data)
        connection.shutdown(socket.SHUT_WR)
        return read_all(connection)


def read_all(connection: socket.socket) -> bytes:
    said = b""
    while data := connection.recv(65536):
        said += data
    return said


def test_a_person_talks_to_it_by_hand(running: Running) -> None:
    running.robot.write("Localization/Pose", m.Pose(0.0))
    said = talk(running.address, b'<hello version="1.0"/>\n<get topic="Localization/Pose"/>\n<stop/>\n').splitlines()
    assert [line.split(b" ")[0] for line in sorted(said)] == [b"<hello", b"<ok/>", b"<value"]
    assert running.robot.did == [("stop", "client 1")]


def test_who_has_said_all_drives_no_more(running: Running) -> None:
    stopped, stop = threading.Event(), running.robot.stop
    running.robot.stop = lambda source: (stop(source), stopped.set())[0]  # type: ignore[method-assign,func-returns-value]
    said = talk(running.address, b'<lease op="acquire" ttl_s="60"/><run id="r" node="GoTo" goal="3;4"/>').splitlines()
    assert [line.split(b" ")[0] for line in said] == [b"<lease_state", b"<ack"]
    assert stopped.wait(WAIT_S)
    assert [deed[0] for deed in running.robot.did][:2] == ["run", "stop"]


@pytest.mark.parametrize(
    ("rubbish", "code"),
    [
        (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n" + b"x" * 300_000, b"not-well-formed"),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"not-well-formed"),
        (b"<a b='" + b"v" * 300_000, b"too-large"),
        (b"<ping t='1'/>" * 1000, b"rate-limit"),
    ],
)
def test_rubbish_is_told_why_and_then_closed(running: Running, rubbish: bytes, code: bytes) -> None:
    with socket.create_connection(running.address, timeout=WAIT_S) as connection:
        connection.sendall(rubbish)
        said = read_all(connection)  # to the end: a reset would raise
    assert b'<error code="' + code + b'"' in said.splitlines()[-1] and b'fatal="true"' in said


def test_a_stop_acts_although_the_executive_does_not_step(unpumped: Running) -> None:
    with unpumped.client() as client:
        assert client.request("stop").tag == "ok"
    assert unpumped.robot.did == [("stop", "client 1")]


def test_floods_and_sleepers_disturb_nobody(running: Running) -> None:
    robot = running.robot
    scan = m.read_only([12.34] * 2000)
    running.on_step = lambda: robot.write("sick/scan", m.LaserScan(robot.time_s, 0.0, 0.01, scan))
    over = threading.Event()

    def flood() -> None:
        while not over.is_set():
            try:
                with socket.create_connection(running.address, timeout=WAIT_S) as connection:
                    connection.sendall(b"<get topic='sick/scan'/>" * 50_000)
            except OSError:
                continue

    sleeper = socket.socket()
    sleeper.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    sleeper.settimeout(WAIT_S)
    sleeper.connect(running.address)
    sleeper.sendall(b'<subscribe topic="sick/scan"/>')
    floods = [threading.Thread(target=flood, daemon=True) for _ in range(2)]
    try:
        for thread in floods:
            thread.start()
        with running.client(name="watcher") as watcher, running.client(name="stopper") as stopper:
            watcher.subscribe("sick/scan")
            stamps = []
            while len(stamps) < 100:
                value = watcher.receive(WAIT_S)
                assert value is not None
                stamps.append(float(value.get("stamp", "")))
                if len(stamps) % 10 == 0:
                    assert stopper.request("stop").tag == "ok"
        assert stamps == sorted(stamps)
        assert robot.did.count(("stop", "stopper")) == 10
    finally:
        over.set()
    lost, buffer = 0, b""
    while not lost:  # what the sleeper finds when he wakes
        *lines, buffer = (buffer + sleeper.recv(65536)).split(b"\n")
        lost = max([0, *(int(line.split(b'dropped="')[1].split(b'"')[0]) for line in lines if b"dropped=" in line)])
    sleeper.close()
    for thread in floods:
        thread.join(WAIT_S)


def test_a_killed_gateway_comes_back_and_loses_nothing(running: Running) -> None:
    run = '<run id="7" node="GoTo" goal="3;4"/>'
    first = running.client(name="anna", session="s1")
    first.lease("acquire", ttl_s=60, on_loss="stop")
    first.send_raw(run.encode())
    assert first.receive(WAIT_S).tag == "ack"  # type: ignore[union-attr]
    pid = running.link.pid
    assert pid is not None
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(GatewayError, match=r"closed|gone"):
        while True:
            first.receive(WAIT_S)
    with running.client(name="anna", session="s1") as again:
        assert again.lease("query").get("mine") == "true"
        again.send_raw(run.encode())
        assert again.receive(WAIT_S).tag == "ack"  # type: ignore[union-attr]
        assert again.request("stop").tag == "ok"
    assert running.link.restarts == 1
    assert [deed[0] for deed in running.robot.did][:2] == ["run", "stop"]


def test_a_gateway_that_hangs_is_replaced(running: Running) -> None:
    with running.client(name="anna") as held:
        pid = running.link.pid
        assert pid is not None
        os.kill(pid, signal.SIGSTOP)
        with pytest.raises(GatewayError, match=r"closed|gone"):
            held.receive(WAIT_S)
    with running.client(name="ben") as client:
        assert client.request("stop").tag == "ok"
    assert running.link.restarts == 1 and running.link.pid not in (None, pid)


@pytest.mark.parametrize("module", ["subprocess.Popen", "socket.socketpair", "pluto_bt.gateway.link.Courier"])
def test_a_computer_without_room_for_a_process_has_its_gateway_later(monkeypatch: pytest.MonkeyPatch, module: str) -> None:
    def refuse(*given: object, **named: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files")

    link = GatewayLink(FakeRobot(), Address("127.0.0.1", 0))
    link.listen()
    open_before = len(os.listdir("/dev/fd"))
    with monkeypatch.context() as patch:
        patch.setattr(module, refuse)
        link.start(0.0)
        link.step(0.0)
        assert link.is_lost and len(os.listdir("/dev/fd")) == open_before
    link.step(0.1)
    assert link.is_lost, "it was refused twice: not at once again"
    link.step(60.0)
    try:
        assert link.address is not None
        with Client(*link.address, timeout_s=WAIT_S, backoff=None, name="x") as client:
            assert client.request("ping").tag == "pong"
    finally:
        link.stop()


def test_the_end_of_the_run_is_told_to_all(running: Running) -> None:
    with running.client(name="x") as client:
        running.end()
        with pytest.raises(TurnedAwayError) as error:
            client.receive(WAIT_S)
    assert error.value.code == "shutdown"


def test_an_executive_who_is_gone_without_a_word_is_mourned_in_silence(tmp_path: Path) -> None:
    ours, theirs = socket.socketpair()
    with open_listener(Address("127.0.0.1", 0)) as listener, (tmp_path / "told").open("w") as told:
        words = [sys.executable, "-c", "from pluto_bt.gateway.process import main; main()", str(theirs.fileno()), str(listener.fileno()), "-1"]
        process = subprocess.Popen(words, pass_fds=(theirs.fileno(), listener.fileno()), stderr=told)
        theirs.close()
        ours.sendall(pack(Exchange(FakeRobot(), lambda frame: None).welcome(Access(), Limits(linger_s=0.3), 1)))
        with Client(*listener.getsockname(), timeout_s=WAIT_S, backoff=None, name="x") as client:
            client.subscribe("Localization/Pose")
            client.send("get", topic="sick/scan")
            ours.close()
            with pytest.raises(GatewayError):
                while True:
                    client.receive(WAIT_S)
        assert process.wait(WAIT_S) == 0
    assert (tmp_path / "told").read_text() == ""


def test_a_client_without_a_gateway_is_told_so() -> None:
    with open_listener(Address("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    with pytest.raises(GatewayError, match=f"no gateway at 127.0.0.1:{port}: Connection refused"):
        Client("127.0.0.1", port)


def test_bad_addresses_are_faults() -> None:
    with open_listener(Address("127.0.0.1", 0)) as taken, pytest.raises(InputError) as error:
        open_listener(Address(*taken.getsockname()))
    assert "cannot listen on 127.0.0.1" in str(error.value) and "mend      stop the other program" in str(error.value)
    with pytest.raises(InputError, match="without TLS and tokens"):
        open_listener(Address("0.0.0.0", 0))
    with pytest.raises(InputError, match="expected  HOST:PORT"):
        parse_address("127.0.0.1:http")
    assert parse_address("[::1]:80") == Address("::1", 80)
    assert parse_address(":7501") == Address("127.0.0.1", 7501)
    assert parse_address("localhost") == Address("localhost", 7500)


def test_a_large_document_holds_up_nobody_but_its_sender(running: Running) -> None:
    begun, may_end = threading.Event(), threading.Event()

    def read_long(text: str) -> None:
        begun.set()
        may_end.wait(WAIT_S)

    running.robot.on_prepare = read_long  # type: ignore[assignment]
    with running.client(name="anna") as anna, running.client(name="ben") as ben:
        anna.send_raw(b'<mission op="load" id="a"><root/></mission><mission op="start" id="b"/>')
        assert begun.wait(WAIT_S)
        assert ben.lease("acquire", ttl_s=30).get("mine") == "true"
        assert not [deed for deed in running.robot.did if deed[0] == "mission"]
        ben.lease("release")
        may_end.set()
        assert [anna.receive(WAIT_S).get("id") for _ in "ab"] == ["a", "b"]  # type: ignore[union-attr]
    assert [deed[1] for deed in running.robot.did if deed[0] == "mission"] == ["load", "start"]
