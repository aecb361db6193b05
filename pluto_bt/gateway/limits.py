"""What a client may do to the gateway: every bound of PROTOCOL.md, section Framing, by name. Table [gateway] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

Bytes = Annotated[int, Meta(ge=1024, le=1 << 30)]
Count = Annotated[int, Meta(ge=1, le=1 << 20)]
Seconds = Annotated[float, Meta(gt=0.0, le=86400.0)]


class Limits(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Defaults are the contract's; all can be set."""

    message_bytes: Annotated[Bytes, Meta(description="bytes since the last complete message, white space included")] = 64 * 1024
    mission_bytes: Annotated[Bytes, Meta(description="the same once a mission has begun")] = 1024 * 1024
    depth: Annotated[Count, Meta(description="elements inside each other, the message itself counted")] = 16
    mission_depth: Annotated[Count, Meta(description="the same inside a mission, the mission itself not counted")] = 256
    attributes: Annotated[Count, Meta(description="attributes of one element, declarations of name-spaces included")] = 32
    names: Annotated[Count, Meta(description="different names of elements, attributes and name-spaces in one mission")] = 4096
    documents: Annotated[Count, Meta(description="messages of more than 16 KiB that all clients together may have under way; others wait")] = 2
    document_s: Annotated[Seconds, Meta(description="how long the sending of one may take while others wait")] = 3.0
    messages_per_s: Annotated[float, Meta(gt=0.0, description="messages a second of one client, and at once; stops do not count")] = 200.0
    clients: Annotated[Count, Meta(description="connections at one time")] = 64
    operator_places: Annotated[
        int, Meta(ge=0, le=1024, description="the last of them: only for who stops the robot or says hello as an operator")
    ] = 2
    hello_s: Annotated[Seconds, Meta(description="time for hello where a token is demanded, and in an operator's place")] = 3.0
    idle_s: Annotated[Seconds, Meta(description="time without any byte from the client")] = 60.0
    outstanding: Annotated[Count, Meta(description="requests of one client that wait for the executive; more are answered with busy")] = 64
    backlog_bytes: Annotated[Bytes, Meta(description="replies that one client may leave unread before it is a slow consumer")] = 512 * 1024
    write_mark_bytes: Annotated[Bytes, Meta(description="unsent bytes above which values wait, and old ones are dropped")] = 16 * 1024
    linger_s: Annotated[Seconds, Meta(description="after a fatal error input is thrown away for this long, so that the error arrives")] = 1.0
    discard_bytes: Annotated[Bytes, Meta(description="but no more than this; then nothing is read any more")] = 16 * 1024 * 1024
