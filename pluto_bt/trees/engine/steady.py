"""Leaves out what cannot have changed: a part of the tree that depends on its entries alone keeps its answer until one of them is written.

A part is steady if each of its leaves says so of its class (`PORTS_ALONE = True`: what `update` answers follows from the input ports and from
nothing else, and it does nothing else), writes no port, reads no topic, and has no conditions; and if all nodes above them are of the kinds
that only pass on what their children answer. Everything else is ticked in every tick.

What is remembered is the whole of what a tick would do: the answer, and the state that it leaves. A part without a place of its own, or one
that was begun in this tick, would do the same again. One that went on from a place that it kept (a Sequence may) might not: it is ticked once
more, and remembered if that has changed nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.status import RUNNING, SKIPPED, Result
from pluto_bt.trees.scopes import Board, Entry, Scope

FEW: Final = 32  # entries that are looked at one by one; of more it is only known whether anything at all was written


@dataclass(frozen=True)
class Part:
    """What a steady part reads: (scope, key) of every connected input; and its `places`: the nodes in it, if any of them goes on where it was."""

    inputs: tuple[tuple[Scope, str], ...]
    places: tuple[Any, ...] = ()


def remember(node: Any, part: Part, board: Board, context: Context) -> None:
    """Give the instance a `step` that answers from memory while nothing has changed."""
    node.step = Memory(node, part, board, context).step


class Memory:
    """The last answer of one part, and what it was the answer to."""

    __slots__ = ("answer", "board", "changes", "context", "entries", "inner", "is_known", "node", "part", "seqs", "state", "writes")

    def __init__(self, node: Any, part: Part, board: Board, context: Context) -> None:
        self.node, self.part, self.board, self.context = node, part, board, context
        self.inner: Callable[[], Result] = node.step
        self.is_known = False
        self.answer: Any = None
        self.writes = self.changes = -1
        self.entries: Sequence[Entry] | None = None
        self.seqs: list[int] = []
        self.state: list[tuple[Any, ...]] = []

    def step(self) -> Result:
        """The remembered answer, or a real step."""
        node, answer = self.node, self.answer
        if self.is_known and self.context.may_remember and (node.status is RUNNING) is (answer is RUNNING) and self._is_unchanged():
            node.status = answer
            return answer  # type: ignore[no-any-return]  # a status
        goes_on, skipped = node.status is RUNNING and bool(self.part.places), len(self.context.skipped)
        is_second_look = goes_on and self._is_unchanged()
        result = self.inner()
        self.is_known = result is not SKIPPED and len(self.context.skipped) == skipped
        if goes_on:
            before, self.state = self.state, [_state(one) for one in self.part.places]
            self.is_known = self.is_known and is_second_look and before == self.state
        self.answer = result
        self._note()
        return result

    def _is_unchanged(self) -> bool:
        board = self.board
        if self.writes == board.writes:
            return True
        if self.entries is None or self.changes != board.changes or [entry.seq for entry in self.entries] != self.seqs:
            return False
        self.writes = board.writes
        return True

    def _note(self) -> None:
        """What the answer was the answer to."""
        board = self.board
        self.writes = board.writes
        if self.changes != board.changes:
            self.changes = board.changes
            found = {id(entry): entry for scope, key in self.part.inputs if (entry := scope.find(key)) is not None}
            self.entries = tuple(found.values()) if len(found) <= FEW else None
        self.seqs = [entry.seq for entry in self.entries] if self.entries is not None else []


def _state(node: Any) -> tuple[Any, ...]:
    """All that a node of a steady part keeps from tick to tick."""
    return node.status, getattr(node, "index", 0), getattr(node, "skips", 0)
