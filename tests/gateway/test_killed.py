"""The gateway's process is killed while a whole robot is on patrol: the mission goes on, clients come back, and a lease keeps its word."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.runtime.clock import NS, wall_ns


class Live:
    """A patrol in a process of its own."""

    def __init__(self) -> None:
        command = [sys.executable, "-m", "pluto_bt.bench.live_robot"]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        assert self.process.stdout is not None
        self.port = int(self.process.stdout.readline())

    def tells(self) -> dict[str, Any]:
        """Pid of the gateway, state of the mission, events, lateness."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())  # type: ignore[no-any-return]

    def client(self, **given: str) -> Client:
        return Client(port=self.port, timeout_s=20.0, **given)

    def kill_gateway(self) -> None:
        """SIGKILL, and wait until a new client is answered (how long that takes: `pluto bench gateway`)."""
        os.kill(int(self.tells()["pid"]), signal.SIGKILL)
        begun_ns = wall_ns()
        while wall_ns() - begun_ns < 30 * NS:
            try:
                with self.client() as client:
                    client.request("ping")
                return
            except GatewayError:
                continue
        raise AssertionError("it never came back")


@pytest.fixture(scope="module")
def live() -> Iterator[Live]:
    one = Live()
    yield one
    assert one.process.stdin is not None
    one.process.stdin.close()
    one.process.wait(60.0)


def until(client: Client, state: str) -> None:
    """Wait for the mission to be so."""
    begun_ns = wall_ns()
    while (found := client.request("mission", op="state").get("state")) != state:
        assert wall_ns() - begun_ns < 30 * NS, f"expected {state}, found {found}"
        client.receive(0.02)


def let_it_run(live: Live) -> None:
    """The mission runs, whatever an earlier test left."""
    with live.client() as client:
        if live.tells()["mission"] == "paused":
            client.request("mission", op="resume")
        until(client, "running")


def test_a_mission_without_a_lease_does_not_notice(live: Live) -> None:
    let_it_run(live)
    live.kill_gateway()
    told = live.tells()
    assert told["mission"] == "running" and {"gateway-lost", "gateway-restarted"} <= set(told["events"])


@pytest.mark.parametrize(("session", "on_loss", "state"), [("", "stop", "paused"), ("", "continue", "running"), ("s", "stop", "running")])
def test_a_lease_keeps_its_word(live: Live, session: str, on_loss: str, state: str) -> None:
    let_it_run(live)
    with live.client(name="anna", session=session) as holder:
        holder.lease("acquire", ttl_s=30, on_loss=on_loss)
        live.kill_gateway()
    with live.client(name="anna", session=session) as again:
        until(again, state)
        held = again.lease("query")
        assert held.get("mine") == ("true" if session else "false"), "who has a named session may come back within his ttl"
        if session:
            again.lease("release")
