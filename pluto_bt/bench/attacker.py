"""Clients who mean harm, in a process of their own: `python -m pluto_bt.bench.attacker ATTACK PORT SECONDS`. For the gateway's tests and benchmarks.

Each attack goes on for so long, beginning anew when it is cut off; at the end it prints one JSON line: how often it was cut off, the codes it was
told, the most bytes that one connection took, and the longest time until it was cut off.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator

from pluto_bt.runtime.clock import NS, wait, wall_ns

CHUNK = 64 * 1024
DOCUMENT_S = 3.0
GIGABYTE = 1 << 30
BOMB = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10 if i else "lol"}">' for i in range(10))


def begin(attack: str, port: int, seconds: float) -> subprocess.Popen[str]:
    """An attack in a process of its own; what it prints at its end is one line of JSON."""
    command = [sys.executable, "-m", "pluto_bt.bench.attacker", attack, str(port), str(seconds)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def now_s() -> float:
    """Of the wall."""
    return wall_ns() / NS


def endless(head: bytes, filler: bytes, tail: bytes = b"") -> Callable[[], Iterator[bytes]]:
    """A message whose middle has a gigabyte."""

    def stream() -> Iterator[bytes]:
        yield head
        block = filler * (CHUNK // len(filler))
        for _ in range(GIGABYTE // CHUNK):
            yield block
        yield tail

    return stream


def once(data: bytes) -> Callable[[], Iterator[bytes]]:
    """These bytes alone."""
    return lambda: iter([data])


STREAMS: dict[str, Callable[[], Iterator[bytes]]] = {
    "attribute": endless(b'<ping t="', b"a", b'"/>'),
    "text": endless(b"<ping>", b"a b ", b"</ping>"),
    "name": endless(b"<", b"n", b"/>"),
    "comment": endless(b"<ping><!--", b"- ", b"--></ping>"),
    "white-space": endless(b"", b" \n"),
    "mission": endless(b'<mission op="load"><root>', b"<a/>", b"</root></mission>"),
    "attributes": endless(b"<ping ", b'a="1" ', b"/>"),
    "bomb": once(f'<!DOCTYPE a [{BOMB}]><ping t="&a9;"/>'.encode()),
    "xxe": once(b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><ping t="&x;"/>'),
    "inner-doctype": once(b'<ping><!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>&x;</ping>'),
    "undefined-entity": once(b'<ping t="&nothing;"/>'),
    "xinclude": once(b'<mission op="check"><root><xi:include href="file:///etc/passwd" parse="text"/></root></mission>x'),
    "instruction": once(b'<ping><?xml-stylesheet href="file:///etc/passwd"?></ping>'),
    "mission-names": lambda: iter([b'<mission op="check"><root>', *(b'<n%d a%d=""/>' % (i, i) for i in range(40_000)), b"</root></mission>"]),
    "depth": endless(b"", b"<a>"),
    "mission-depth": endless(b'<mission op="load"><root>', b"<a>"),
    "utf-16": once('<ping t="1"/>'.encode("utf-16")),
    "nul": once(b'<ping t="\0"/>'),
    "bad-utf-8": once(b'<ping t="\xc3\x28"/>'),
    "cut-utf-8": once(b'<ping t="\xe2\x82"/>'),
    "encoding": once(b'<?xml version="1.0" encoding="UTF-7"?><ping/>'),
    "tls": once(b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(500)),
    "http": once(b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n"),
    "pings": lambda: iter([b"<ping/>" * 10_000] * 20),
    "stops": lambda: iter([b"<stop/>" * 10_000] * 20),
    "gets": lambda: iter([b'<get topic="sick/scan"/>' * 2_000] * 20),
    "describes": lambda: iter([b"<describe/>" * 5_000] * 20),
    "new-names": lambda: (new_name() for _ in range(1_000)),
}


def new_name() -> bytes:
    """A message whose tag nobody has ever heard."""
    name = b"n%d." % wall_ns() + b"x" * 2_000
    return b"<" + name + b"><!-- --></" + name + b">"


def shout(stream: Callable[[], Iterator[bytes]], port: int, until_s: float) -> dict[str, object]:
    """Send a stream again and again, `until_s` of the wall."""
    cuts, most, longest_s = 0, 0, 0.0
    codes: set[str] = set()
    while now_s() < until_s or not cuts:
        begun_s, sent, heard = now_s(), 0, bytearray()
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=10.0) as connection:
            try:
                for chunk in stream():
                    connection.sendall(chunk)
                    sent += len(chunk)
                connection.shutdown(socket.SHUT_WR)
            except OSError:
                pass
            with contextlib.suppress(OSError):
                while data := connection.recv(CHUNK):
                    heard += data
        cuts, most, longest_s = cuts + 1, max(most, sent), max(longest_s, now_s() - begun_s)
        codes |= {word.split(b'"')[0].decode() for word in heard.split(b'code="')[1:]}
    return {"cuts": cuts, "codes": sorted(codes), "most_bytes": most, "longest_s": round(longest_s, 2)}


def crowd(port: int, until_s: float, count: int, each: Callable[[socket.socket], None]) -> dict[str, object]:
    """So many connections at once; `each` is done with every one of them again and again."""
    connections: list[socket.socket] = []
    while now_s() < until_s:
        while len(connections) < count:
            with contextlib.suppress(OSError):
                connections.append(socket.create_connection(("127.0.0.1", port), timeout=5.0))
                connections[-1].setblocking(False)
        for connection in list(connections):
            try:
                each(connection)
            except BlockingIOError:
                pass
            except OSError:
                connections.remove(connection)
        wait(threading.Event(), 0.02)
    return {"cuts": 0, "codes": [], "most_bytes": 0, "longest_s": 0.0}


def one_more_byte(connection: socket.socket) -> None:
    """Of a message that never ends."""
    connection.send(b"<")


def never_read(connection: socket.socket) -> None:
    """Ask for all there is, and read nothing."""
    connection.send(b'<subscribe topic="*"/><describe/><modules/><log/>' * 5)


def documents(port: int, until_s: float) -> dict[str, object]:
    """Sixty at a time send a mission of a megabyte, and hang up."""
    node = b'<GoTo goal="1;2"/>'
    document = b'<mission op="check"><root><Sequence>' + node * (1_000_000 // len(node)) + b"</Sequence></root></mission>"
    cuts = 0

    def one() -> None:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=DOCUMENT_S) as connection:
            connection.sendall(document)

    while now_s() < until_s or not cuts:
        crowd = [threading.Thread(target=one) for _ in range(60)]
        for sender in crowd:
            sender.start()
        for sender in crowd:
            sender.join()
        cuts += len(crowd)
    return {"cuts": cuts, "codes": [], "most_bytes": len(document), "longest_s": 0.0}


def storm(port: int, until_s: float) -> dict[str, object]:
    """Connect and go, as fast as can be."""
    cuts = 0
    while now_s() < until_s:
        with contextlib.suppress(OSError):
            socket.create_connection(("127.0.0.1", port), timeout=5.0).close()
            cuts += 1
    return {"cuts": cuts, "codes": [], "most_bytes": 0, "longest_s": 0.0}


def burn(port: int, until_s: float) -> dict[str, object]:
    """No attack: a program that only needs the processor."""
    while now_s() < until_s:
        hashlib.sha256(bytes(CHUNK)).digest()
    return {}


CROWDS: dict[str, tuple[int, Callable[[socket.socket], None]]] = {
    "slowloris": (40, one_more_byte),
    "half-open": (60, lambda connection: None),
    "200-connections": (200, lambda connection: None),
    "never-read": (8, never_read),
}


def main() -> None:
    """One attack."""
    name, port, until_s = sys.argv[1], int(sys.argv[2]), now_s() + float(sys.argv[3])
    if name in STREAMS:
        told = shout(STREAMS[name], port, until_s)
    elif name in CROWDS:
        told = crowd(port, until_s, *CROWDS[name])
    else:
        told = {"storm": storm, "documents": documents, "burn": burn}[name](port, until_s)
    print(json.dumps(told))


if __name__ == "__main__":
    main()
