"""Connections for the client's tests: to a gateway in the same thread, on a clock that goes on only while the client waits."""

from __future__ import annotations

from pluto_bt.gateway.backoff import Backoff
from pluto_bt.gateway.client import Client
from pluto_bt.gateway.local import LocalClient, LocalGateway
from pluto_bt.gateway.port import RobotPort

from .robot import FakeRobot

STEP_S = 0.02
SOON = Backoff(0.1, 2.0, 1.0)


class Line:
    """A socket of the client, its other end at a `LocalGateway`."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._end: LocalClient = bench.gateway.connect()
        self._timeout_s = 0.0
        self.is_broken = False

    def settimeout(self, value: float | None) -> None:
        assert value is not None and value > 0.0, "a client that may wait for ever hangs"
        self._timeout_s = value

    def recv(self, size: int) -> bytes:
        """What the gateway says; time goes on until it does."""
        until_s = self._bench.now_s + self._timeout_s
        while not self.is_broken:
            data = b"" if self._bench.is_silent else self._end.received()
            if data:
                return data
            if self._end.is_over:
                self.close()
                break
            if self._bench.now_s >= until_s:
                raise TimeoutError
            self._bench.go_on(min(STEP_S, until_s - self._bench.now_s))
        return b""

    def sendall(self, data: bytes) -> None:
        if self.is_broken:
            raise BrokenPipeError("Broken pipe")
        if not self._bench.is_deaf:
            self._end.send(data)

    def fileno(self) -> int:
        return 3

    def close(self) -> None:
        self.is_broken = True
        self._end.close()


class Bench:
    """A robot, its gateway, time, and lines that the test breaks.

    Attributes:
        tried_s: when a client tried to connect.
        is_down: no connection is taken. is_silent: nothing comes back. is_deaf: what is sent is lost.
    """

    def __init__(self, port: RobotPort | None = None) -> None:
        self.robot = FakeRobot()
        self.gateway = LocalGateway(port or self.robot)
        self.now_s = 0.0
        self.lines: list[Line] = []
        self.tried_s: list[float] = []
        self.is_down = self.is_silent = self.is_deaf = False
        self.on_step = lambda: None

    def go_on(self, seconds: float) -> None:
        """Time goes on; the gateway steps."""
        self.now_s += seconds
        self.robot.time_s = self.now_s
        self.on_step()
        self.gateway.step(self.now_s)

    def connect(self, timeout_s: float) -> Line:
        self.tried_s.append(round(self.now_s, 3))
        if self.is_down:
            raise ConnectionRefusedError(111, "Connection refused")
        self.lines.append(Line(self))
        return self.lines[-1]

    def cut(self) -> None:
        """The line breaks, and the gateway notices."""
        self.lines[-1].close()

    def client(self, backoff: Backoff | None = SOON, **given: str) -> Client:
        return Client(connect=self.connect, clock=lambda: self.now_s, wait=self.go_on, backoff=backoff, **given)  # type: ignore[arg-type]
