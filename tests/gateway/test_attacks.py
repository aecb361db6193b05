"""Clients who mean harm, over real sockets: told why and cut off, all others served, no memory taken, nothing moved.

How long the others wait meanwhile is measured by `pluto bench attacks`.
"""

from __future__ import annotations

import contextlib
import json
import socket
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from pluto_bt.bench.attacker import CROWDS, STREAMS, begin
from pluto_bt.bench.resident import resident_mb
from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.client import GatewayError
from pluto_bt.gateway.places import LONG_BYTES
from pluto_bt.gateway.replies import Item
from pluto_bt.runtime.clock import wait, wall_ns

from .conftest import Running

ATTACK_S, PING_EVERY_S, WAIT_S = 0.3, 0.006, 60.0
GROWTH_MB = 10.0
CODE = {
    "attribute": "too-large", "text": "too-large", "name": "too-large", "comment": "too-large", "white-space": "too-large", "mission": "too-large",
    "mission-names": "too-large",
    "attributes": "too-large", "bomb": "restricted-xml", "xxe": "restricted-xml", "inner-doctype": "restricted-xml",
    "undefined-entity": "restricted-xml", "instruction": "restricted-xml", "xinclude": "not-well-formed", "depth": "too-deep",
    "mission-depth": "too-deep", "utf-16": "bad-encoding", "nul": "not-well-formed", "bad-utf-8": "bad-encoding", "cut-utf-8": "bad-encoding",
    "encoding": "bad-encoding", "tls": "not-well-formed", "http": "not-well-formed", "pings": "rate-limit", "stops": "rate-limit",
    "gets": "rate-limit", "describes": "rate-limit", "new-names": "rate-limit",
}  # fmt: skip
ON_THE_WAY = {"busy", "bad-mission", "unknown-element"}
"""What an attacker may hear before he is cut off."""
INSTEAD = {"describes": {"slow-consumer"}}
"""What he may hear in its stead: who asks for the longest answers may be cut off for those that he has not read."""
STREAM_TAKES = 40 * 1024 * 1024
"""What one connection may still bring after the cut: `discard_bytes`, and what lies in the kernel's buffers."""


class Target(Running):
    """A gateway with a scan that changes, as much to describe as a robot has, and a polite client."""

    def __init__(self) -> None:
        super().__init__(items=[Item({"kind": "node", "name": f"node {number}"}, (), "what it does " * 20) for number in range(500)])
        scan = m.read_only([12.34] * 361)
        self.on_step = lambda: self.robot.write("sick/scan", m.LaserScan(self.robot.time_s, 0.0, 0.01, scan))
        self.pump()
        self.polite = self.client(name="operator")

    def under(self, attack: str) -> dict[str, Any]:
        """What the attacker was told; the polite client asks all the while, and is answered. Who waited before him with long messages is gone."""
        self.polite.request("ping", t="x" * 2 * LONG_BYTES)
        with begin(attack, self.address.port, ATTACK_S) as process:
            pause = threading.Event()
            while process.poll() is None:
                self.polite.request("ping")
                wait(pause, PING_EVERY_S)
            assert process.stdout is not None
            told: dict[str, Any] = json.loads(process.stdout.read())
        return told

    def rss_mb(self) -> float:
        return resident_mb(self.link.pid)


@pytest.fixture(scope="module")
def target() -> Iterator[Target]:
    one = Target()
    one.under("pings")  # what is taken once and kept: the library's own buffers and tables
    one.under("never-read")
    yield one
    one.polite.close()
    one.end()


@pytest.mark.parametrize("attack", [*STREAMS, *CROWDS, "storm", "documents"])
def test_an_attack_hurts_nobody_but_himself(target: Target, attack: str) -> None:
    before_mb, deeds = target.rss_mb(), len(target.robot.did)
    told = target.under(attack)
    assert target.rss_mb() - before_mb < GROWTH_MB
    assert not {deed[0] for deed in target.robot.did[deeds:]} & {"run", "command"}
    if attack in CODE:
        ends, heard = {CODE[attack], *INSTEAD.get(attack, ())}, set(told["codes"])
        assert ends & heard and heard <= ends | ON_THE_WAY, told
        assert told["most_bytes"] <= STREAM_TAKES


def test_two_hundred_connections_leave_operators_their_places(target: Target) -> None:
    with begin("200-connections", target.address.port, 600.0) as process:
        try:
            while "last places are for operators" not in refusal_of_a_stranger(target):
                wait(threading.Event(), 0.1)  # strangers who come as fast as they can are cut off without a word
            stops = target.robot.did.count(("stop", "shell"))
            with target.client(name="shell") as operator:
                assert operator.request("stop").tag == "ok"
            assert target.robot.did.count(("stop", "shell")) == stops + 1
        finally:
            process.kill()


def refusal_of_a_stranger(target: Target) -> str:
    """What one more client is told."""
    with contextlib.suppress(ConnectionError), socket.create_connection(target.address, timeout=WAIT_S) as stranger:
        stranger.sendall(b"<ping/>")
        return stranger.recv(65536).decode()
    return ""


def test_every_stop_during_a_flood_is_heard(target: Target) -> None:
    heard = 0
    with begin("pings", target.address.port, 1.0) as process, target.client(name="passer") as passer:
        while process.poll() is None:
            assert passer.request("stop").tag == "ok"
            heard += 1
            assert target.robot.did.count(("stop", "passer")) == heard, "answered, but not obeyed before"
    assert heard >= 10


def test_the_holder_of_the_lease_vanishes(running: Running) -> None:
    holder = running.client(name="anna", session="s")
    holder.lease("acquire", ttl_s=0.5)
    holder.send("run", node="GoTo", goal="3;4")
    lost = threading.Event()
    stop = running.robot.stop
    running.robot.stop = lambda source: (stop(source), lost.set())[0]  # type: ignore[method-assign,func-returns-value]
    begun_ns = wall_ns()  # he goes on pinging, but does not renew: his program hangs
    while not lost.is_set() and wall_ns() - begun_ns < WAIT_S * 1e9:
        holder.request("ping")
        wait(lost, 0.01)
    assert lost.is_set() and ("stop", "the lease of anna ran out") in running.robot.did
    holder.close()


def test_two_who_take_the_lease_from_each_other_stop_the_robot_each_time(running: Running) -> None:
    with running.client(name="anna") as anna, running.client(name="ben") as ben:
        for taker in (anna, ben) * 5:
            assert taker.lease("take", ttl_s=5).get("mine") == "true"
        assert [deed for deed in running.robot.did if deed[0] == "stop"] == [
            ("stop", f"the lease of {loser} was taken by {taker}") for loser, taker in (("anna", "ben"), ("ben", "anna")) * 5
        ][:9]
        with pytest.raises(GatewayError) as refused:
            anna.request("run", node="GoTo", goal="1;1")
        assert refused.value.code == "no-lease"


def test_one_id_with_two_contents_acts_once(running: Running) -> None:
    with running.client(name="a", session="twice") as client, running.client(name="b", session="twice") as other:
        client.lease("acquire", ttl_s=30)
        for one in (client, other):
            one.send("run", node="GoTo", goal="1;1", id="7")
            assert one.receive(WAIT_S).tag == "ack"  # type: ignore[union-attr]
        other.send("run", node="GoTo", goal="2;2", id="7")
        while (answer := other.receive(WAIT_S)) is not None and answer.tag != "error":
            pass
        assert answer is not None and answer.get("code") == "conflict"
    assert [deed for deed in running.robot.did if deed[0] == "run"] == [("run", "GoTo", {"goal": "1;1"}, 0.0)]
