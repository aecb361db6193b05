"""The control nodes of BehaviorTree.CPP 4.10 (bt_xml.md, section 6): `CONTROLS` maps the names in XML to the classes."""

from pluto_bt.trees.controls.branch import IfThenElse, WhileDoElse
from pluto_bt.trees.controls.fallback import AsyncFallback, Fallback
from pluto_bt.trees.controls.parallel import Parallel, ParallelAll
from pluto_bt.trees.controls.reactive import ReactiveFallback, ReactiveSequence
from pluto_bt.trees.controls.sequence import AsyncSequence, Sequence, SequenceWithMemory
from pluto_bt.trees.controls.switch import Switch2, Switch3, Switch4, Switch5, Switch6
from pluto_bt.trees.controls.try_catch import TryCatch

CONTROLS = {
    kind.__name__: kind
    for kind in (
        Sequence,
        AsyncSequence,
        SequenceWithMemory,
        ReactiveSequence,
        Fallback,
        AsyncFallback,
        ReactiveFallback,
        Parallel,
        ParallelAll,
        IfThenElse,
        WhileDoElse,
        Switch2,
        Switch3,
        Switch4,
        Switch5,
        Switch6,
        TryCatch,
    )
}

__all__ = ["CONTROLS", *sorted(CONTROLS)]
