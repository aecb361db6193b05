"""Replies as lines of XML: one element a message, as PROTOCOL.md has it."""

from __future__ import annotations

import msgspec

from pluto_bt.gateway import replies
from pluto_bt.gateway.replies import AnyReply, Cause, Reply
from pluto_bt.gateway.xml_text import Attribute, element, escape


def encode(reply: AnyReply) -> bytes:
    """The reply as one line of XML (`Value` has its own encoder: `values.value_line`)."""
    return (_text(reply) + "\n").encode()


def _text(reply: AnyReply) -> str:  # one case a message: longer than a screen of logic, but a table
    match reply:
        case replies.Hello():
            caps = "".join(element("cap", {}, escape(cap)) for cap in reply.capabilities)
            shown: dict[str, Attribute] = {"version": "1.0", "robot": reply.robot, "session": reply.session, "time": _seconds(reply.time_s)}
            return _with_id(reply, "hello", shown, caps)
        case replies.Pong():
            return _with_id(reply, "pong", {"t": reply.t, "time": _seconds(reply.time_s)})
        case replies.Ok():
            return _with_id(reply, "ok", {}, escape(reply.text))
        case replies.Error():
            return _error(reply)
        case replies.LeaseState():
            shown = {"holder": reply.holder, "mine": reply.mine, "epoch": reply.epoch, "expires_s": f"{reply.expires_s:.3f}"}
            return _with_id(reply, "lease_state", shown)
        case replies.Ack():
            return _with_id(reply, "ack", {"run": reply.run})
        case replies.Progress():
            return _with_id(reply, "progress", {"run": reply.run, "state": reply.state, "text": reply.text})
        case replies.Result():
            outs = "".join(element("out", {"name": name}, escape(value)) for name, value in reply.outputs)
            return _with_id(reply, "result", {"run": reply.run, "state": reply.state, "reason": reply.reason, "text": reply.text}, outs)
        case replies.Mission():
            return _mission(reply)
        case replies.Tree():
            return _tree(reply)
        case replies.Modules():
            return _with_id(reply, "modules", {}, "".join(row("module", module) for module in reply.state.modules))
        case replies.Why():
            return _why(reply)
        case replies.ParamsState():
            return _params(reply)
        case replies.LogLine():
            return _event(reply)
        case replies.Description():
            return _with_id(reply, "description", {}, "".join(reply.items))
        case replies.Value():
            raise TypeError("a value is encoded by values.value_line")


def row(tag: str, struct: msgspec.Struct, body: str = "") -> str:
    """A struct as one element, a field an attribute."""
    fields: dict[str, Attribute] = {name: getattr(struct, name) for name in struct.__struct_fields__}
    return element(tag, fields, body)


def _error(reply: replies.Error) -> str:
    place: dict[str, Attribute] = {"line": reply.line, "col": reply.column} if reply.line else {}
    return _with_id(reply, "error", {"code": reply.code, **place, "fatal": reply.fatal}, escape(reply.text))


def _with_id(reply: Reply, tag: str, attributes: dict[str, Attribute], body: str = "") -> str:
    return element(tag, {"id": reply.id, **attributes} if reply.id else attributes, body)


def _mission(reply: replies.Mission) -> str:
    state = reply.state
    shown: dict[str, Attribute] = {"name": state.name, "run": state.run, "state": state.state, "reason": state.reason, "step": state.step}
    body = "".join(element("mission", {"name": name}) for name in reply.names)
    return _with_id(reply, "mission_state", shown, body + (element("document", {}, escape(reply.text)) if reply.text else ""))


def _tree(reply: replies.Tree) -> str:
    body = "".join(row("node", node) for node in reply.nodes) or escape(reply.text)
    return _with_id(reply, "tree", {"tick": reply.tick, "format": reply.format}, body)


def _why(reply: replies.Why) -> str:
    return _with_id(reply, "why", {"moving": reply.is_moving}, "".join(map(_cause, reply.causes)))


def _cause(cause: Cause) -> str:
    shown: dict[str, Attribute] = {"layer": cause.layer, "code": cause.code, "text": cause.text, "unblock": cause.unblock}
    return element("cause", {**shown, "since": _seconds(cause.since_s), "age": f"{cause.age_s:.3f}"})


def _event(reply: replies.LogLine) -> str:
    event = reply.event
    shown: dict[str, Attribute] = {"level": event.level, "code": event.code, "source": event.source, "seq": reply.seq}
    shown |= {"time": _seconds(event.stamp_s), "cleared": reply.is_cleared}
    return _with_id(reply, "event", shown, escape(event.text))


def _params(reply: replies.ParamsState) -> str:
    rows = []
    for one in reply.rows:
        shown: dict[str, Attribute] = {name: getattr(one, name) for name in one.__struct_fields__ if name != "value"}
        rows.append(element("p", shown, escape(one.value)))
    return _with_id(reply, "params", {"rev": reply.rev, "confirm_s": f"{reply.confirm_s:.3f}"}, "".join(rows))


def _seconds(time_s: float) -> str:
    return f"{time_s:.6f}"
