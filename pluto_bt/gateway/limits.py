"""What a client may do to the gateway: every bound of PROTOCOL.md, section Framing, by name."""

from __future__ import annotations

import msgspec


class Limits(msgspec.Struct, frozen=True, kw_only=True):
    """Defaults are the contract's; all can be set."""

    message_bytes: int = 64 * 1024
    """Bytes since the last complete message, white space included."""
    mission_bytes: int = 1024 * 1024
    """The same once a `mission` has begun."""
    depth: int = 16
    """Elements inside each other, the message itself counted."""
    mission_depth: int = 256
    """The same inside a `mission`, the `mission` itself not counted."""
    attributes: int = 32
    """Attributes of one element, name-space declarations included."""
    messages_per_s: float = 200.0
    """Sustained rate and burst of one client; `stop` and `estop` do not count."""
    clients: int = 64
    """Connections at one time."""
    operator_places: int = 2
    """The last of them: only for who stops the robot or says hello as an operator."""
    hello_s: float = 3.0
    """Time for hello where a token is demanded."""
    idle_s: float = 60.0
    """Time without any byte from the client."""
    outstanding: int = 64
    """Requests of one client that wait for the executive; more are answered with `busy`."""
    backlog_bytes: int = 256 * 1024
    """Replies that one client may leave unread before it is a slow consumer."""
    write_mark_bytes: int = 16 * 1024
    """Unsent bytes in our buffers above which values wait (and old ones are dropped)."""
    linger_s: float = 1.0
    """After a fatal error input is thrown away for this long, so that the error arrives."""
    discard_bytes: int = 16 * 1024 * 1024
    """But no more than this; then nothing is read any more."""
