"""`pluto bench fanout`: one value to very many clients, against plain uvloop writes and foxglove-sdk, in turns.

The server's processor time is that of the process that sends; delivery is from the writing of the value to its reading by the client.
"""

from __future__ import annotations

import base64
import os
import re
import select
import socket
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pluto_bt.bench.processes import cpu_s, process_of
from pluto_bt.bench.row import BenchRow
from pluto_bt.bench.silent_robot import TOPIC
from pluto_bt.runtime.clock import NS, wall_ns

CLIENTS, FEW = 1000, 100
HZ, SOURCE_HZ = 10.0, 50.0
SETTLE_S, MEASURE_S, ROUNDS = 2.0, 6.0, 2
BASELINE = Path(os.environ.get("PLUTO_SHARED") or Path(__file__).resolve().parents[2].parent / "shared") / "bench" / "fanout_baseline.py"
_SENT = re.compile(rb"T=(\d{19})")


class Measured(NamedTuple):
    """Processor seconds of the server for a thousand values delivered, and the delivery times."""

    cpu_ms_a_value: float
    p50_ms: float
    p99_ms: float
    values: int


def run() -> Iterator[BenchRow]:
    """Rows for 1000 clients and for 100."""
    own = [_ours(CLIENTS)]
    plain = [_baseline("uvloop", CLIENTS)]
    for _ in range(ROUNDS - 1):
        own.append(_ours(CLIENTS))
        plain.append(_baseline("uvloop", CLIENTS))
    mine, uvloop = min(own), min(plain)
    note = f"{CLIENTS} clients at {HZ:g} Hz, {mine.values} and {uvloop.values} values"
    yield BenchRow("processor time, gateway / uvloop", mine.cpu_ms_a_value / uvloop.cpu_ms_a_value, "×", "<= 1.5", note)
    yield BenchRow("processor time of a value", 1e3 * mine.cpu_ms_a_value, "µs", "", f"uvloop {1e3 * uvloop.cpu_ms_a_value:.3g} µs")
    best, its = min(one.p99_ms for one in own), min(one.p99_ms for one in plain)
    note = f"{best:.3g} ms, uvloop {its:.3g} ms; p50 {mine.p50_ms:.3g}, {uvloop.p50_ms:.3g} ms"
    yield BenchRow("delivery p99, gateway / uvloop", best / its, "×", "<= 1", note)
    yield _foxglove(mine)
    few = min((_ours(FEW) for _ in range(ROUNDS)), key=lambda one: one.p99_ms)
    yield BenchRow(f"delivery p99 with {FEW} clients", few.p99_ms, "ms", "<= 10", f"p50 {few.p50_ms:.3g} ms")


def _foxglove(mine: Measured) -> BenchRow:
    """Against foxglove-sdk, if that is installed (PYTHONPATH)."""
    if find_spec("foxglove") is None:
        return BenchRow("processor time, gateway / foxglove-sdk", float("nan"), "×", "<= 0.4", "not installed: pip install foxglove-sdk")
    other = min(_baseline("foxglove", CLIENTS) for _ in range(ROUNDS))
    note = f"foxglove-sdk {1e3 * other.cpu_ms_a_value:.3g} µs, p99 {other.p99_ms:.3g} ms"
    return BenchRow("processor time, gateway / foxglove-sdk", mine.cpu_ms_a_value / other.cpu_ms_a_value, "×", "<= 0.4", note)


def _ours(clients: int) -> Measured:
    with process_of("-m", "pluto_bt.bench.silent_robot", str(SOURCE_HZ), str(clients + 100)) as process:
        assert process.stdout is not None
        port, pid = map(int, process.stdout.readline().split())
        hello = f'<subscribe topic="{TOPIC}" max_rate_hz="{HZ:g}"/>'.encode()
        return _listen(port, pid, clients, lambda connection: connection.sendall(hello))


def _baseline(kind: str, clients: int) -> Measured:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with process_of(str(BASELINE), kind, str(port), f"{HZ:g}") as process:
        return _listen(port, process.pid, clients, _say_hello_websocket if kind == "foxglove" else lambda connection: None)


def _connect(port: int) -> socket.socket:
    """A connection; the server may still be starting."""
    until_ns = wall_ns() + 30 * NS
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=30.0)
        except OSError:
            if wall_ns() > until_ns:
                raise
            select.select([], [], [], 0.1)


def _say_hello_websocket(connection: socket.socket) -> None:
    """The handshake of foxglove's protocol, and a subscription to its first channel, masked with zeros."""
    key = base64.b64encode(b"0123456789abcdef").decode()
    connection.sendall(
        f"GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n".encode()
    )
    heard = b""
    while b'"advertise"' not in heard:
        heard += connection.recv(65536)
    channel = re.search(rb'"channels":\[\{[^]]*?"id":(\d+)', heard)
    wish = b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":%b}]}' % (channel[1] if channel else b"1")
    connection.sendall(bytes([0x81, 0x80 | len(wish)]) + bytes(4) + wish)


def _listen(port: int, pid: int, clients: int, hello: Callable[[socket.socket], None]) -> Measured:
    """Connect so many clients, let them settle, then measure."""
    poll = select.epoll()
    connections: dict[int, socket.socket] = {}
    try:
        for _ in range(clients):
            connection = _connect(port)
            hello(connection)
            connection.setblocking(False)
            connections[connection.fileno()] = connection
            poll.register(connection, select.EPOLLIN)
        _read(poll, connections, SETTLE_S)
        before_s = cpu_s(pid)
        delays_ms = _read(poll, connections, MEASURE_S)
        used_s = cpu_s(pid) - before_s
    finally:
        for connection in connections.values():
            connection.close()
        poll.close()
    p50, p99 = np.percentile(delays_ms, [50.0, 99.0]) if len(delays_ms) else (np.inf, np.inf)
    return Measured(1e3 * used_s / max(1, len(delays_ms)), float(p50), float(p99), len(delays_ms))


def _read(poll: select.epoll, connections: dict[int, socket.socket], seconds: float) -> list[float]:
    """Delivery times (ms) of all values that come in so many seconds."""
    delays: list[float] = []
    until_ns = wall_ns() + round(seconds * NS)
    while wall_ns() < until_ns:
        for fd, _ in poll.poll(0.05):
            data = connections[fd].recv(65536)
            now_ns = wall_ns()
            delays += [(now_ns - int(sent)) / 1e6 for sent in _SENT.findall(data)]
    return delays
