"""What a mission remembers, as plain JSON: statuses and memory of its nodes, and its blackboard. Taken after a tick, given back after a crash.

A leaf that was RUNNING begins again when it is given back; everything above it goes on where it stood. What is paced by time or way (Timeout,
Delay, Sleep, Nav2's RateController and its like) begins its pace anew: the time of the crash belongs to nobody.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import Any, Final

from pluto_bt.behaviours.ports import text_of
from pluto_bt.trees.decorators.updated import UpdateWatch
from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.leaves.constant import AlwaysSuccess
from pluto_bt.trees.mission import Mission
from pluto_bt.trees.nav2.paced import Paced
from pluto_bt.trees.scopes import EMPTY, Entry, Scope
from pluto_bt.trees.tracked import Tracked
from pluto_bt.trees.values import PortProblem, kind_of_value

State = dict[str, Any]  # {"nodes": {number: [letter, memory]}, "board": {scope number: {key: [seq, is typed, value]}}}
OWN: Final = frozenset(vars(AlwaysSuccess()))  # what every node has; the rest is memory, or was set by the loader
NOT_MEMORY: Final = frozenset({"child", "enums", "scope", "script", "source_key", "tree_id", "timer", "started", "expired", "waiting", "resumes"})
LETTERS: Final[dict[Result, str]] = {IDLE: "I", RUNNING: "R", SUCCESS: "S", FAILURE: "F", SKIPPED: "K"}
STATUS_OF_LETTER: Final = {letter: status for status, letter in LETTERS.items()}
LEFT_OUT: Final = object()


def take(mission: Mission) -> State:
    """Everything the mission remembers."""
    tracked = mission.nodes()
    nodes = {str(i): [LETTERS[one.node.status], _memory(one.node)] for i, one in enumerate(tracked)}
    return {"nodes": nodes, "board": {str(i): _entries(scope) for i, scope in enumerate(scopes_of(tracked))}}


def changed(before: State, now: State) -> State:
    """What of `now` is not in `before`; entries that are gone stand as None. Empty if nothing has changed."""
    nodes = {number: one for number, one in now["nodes"].items() if before["nodes"].get(number) != one}
    board: dict[str, dict[str, Any]] = {}
    for number, entries in now["board"].items():
        old = before["board"].get(number, {})
        new = {key: one for key, one in entries.items() if old.get(key) != one} | {key: None for key in old if key not in entries}
        if new:
            board[number] = new
    return {name: part for name, part in (("nodes", nodes), ("board", board)) if part}


def merged(state: State, change: Mapping[str, Any]) -> State:
    """`state` after a change."""
    board = {number: dict(entries) for number, entries in state.get("board", {}).items()}
    for number, entries in change.get("board", {}).items():
        kept = {**board.get(number, {}), **entries}
        board[number] = {key: one for key, one in kept.items() if one is not None}
    return {"nodes": {**state.get("nodes", {}), **change.get("nodes", {})}, "board": board}


def give_back(mission: Mission, state: State) -> list[str]:
    """Let a mission that was just loaded, of the same text, remember `state`; the names of entries whose values could not be kept."""
    tracked = mission.nodes()
    for number, (letter, memory) in state["nodes"].items():
        _restore(tracked[int(number)].node, letter, memory)
    lost: list[str] = []
    for i, scope in enumerate(scopes_of(tracked)):
        _restore_scope(scope, state["board"].get(str(i), {}), lost)
    return lost


def scopes_of(tracked: list[Tracked]) -> list[Scope]:
    """The scopes of a mission, each once, in the order of its nodes."""
    return list({id(one.plan.scope): one.plan.scope for one in tracked}.values())


# -------------------------------------------------------------------- nodes


def _memory(node: Any) -> dict[str, Any]:
    """What a control or decorator remembers between ticks; leaves begin again, so they have none."""
    if not isinstance(node, Node) or isinstance(node, Paced):
        return {}
    found: dict[str, Any] = {}
    for name, value in vars(node).items():
        if name not in OWN and name not in NOT_MEMORY and not name.startswith("_"):
            plain = [value.seen] if isinstance(value, UpdateWatch) else to_json(value)
            if plain is not LEFT_OUT:
                found[name] = plain
    return found


def _restore(node: Any, letter: str, memory: dict[str, Any]) -> None:
    status = STATUS_OF_LETTER[letter]
    begins_again = not node.children or isinstance(node, Paced)
    node.status = IDLE if begins_again and status is RUNNING else status
    for name, plain in memory.items():
        value = getattr(node, name, None)
        if isinstance(value, UpdateWatch):
            value.seen = plain[0]
        else:
            setattr(node, name, from_json(plain))
    if memory.get("over"):  # a Delay whose time was over is working on its child
        node.started = True


# -------------------------------------------------------------------- the blackboard


def _entries(scope: Scope) -> dict[str, Any]:
    return {key: _entry(entry) for key, entry in scope.entries.items() if entry.value is not EMPTY}


def _entry(entry: Entry) -> list[Any]:
    plain = to_json(entry.value)
    return [entry.seq, entry.kind is not None, {"text": text_of(entry.value)} if plain is LEFT_OUT else plain]


def _restore_scope(scope: Scope, entries: dict[str, Any], lost: list[str]) -> None:
    for key in list(scope.entries):
        if key not in entries and scope.entries[key].value is not EMPTY:
            scope.unset(key)
    for key, (seq, is_typed, plain) in entries.items():
        entry = scope.entries.get(key)
        if entry is None:
            entry = scope.entries[key] = Entry(scope.board)
            scope.board.changes += 1
        try:
            value = entry.kind.convert(plain["text"]) if isinstance(plain, dict) and "text" in plain and entry.kind is not None else from_json(plain)
        except (PortProblem, ValueError):
            lost.append(key)
            continue
        entry.put(value)
        entry.seq = seq
        if is_typed and entry.kind is None:
            entry.kind = kind_of_value(value)


# -------------------------------------------------------------------- values


def to_json(value: Any) -> Any:
    """A value as JSON that gives the same value back; LEFT_OUT for what JSON cannot hold."""
    if value is None or type(value) in (bool, int, float, str):
        return value
    if value is SKIPPED or isinstance(value, type(RUNNING)):
        return {"status": LETTERS[value]}
    for kind in (list, tuple, deque, set):
        if type(value) is kind:
            items = [to_json(item) for item in (sorted(value) if kind is set else value)]
            return LEFT_OUT if LEFT_OUT in items else {kind.__name__: items}
    return LEFT_OUT


def from_json(plain: Any) -> Any:
    """The value back."""
    if not isinstance(plain, dict):
        return plain
    (kind, content), *_ = plain.items()
    if kind == "status":
        return STATUS_OF_LETTER[content]
    if kind == "text":
        return content
    return {"list": list, "tuple": tuple, "deque": deque, "set": set}[kind](from_json(item) for item in content)


__all__ = ["State", "changed", "give_back", "merged", "take"]
