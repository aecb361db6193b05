"""Sequence, AsyncSequence, SequenceWithMemory: one child after the other while they succeed."""

from __future__ import annotations

from pluto_bt.trees.controls.in_order import InOrder
from pluto_bt.trees.engine.node import reset
from pluto_bt.trees.engine.status import FAILURE, SUCCESS, Result


class Sequence(InOrder):
    """SUCCESS when all children succeeded, FAILURE with the first that fails; SKIPPED if all were skipped."""

    PASSES_ON = KEEPS_PLACE = True
    GOES_ON, DECIDES = SUCCESS, FAILURE


class AsyncSequence(Sequence):
    """A Sequence that can be interrupted between children: it yields after each that started and finished in one tick."""

    YIELDS = True


class SequenceWithMemory(Sequence):
    """A Sequence that remembers its place through failures and halts: children that succeeded are not ticked again. It yields."""

    YIELDS = True

    def decided(self) -> Result:
        for child in self.children[self.index :]:
            reset(child)
        self.status = FAILURE
        return FAILURE

    def forget(self) -> None:
        """The place survives a halt."""
