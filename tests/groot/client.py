"""A client of the monitor's protocol, written from its description alone: what Groot2 does, without the pictures."""

from __future__ import annotations

import struct
from typing import Any, NamedTuple
from xml.etree import ElementTree

import msgspec
import zmq

HEADER, STATUS = struct.Struct("<BcI"), struct.Struct("<HB")


class Reply(NamedTuple):
    """A reply: the tree's id and the payload, or the text of an error."""

    tree_id: bytes
    payload: bytes | None
    error: str = ""


class GrootClient:
    """REQ on the port of the monitor."""

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.REQ)
        self._socket.setsockopt(zmq.RCVTIMEO, 120_000)  # a busy machine may take so long to begin a run
        self._socket.setsockopt(zmq.LINGER, 0)
        self._socket.connect(f"tcp://{host}:{port}")
        self._number = 0x01020300

    def __enter__(self) -> GrootClient:
        return self

    def __exit__(self, *unused: object) -> None:
        self._context.destroy(linger=0)

    def raw(self, *parts: bytes) -> list[bytes]:
        self._socket.send_multipart(parts)
        return self._socket.recv_multipart()

    def ask(self, kind: bytes, *more: bytes) -> Reply:
        self._number += 1
        parts = self.raw(HEADER.pack(2, kind, self._number), *more)
        if parts[0] == b"error":
            return Reply(b"", None, parts[1].decode())
        assert len(parts[0]) == 22 and HEADER.unpack(parts[0][:6]) == (2, kind, self._number)
        return Reply(parts[0][6:], parts[1] if len(parts) > 1 else None)

    def tree(self) -> ElementTree.Element:
        return ElementTree.fromstring(self.ask(b"T").payload or b"")

    def statuses(self) -> dict[int, int]:
        return dict(STATUS.iter_unpack(self.ask(b"S").payload or b""))

    def boards(self, *names: str) -> Any:
        return msgspec.msgpack.decode(self.ask(b"B", ";".join(names).encode()).payload or b"")

    def changes(self) -> list[tuple[int, int, int]]:
        """(microseconds, node, status)."""
        data = self.ask(b"t").payload or b""
        return [(int.from_bytes(data[i : i + 6], "little"), *STATUS.unpack(data[i + 6 : i + 9])) for i in range(0, len(data), 9)]
