"""`pluto bench gateway`: requests a second, parsing and encoding against lxml, what clients cost the robot's chain, a killed gateway."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import socket
from collections.abc import Callable, Iterator

from lxml import etree

from pluto_bt.bench.live import on_patrol
from pluto_bt.bench.processes import cpu_s, process_of
from pluto_bt.bench.row import BenchRow, best_pair_us
from pluto_bt.bench.silent_robot import TOPIC
from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.framing import Framer
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.values import body_of, value_line
from pluto_bt.runtime.clock import NS, wall_ns

CLIENTS, HZ = 100, 10.0
ASKERS, PIPELINED, ASK_S = 4, 50, 3.0
WATCH_S = 20.0
REQUESTS = (
    b"<ping/>", b'<get topic="Localization/Pose" id="c12"/>', b'<subscribe topic="Localization/Pose" max_rate_hz="5" on_change="false"/>',
    b'<lease op="acquire" ttl_s="2" on_loss="stop"/>', b'<run node="GoTo" goal="3;4" deadline_s="60" id="7"/>', b'<mission op="state" id="x1"/>',
    b'<command target="motion" flags="32" id="9"><position>1.5 2.5</position><velocity>0.5 0</velocity><force>1</force></command>',
)  # fmt: skip
VALUES: tuple[tuple[str, m.Message], ...] = (
    ("Localization/Pose", m.Pose(41.2, (12.345678, -3.141593, 0.0, 0.785398, 0.0, 0.0), (0.01, 0.0, 0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.02), 1)),
    ("motion/status", m.FVectorState(41.2, (0.25, -0.1), (0, -1, -2, 11))),
    ("drive/command", m.ActuatorState(41.2, 32, (3.0, 4.5), (0.5, 0.0), (0.1, 0.2), (1.0,))),
    ("sick/scan", m.LaserScan(41.2, -1.5708, 0.00873, m.read_only([0.01 * i for i in range(361)]), 361)),
)


def run() -> Iterator[BenchRow]:
    """All rows."""
    yield from _asking()
    yield _parsing()
    yield _encoding()
    yield from _beside_a_robot()


def _asking() -> Iterator[BenchRow]:
    with process_of("-m", "pluto_bt.bench.silent_robot", "50", "64") as process:
        assert process.stdout is not None
        port, pid = map(int, process.stdout.readline().split())
        connections = [socket.create_connection(("127.0.0.1", port)) for _ in range(ASKERS)]
        asked = "".join(f'<get topic="{TOPIC}" id="c{i}"/>\n' for i in range(PIPELINED)).encode()
        _ask(connections, asked, 0.5)
        before_s, begun_ns = cpu_s(pid), wall_ns()
        answers = _ask(connections, asked, ASK_S)
        used_s, took_s = cpu_s(pid) - before_s, (wall_ns() - begun_ns) / NS
        for connection in connections:
            connection.close()
    note = f"{answers / took_s:,.0f} a second of the wall, {ASKERS} clients with {PIPELINED} under way"
    yield BenchRow("get answered in a second of one core", answers / max(used_s, 1e-9), "1/s", ">= 30000", note)


def _ask(connections: list[socket.socket], asked: bytes, seconds: float) -> int:
    """Keep so many requests under way for so long; the answers."""
    waiting = dict.fromkeys(connections, 0)
    count, until_ns = 0, wall_ns() + round(seconds * NS)
    while wall_ns() < until_ns:
        for connection in connections:
            if waiting[connection] == 0:
                connection.sendall(asked)
                waiting[connection] = PIPELINED
        for connection in select.select(connections, [], [], 1.0)[0]:
            came = connection.recv(1 << 18).count(b"\n")
            waiting[connection] -= came
            count += came
    while any(waiting.values()):
        for connection in select.select(connections, [], [], 1.0)[0]:
            waiting[connection] -= connection.recv(1 << 18).count(b"\n")
    return count


def _parsing() -> BenchRow:
    """A usual mix of requests as they come from a socket, each against `fromstring` of the same bytes."""
    limits, mine, theirs = Limits(), 0.0, 0.0
    for request in REQUESTS:
        framer = Framer(limits)
        ours, lxmls = best_pair_us(lambda: list(framer.feed(request)), lambda: etree.fromstring(request), 4000)  # noqa: B023  # called before the loop goes on
        mine, theirs = mine + ours, theirs + lxmls
    note = f"{mine / len(REQUESTS):.2f} µs, lxml {theirs / len(REQUESTS):.2f} µs"
    return BenchRow("parse a request, gateway / lxml", mine / theirs, "×", "<= 1.0", note)


def _encoding() -> BenchRow:
    """Values as lines, each against an element that is built and serialised."""
    mine, theirs = 0.0, 0.0
    for topic, value in VALUES:
        ours, lxmls = best_pair_us(_encode(topic, value), _build(topic, value), 2000)
        mine, theirs = mine + ours, theirs + lxmls
    note = f"{mine / len(VALUES):.1f} µs, lxml {theirs / len(VALUES):.1f} µs"
    return BenchRow("encode a value, gateway / lxml", mine / theirs, "×", "<= 0.35", note)


def _encode(topic: str, value: m.Message) -> Callable[[], bytes]:
    return lambda: value_line(topic, 812, value.stamp_s, 0.031, body_of(value))


def _build(topic: str, value: m.Message) -> Callable[[], bytes]:
    """The same element by lxml, with the same texts, which are made anew too."""
    shape = etree.fromstring(_encode(topic, value)())
    fields = [(child.tag, dict(child.attrib), child.text) for child in shape]
    numbers = [[float(word) for word in text.split()] if text else None for _, _, text in fields]

    def build() -> bytes:
        line = etree.Element("value", topic=topic, seq="812", stamp=f"{value.stamp_s:.6f}", age=f"{0.031:.3f}", dropped="0")
        for (tag, attributes, _), values in zip(fields, numbers, strict=True):
            child = etree.SubElement(line, tag, attributes)
            if values is not None:
                child.text = " ".join(map(repr, values))
        return etree.tostring(line)

    return build


# beside a whole robot ------------------------------------------------------------------------------------------------
def _beside_a_robot() -> Iterator[BenchRow]:
    with on_patrol(f"gateway.clients={2 * CLIENTS}") as live:
        port, tell = live.port, live.tells
        _watch(port, 0, 3.0)
        tell()
        _watch(port, 0, WATCH_S)
        alone = tell()
        _watch(port, CLIENTS, WATCH_S)
        crowded = tell()
        name = f"lateness of the ticks, p99.9, with {CLIENTS} clients less without"
        note = f"without {alone['p999_ms']:.2f} ms, with {crowded['p999_ms']:.2f} ms, {crowded['ticks']} ticks"
        yield BenchRow(name, crowded["p999_ms"] - alone["p999_ms"], "ms", "<= 2", note)
        os.kill(int(crowded["pid"]), signal.SIGKILL)
        back_s = _until_it_answers(port)
        _watch(port, 0, 2.0)
        after = tell()
        note = f"mission {after['mission']}, {'gateway-restarted' if 'gateway-restarted' in after['events'] else 'not told'}"
        yield BenchRow("gateway killed: answers again after", back_s, "s", "<= 2", note)
        yield BenchRow("gateway killed: the worst lateness of a tick", after["worst_ms"], "ms", "<= 20", f"p50 {after['p50_ms']:.2f} ms")


def _watch(port: int, clients: int, seconds: float) -> None:
    """So many subscribers to the pose for so long."""
    with contextlib.ExitStack() as stack:
        poll = stack.enter_context(select.epoll())
        connections = {}
        for _ in range(clients):
            connection = stack.enter_context(socket.create_connection(("127.0.0.1", port)))
            connection.sendall(f'<subscribe topic="Localization/Pose" max_rate_hz="{HZ:g}"/>'.encode())
            connections[connection.fileno()] = connection
            poll.register(connection, select.EPOLLIN)
        until_ns = wall_ns() + round(seconds * NS)
        while wall_ns() < until_ns:
            for fd, _ in poll.poll(0.05):
                connections[fd].recv(65536)


def _until_it_answers(port: int) -> float:
    """Seconds until a new client is answered."""
    begun_ns = wall_ns()
    while wall_ns() - begun_ns < 30 * NS:
        with contextlib.suppress(GatewayError), Client(port=port, timeout_s=10.0) as client:
            client.request("ping")
            break
    return (wall_ns() - begun_ns) / NS


