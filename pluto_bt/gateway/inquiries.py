"""What the executive answers from the blackboard alone."""

from __future__ import annotations

from pluto_bt.blackboard.messages import TreeState
from pluto_bt.gateway.port import RefusedError, RobotPort
from pluto_bt.gateway.replies import AnyReply, LogLine, Tree, Value
from pluto_bt.gateway.requests import Log
from pluto_bt.gateway.subscriptions import ALIASES
from pluto_bt.gateway.wire import pack_value
from pluto_bt.source import did_you_mean

_LEVELS = ("info", "warning", "error")


def newest(port: RobotPort, topic: str) -> Value:
    """The answer to `get`. Raises: RefusedError (`unknown-topic`, `no-value`)."""
    name = ALIASES.get(topic, topic)
    known = port.topics()
    if name not in known:
        raise RefusedError("unknown-topic", f'unknown topic "{topic}"; {did_you_mean(topic, known) or "<describe/> lists all"}')
    found = port.newest(name)
    if found is None:
        raise RefusedError("no-value", f'"{topic}" has no value yet')
    return Value(topic=topic, seq=found.seq, age_s=port.now_s() - found.written_s, payload=pack_value(found.value))


def tree(port: RobotPort, format: str) -> Tree:
    """The tree now: its nodes for `xml`, a drawing for `ascii` and `dot`. Raises: RefusedError `no-value`."""
    found = port.newest("tree")
    state = found.value if found else None
    if not isinstance(state, TreeState):
        raise RefusedError("no-value", "there is no tree yet")
    if format == "xml":
        return Tree(tick=state.tick, format=format, nodes=state.nodes)
    return Tree(tick=state.tick, format=format, text=port.tree_text(format))


def log(port: RobotPort, request: Log) -> list[AnyReply]:
    """The events that `log` asks for."""
    hidden = _LEVELS[: _LEVELS.index(request.level)]
    return [LogLine(id=request.id, seq=seq, event=event) for seq, event in port.events_after(request.since) if event.level not in hidden]
