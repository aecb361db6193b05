"""A robot on patrol in a process of its own (`live_robot`), from outside: what it tells, its clients, and how soon it stands."""

from __future__ import annotations

import json
import subprocess
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple, TypeVar

from pluto_bt.bench.processes import process_of
from pluto_bt.gateway.client import Client
from pluto_bt.runtime.clock import NS, wait, wall_ns

MOVING_MPS, ASK_EVERY_S, PATIENCE_S = 0.1, 0.01, 30.0
T = TypeVar("T")


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

        def told_ns() -> int | None:
            told = self.tells()
            return int(told["zero_ns"]) if told["stands"] else None

        return until(told_ns, "the robot does not stop")


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

    def moves() -> bool | None:
        told = operator.request("get", topic="drive/status").findtext("data") or "0"
        return abs(float(told.split()[0])) > MOVING_MPS or None

    until(moves, "the robot does not move")


def until(ask: Callable[[], T | None], trouble: str) -> T:
    """Ask again and again until there is an answer. Raises: TimeoutError with the words of `trouble`."""
    pause, until_ns = threading.Event(), wall_ns() + round(PATIENCE_S * NS)
    while wall_ns() < until_ns:
        answer = ask()
        if answer is not None:
            return answer
        wait(pause, ASK_EVERY_S)
    raise TimeoutError(trouble)
