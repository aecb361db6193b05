"""What the server says: one struct a message, the same on the wire between the processes; `encode.py` makes its XML line.

`id` is that of the request it answers ("" = it had none). The error codes are those of PROTOCOL.md, section Errors.
"""

from __future__ import annotations

from typing import TypeAlias

import msgspec
import msgspec.structs

from pluto_bt.blackboard.messages import Event, MissionState, ModulesState, NodeState

# fmt: off
FATAL_CODES = ("not-well-formed", "restricted-xml", "bad-encoding", "too-large", "too-deep", "rate-limit", "slow-consumer", "timeout",
               "too-many-connections", "unsupported-version", "unauthorised", "shutdown")
CODES = ("invalid", "unknown-element", "unknown-topic", "unknown-node", "unknown-param", "unknown-module", "no-value", "bad-value", "out-of-range",
         "read-only", "no-lease", "lease-held", "wrong-state", "conflict", "estopped", "bad-mission", "busy", "internal")
CAPABILITIES = ("get", "subscribe", "lease", "command", "run", "stop", "estop", "mission", "tree", "why", "modules", "params", "set", "describe",
                "log")
# fmt: on
RUN_FINAL = ("succeeded", "failed", "cancelled", "preempted", "timeout")


class Reply(msgspec.Struct, frozen=True, kw_only=True, tag=True, gc=False):
    """Root of all replies."""

    id: str = ""


class Hello(Reply, frozen=True, kw_only=True):
    """Who answers, and what he can do."""

    robot: str
    session: str
    time_s: float
    capabilities: tuple[str, ...]


class Pong(Reply, frozen=True, kw_only=True):
    """The client's `t` back, and the run's clock."""

    t: str
    time_s: float


class Ok(Reply, frozen=True, kw_only=True):
    """Done; `text` says more where there is more to say."""

    text: str = ""


class Error(Reply, frozen=True, kw_only=True):
    """Refused: `text` names what was expected and found."""

    code: str
    text: str
    line: int = 0
    column: int = 0

    @property
    def fatal(self) -> bool:
        """True if the connection closes behind it."""
        return self.code in FATAL_CODES


class LeaseState(Reply, frozen=True, kw_only=True):
    """Who may drive; `expires_s` = seconds left, `epoch` counts the holders."""

    holder: str
    mine: bool
    epoch: int
    expires_s: float


class Ack(Reply, frozen=True, kw_only=True):
    """A run has begun."""

    run: str


class Progress(Reply, frozen=True, kw_only=True):
    """A run goes on."""

    run: str
    state: str
    text: str


class Result(Reply, frozen=True, kw_only=True):
    """A run is over; `outputs` are the node's output ports."""

    run: str
    state: str
    reason: str
    text: str
    outputs: tuple[tuple[str, str], ...] = ()


class Mission(Reply, frozen=True, kw_only=True):
    """The mission's state, for `list` the missions there are, for `fetch` the document."""

    state: MissionState
    names: tuple[str, ...] = ()
    text: str = ""


class Tree(Reply, frozen=True, kw_only=True):
    """The tree now: as nodes, or drawn as text."""

    tick: int
    format: str
    text: str = ""
    nodes: tuple[NodeState, ...] = ()


class Modules(Reply, frozen=True, kw_only=True):
    """Every module of the run."""

    state: ModulesState


class Cause(msgspec.Struct, frozen=True):
    """One link of the chain of causes; `since_s` = second of the run, `age_s` = of what it is read from."""

    layer: str
    code: str
    text: str
    since_s: float
    age_s: float = 0.0
    unblock: str = ""


class Why(Reply, frozen=True, kw_only=True):
    """Why the robot is, or is not, moving, the first cause first."""

    is_moving: bool
    causes: tuple[Cause, ...]


class Param(msgspec.Struct, frozen=True):
    """One parameter as it is now. `live`: it can be changed while the robot runs; the others are set when it starts."""

    name: str
    value: str
    type: str
    unit: str
    range: str
    default: str
    live: bool


class ParamsState(Reply, frozen=True, kw_only=True):
    """Parameters; `rev` counts the changes; `confirm_s` = seconds after which an unconfirmed change goes back, 0 = all is confirmed."""

    rev: int
    confirm_s: float = 0.0
    rows: tuple[Param, ...] = ()


class LogLine(Reply, frozen=True, kw_only=True):
    """One event for operators; `is_cleared`: what it told of is over."""

    event: Event
    seq: int
    is_cleared: bool = False


class Item(msgspec.Struct, frozen=True):
    """One thing that exists: its attributes (`kind` and `name` first), its fields or ports, and what it means."""

    attributes: dict[str, str]
    fields: tuple[dict[str, str], ...]
    doc: str


class Description(Reply, frozen=True, kw_only=True):
    """What exists: each item as its element, ready to be sent."""

    items: tuple[str, ...]


class Value(Reply, frozen=True, kw_only=True):
    """The answer to `get`: the newest value, packed as `wire.pack_value` does."""

    topic: str
    seq: int
    age_s: float
    payload: bytes


AnyReply: TypeAlias = (
    Hello | Pong | Ok | Error | LeaseState | Ack | Progress | Result | Mission | Tree | Modules | Why | ParamsState | LogLine | Description | Value
)


def with_id(reply: AnyReply, id: str) -> AnyReply:
    """The same reply to another request."""
    return msgspec.structs.replace(reply, id=id)
