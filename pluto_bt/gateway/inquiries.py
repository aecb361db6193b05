"""What the executive answers without doing anything."""

from __future__ import annotations

from pluto_bt.blackboard.messages import TreeState
from pluto_bt.gateway import replies, requests
from pluto_bt.gateway.leases import Held
from pluto_bt.gateway.port import RefusedError, RobotPort
from pluto_bt.gateway.replies import AnyReply, LeaseState, LogLine, Mission, Tree, Value
from pluto_bt.gateway.subscriptions import ALIASES
from pluto_bt.gateway.wire import Key, pack_value
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


def why(port: RobotPort, request: requests.Why) -> replies.Why:
    """Why the robot moves or not. Raises: RefusedError `out-of-range` for a time that is not known (any more)."""
    is_moving, causes = port.why(request.at)
    return replies.Why(is_moving=is_moving, causes=tuple(causes))


def mission(port: RobotPort, request: requests.MissionOp) -> Mission | None:
    """The answer to `state`, `list` and `fetch`; None for what does something. Raises: RefusedError for a mission that is not there."""
    match request.op:
        case "state":
            return Mission(state=port.mission_state())
        case "list":
            return Mission(state=port.mission_state(), names=tuple(port.mission_names()))
        case "fetch":
            return Mission(state=port.mission_state(), text=port.mission_text(request.name))
    return None


def lease(held: Held | None, key: Key, now_s: float) -> LeaseState:
    """The lease as `key` sees it."""
    if held is None:
        return LeaseState(holder="", mine=False, epoch=0, expires_s=0.0)
    return LeaseState(holder=held.name, mine=held.key == key, epoch=held.epoch, expires_s=max(0.0, held.until_s - now_s))


def log(port: RobotPort, request: requests.Log) -> list[AnyReply]:
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
