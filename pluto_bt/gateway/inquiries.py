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
CLEARS = {"estop-released": ("estop", False), "module-restarted": ("module-error", True), "gateway-restarted": ("gateway-lost", True)}
"""The code of an event -> (the code of those that it clears, whether only those of the same source)."""


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
    """The events that `log` asks for, each with whether a later one has said that it is over."""
    hidden = _LEVELS[: _LEVELS.index(request.level)]
    lines: list[AnyReply] = []
    over: set[tuple[str, str]] = set()  # (code, source; "" = whoever)
    for seq, event in reversed(port.events_after(request.since)):
        is_cleared = not over.isdisjoint({(event.code, event.source), (event.code, "")})
        if event.code in CLEARS:
            over.add((CLEARS[event.code][0], event.source if CLEARS[event.code][1] else ""))
        if event.level not in hidden:
            lines.append(LogLine(id=request.id, seq=seq, event=event, is_cleared=is_cleared))
    return lines[::-1]
