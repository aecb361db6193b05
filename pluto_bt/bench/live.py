"""A robot on patrol in a process of its own (`live_robot`), from outside: what it tells, its clients, and how soon it stands."""

from __future__ import annotations

import json
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

from pluto_bt.bench.processes import process_of
from pluto_bt.gateway.client import Client
from pluto_bt.runtime.clock import NS, wait, wall_ns

MOVING_MPS, PATIENCE_S = 0.1, 30.0


class Live(NamedTuple):
    """The process, and the ports that it listens at: of the gateway, then, if it has them, of the ssh door and of the web console."""

    process: subprocess.Popen[bytes]
    ports: tuple[int, ...]

    @property
    def port(self) -> int:
        """Of the gateway."""
        return self.ports[0]

    def tells(self) -> dict[str, Any]:
        """What `live_robot` knows."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(b"\n")
        self.process.stdin.flush()
        told: dict[str, Any] = json.loads(self.process.stdout.readline())
        return told

    def client(self, name: str) -> Client:
        """A client of its gateway."""
        return Client(port=self.port, timeout_s=PATIENCE_S, name=name)

    def stood_ns(self) -> int:
        """When (wall) the base was last told to stand; waits until it is. Raises: TimeoutError."""
        pause, until_ns = threading.Event(), wall_ns() + PATIENCE_S * NS
        while wall_ns() < until_ns:
            told = self.tells()
            if told["stands"]:
                return int(told["zero_ns"])
            wait(pause, 0.01)
        raise TimeoutError("the robot does not stop")


@contextmanager
def on_patrol(*words: str) -> Iterator[Live]:
    """A robot that begins its patrol; `words` are those of `live_robot`. It is killed at the end."""
    with process_of("-m", "pluto_bt.bench.live_robot", *words) as process:
        assert process.stdout is not None
        yield Live(process, tuple(map(int, process.stdout.readline().split())))


def drive_on(operator: Client) -> None:
    """The mission goes on, and the robot moves. Raises: TimeoutError."""
    if operator.request("mission", op="state").get("state") == "paused":
        operator.request("mission", op="resume")
    pause, until_ns = threading.Event(), wall_ns() + PATIENCE_S * NS
    while wall_ns() < until_ns:
        told = operator.request("get", topic="drive/status").findtext("data") or "0"
        if abs(float(told.split()[0])) > MOVING_MPS:
            return
        wait(pause, 0.02)
    raise TimeoutError("the robot does not move")
