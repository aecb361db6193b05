"""What the server says: one struct a message, the same on the wire between the processes, and its XML line.

`id` is that of the request it answers ("" = it had none). The error codes are those of PROTOCOL.md, section Errors.
"""

from __future__ import annotations

from typing import TypeAlias

import msgspec
import msgspec.structs

from pluto_bt.blackboard.messages import Event, MissionState, ModulesState, NodeState
from pluto_bt.gateway.xml_text import Attribute, element, escape

# fmt: off
FATAL_CODES = ("not-well-formed", "restricted-xml", "bad-encoding", "too-large", "too-deep", "rate-limit", "slow-consumer", "timeout",
               "too-many-connections", "unsupported-version", "unauthorised", "shutdown")
CODES = ("invalid", "unknown-element", "unknown-topic", "unknown-node", "unknown-param", "unknown-module", "no-value", "bad-value", "out-of-range",
         "read-only", "no-lease", "lease-held", "wrong-state", "conflict", "estopped", "bad-mission", "busy", "internal")
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
    """What exists."""

    items: tuple[Item, ...]


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


def row(tag: str, struct: msgspec.Struct, body: str = "") -> str:
    """A struct as one element, a field an attribute."""
    fields: dict[str, Attribute] = {name: getattr(struct, name) for name in struct.__struct_fields__}
    return element(tag, fields, body)


def _error(reply: Error) -> str:
    place: dict[str, Attribute] = {"line": reply.line, "col": reply.column} if reply.line else {}
    return _with_id(reply, "error", {"code": reply.code, **place, "fatal": reply.fatal}, escape(reply.text))


def _with_id(reply: Reply, tag: str, attributes: dict[str, Attribute], body: str = "") -> str:
    return element(tag, {"id": reply.id, **attributes} if reply.id else attributes, body)


def _mission(reply: Mission) -> str:
    state = reply.state
    shown: dict[str, Attribute] = {"name": state.name, "run": state.run, "state": state.state, "reason": state.reason, "step": state.step}
    body = "".join(element("mission", {"name": name}) for name in reply.names)
    return _with_id(reply, "mission_state", shown, body + (element("document", {}, escape(reply.text)) if reply.text else ""))


def _tree(reply: Tree) -> str:
    body = "".join(row("node", node) for node in reply.nodes) or escape(reply.text)
    return _with_id(reply, "tree", {"tick": reply.tick, "format": reply.format}, body)


def _why(reply: Why) -> str:
    return _with_id(reply, "why", {"moving": reply.is_moving}, "".join(map(_cause, reply.causes)))


def _cause(cause: Cause) -> str:
    shown: dict[str, Attribute] = {"layer": cause.layer, "code": cause.code, "text": cause.text, "unblock": cause.unblock}
    return element("cause", {**shown, "since": _seconds(cause.since_s), "age": f"{cause.age_s:.3f}"})


def _event(reply: LogLine) -> str:
    event = reply.event
    shown: dict[str, Attribute] = {"level": event.level, "code": event.code, "source": event.source, "seq": reply.seq}
    shown |= {"time": _seconds(event.stamp_s), "cleared": reply.is_cleared}
    return _with_id(reply, "event", shown, escape(event.text))


def _params(reply: ParamsState) -> str:
    rows = []
    for one in reply.rows:
        shown: dict[str, Attribute] = {name: getattr(one, name) for name in one.__struct_fields__ if name != "value"}
        rows.append(element("p", shown, escape(one.value)))
    return _with_id(reply, "params", {"rev": reply.rev, "confirm_s": f"{reply.confirm_s:.3f}"}, "".join(rows))


def _description(reply: Description) -> str:
    items = []
    for item in reply.items:
        fields = "".join(element("field", dict(field)) for field in item.fields)
        items.append(element("item", dict(item.attributes), fields + element("doc", {}, escape(item.doc))))
    return _with_id(reply, "description", {}, "".join(items))


def encode(reply: AnyReply) -> bytes:
    """The reply as one line of XML (`Value` has its own encoder: `values.value_line`)."""
    return (_text(reply) + "\n").encode()


def _text(reply: AnyReply) -> str:  # one case a message: longer than a screen of logic, but a table
    match reply:
        case Hello():
            caps = "".join(element("cap", {}, escape(cap)) for cap in reply.capabilities)
            shown: dict[str, Attribute] = {"version": "1.0", "robot": reply.robot, "session": reply.session, "time": _seconds(reply.time_s)}
            return _with_id(reply, "hello", shown, caps)
        case Pong():
            return _with_id(reply, "pong", {"t": reply.t, "time": _seconds(reply.time_s)})
        case Ok():
            return _with_id(reply, "ok", {}, escape(reply.text))
        case Error():
            return _error(reply)
        case LeaseState():
            shown = {"holder": reply.holder, "mine": reply.mine, "epoch": reply.epoch, "expires_s": f"{reply.expires_s:.3f}"}
            return _with_id(reply, "lease_state", shown)
        case Ack():
            return _with_id(reply, "ack", {"run": reply.run})
        case Progress():
            return _with_id(reply, "progress", {"run": reply.run, "state": reply.state, "text": reply.text})
        case Result():
            outs = "".join(element("out", {"name": name}, escape(value)) for name, value in reply.outputs)
            return _with_id(reply, "result", {"run": reply.run, "state": reply.state, "reason": reply.reason, "text": reply.text}, outs)
        case Mission():
            return _mission(reply)
        case Tree():
            return _tree(reply)
        case Modules():
            return _with_id(reply, "modules", {}, "".join(row("module", module) for module in reply.state.modules))
        case Why():
            return _why(reply)
        case ParamsState():
            return _params(reply)
        case LogLine():
            return _event(reply)
        case Description():
            return _description(reply)
        case Value():
            raise TypeError("a value is encoded by values.value_line")


def _seconds(time_s: float) -> str:
    return f"{time_s:.6f}"
