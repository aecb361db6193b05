"""The decorators of BehaviorTree.CPP 4.10 (bt_xml.md, section 7): `DECORATORS` maps the names in XML to the classes."""

from pluto_bt.trees.decorators.loop import LoopBool, LoopDouble, LoopInt, LoopString
from pluto_bt.trees.decorators.plain import ForceFailure, ForceSuccess, Inverter, KeepRunningUntilFailure
from pluto_bt.trees.decorators.precondition import Precondition
from pluto_bt.trees.decorators.repeating import Repeat, RetryUntilSuccessful
from pluto_bt.trees.decorators.run_once import RunOnce
from pluto_bt.trees.decorators.subtree import SubTree
from pluto_bt.trees.decorators.timing import Delay, Timeout
from pluto_bt.trees.decorators.updated import SkipUnlessUpdated, WaitValueUpdate

DECORATORS = {
    kind.__name__: kind
    for kind in (
        Inverter,
        ForceSuccess,
        ForceFailure,
        KeepRunningUntilFailure,
        RetryUntilSuccessful,
        Repeat,
        Timeout,
        Delay,
        RunOnce,
        Precondition,
        LoopInt,
        LoopBool,
        LoopDouble,
        LoopString,
        SkipUnlessUpdated,
        WaitValueUpdate,
    )
}

__all__ = ["DECORATORS", "SubTree", *sorted(DECORATORS)]
