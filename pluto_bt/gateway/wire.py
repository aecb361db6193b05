"""The frames between the gateway process and the executive: msgpack structs behind a length, over one Unix socket."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import msgspec
import numpy as np

from pluto_bt.blackboard.messages import Event, Message, read_only
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.gateway.access import Access
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.replies import AnyReply, Item
from pluto_bt.gateway.requests import AnyRequest

TYPES: dict[str, type[Message]] = {topic.name: topic.type for topic in TOPICS}
FRAME_LIMIT = 64 * 1024 * 1024
_HEAD_BYTES = 4


class Frame(msgspec.Struct, frozen=True, tag=True, gc=False):
    """Root of all frames."""


Key: TypeAlias = int | tuple[str, str]
"""Whose a lease is: a connection, or (person, his named session). The two never meet, whatever a client calls himself."""


class Ask(Frame, frozen=True):
    """Up: a client's request. `client` counts connections; `session` is "" without a named session; `name` and `peer` (his address) are for logs.
    `size_bytes` is that of the message;
    `person` is his name where names are proved (by token or certificate), else "": a session of one is closed to the others.
    """

    client: int
    session: str
    name: str
    request: AnyRequest
    peer: str = ""
    person: str = ""
    size_bytes: int = 0

    @property
    def key(self) -> Key:
        """Under what his lease and outcomes stand."""
        return (self.person, self.session) if self.session else self.client


def source_of(ask: Ask) -> str:
    """What logs call the client."""
    return ask.name or ask.session or f"client {ask.client}"


class Gone(Frame, frozen=True):
    """Up: a client is no more."""

    client: int


class Refused(Frame, frozen=True):
    """Up, for the audit log alone: what a client may not do, refused before it came to the executive; `what` is its element."""

    client: int
    session: str
    name: str
    peer: str
    what: str
    code: str
    text: str


class Watch(Frame, frozen=True):
    """Up: the topics that anybody subscribed to, all of them."""

    topics: tuple[str, ...]


class Alive(Frame, frozen=True):
    """Up, now and then: the gateway goes round."""


class Scenery(msgspec.Struct, frozen=True):
    """What the web console draws and what does not change: JSON of the map and the robot, and the pictures (PNG) that it names."""

    json: bytes
    pictures: dict[str, bytes] = {}


class Welcome(Frame, frozen=True):
    """Down, first: what the gateway must know; `scenery` only where there is a web console."""

    robot: str
    now_s: float
    topics: tuple[str, ...]
    access: Access
    limits: Limits
    first_client: int
    catalogue: tuple[Item, ...] = ()
    scenery: Scenery | None = None


class Stamped(msgspec.Struct, frozen=True, gc=False):
    """A value on its way to subscribers."""

    topic: str
    seq: int
    written_s: float
    payload: bytes


class Batch(Frame, frozen=True):
    """Down: the newest values of the watched topics that changed, and the events since the last batch."""

    now_s: float
    values: tuple[Stamped, ...]
    events: tuple[tuple[int, Event], ...]


class Answer(Frame, frozen=True):
    """Down: a reply. Each request has one `direct` reply (a stop one of its own kind, for it overtakes); `later` ones follow up."""

    client: int
    lane: Literal["direct", "stop", "later"]
    reply: AnyReply


class Farewell(Frame, frozen=True):
    """Down, last: tell the clients and end."""


Up: TypeAlias = Ask | Gone | Watch | Refused | Alive
Down: TypeAlias = Welcome | Batch | Answer | Farewell


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tobytes()
    raise TypeError(f"a message holds a {type(value).__name__}; the wire carries numbers, words, tuples and float64 arrays")


def _array(kind: type[Any], value: Any) -> Any:
    if isinstance(value, bytes):
        return read_only(np.frombuffer(value, dtype=np.float64))
    raise TypeError(f"expected bytes for {kind}, found {type(value).__name__}")


_encoder = msgspec.msgpack.Encoder(enc_hook=_plain)
_up = msgspec.msgpack.Decoder(Up)
_down = msgspec.msgpack.Decoder(Down)


def pack(frame: Up | Down) -> bytes:
    """A frame with its length before it."""
    body = _encoder.encode(frame)
    return len(body).to_bytes(_HEAD_BYTES, "big") + body


def pack_value(value: Message) -> bytes:
    """A message of the blackboard; its type is that of its topic."""
    return _encoder.encode(value)


def unpack_value(topic: str, payload: bytes) -> Message:
    """The message back. Raises: KeyError for a topic that is not in the table."""
    return msgspec.msgpack.decode(payload, type=TYPES[topic], dec_hook=_array)


class Frames:
    """Cuts a stream of bytes into frames, and reads them as what the other side sends."""

    def __init__(self, *, up: bool) -> None:
        self._decoder: msgspec.msgpack.Decoder[Any] = _up if up else _down
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Any]:
        """The frames that `data` completes. Raises: msgspec.DecodeError, ValueError if the other side speaks nonsense."""
        self._buffer += data
        frames = []
        at = 0
        while len(self._buffer) - at >= _HEAD_BYTES:
            size = int.from_bytes(self._buffer[at : at + _HEAD_BYTES], "big")
            if size > FRAME_LIMIT:
                raise ValueError(f"a frame of {size} bytes; expected at most {FRAME_LIMIT}")
            if len(self._buffer) - at - _HEAD_BYTES < size:
                break
            frames.append(self._decoder.decode(memoryview(self._buffer)[at + _HEAD_BYTES : at + _HEAD_BYTES + size]))
            at += _HEAD_BYTES + size
        del self._buffer[:at]
        return frames
