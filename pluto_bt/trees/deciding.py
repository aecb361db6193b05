"""Whose FAILURE the mission's is."""

from __future__ import annotations

from typing import Any, Final

from pluto_bt.trees.controls.reactive import ReactiveSequence
from pluto_bt.trees.controls.sequence import Sequence
from pluto_bt.trees.controls.try_catch import TryCatch
from pluto_bt.trees.decorators.plain import ForceFailure, Inverter
from pluto_bt.trees.engine.status import FAILURE, IDLE, SUCCESS, Result
from pluto_bt.trees.nav2.pipeline import NonblockingSequence, PersistentSequence, PipelineSequence
from pluto_bt.trees.nav2.recovery import RecoveryNode

ENDS_WITH_THE_FIRST: Final = (  # of its children that fails; what comes after may have failed too, in an earlier round
    Sequence, ReactiveSequence, TryCatch, PipelineSequence, NonblockingSequence, PersistentSequence, RecoveryNode,
)  # fmt: skip


def decider_of(root: Any) -> Any:
    """The node, usually a leaf, whose FAILURE the root's is; None if the root did not fail."""
    node = root
    if _last(node) is not FAILURE:
        return None
    while (child := _culprit(node)) is not None:
        node = child
    return node


def _last(node: Any) -> Result:
    result: Result = node.last if node.status is IDLE else node.status
    return result


def _culprit(node: Any) -> Any:
    """The child that made `node` fail: a sequence ends with the first that fails, others with the last; below an Inverter one succeeded.

    A recovery that gives up only leaves the work as it failed: why it is needed is what the work says.
    """
    failed = [child for child in node.children if _last(child) is FAILURE]
    if failed:
        return failed[0] if isinstance(node, ENDS_WITH_THE_FIRST) else failed[-1]
    if isinstance(node, (Inverter, ForceFailure)):
        return next((child for child in node.children if _last(child) is SUCCESS), None)
    return None
