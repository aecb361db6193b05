"""The built-in leaves of BehaviorTree.CPP 4.10 (bt_xml.md, section 8): `LEAVES` maps the names in XML to the classes."""

from pluto_bt.trees.leaves.board import SetBlackboard, UnsetBlackboard, WasEntryUpdated
from pluto_bt.trees.leaves.constant import AlwaysFailure, AlwaysSuccess
from pluto_bt.trees.leaves.scripts import Script, ScriptCondition
from pluto_bt.trees.leaves.sleep import Sleep

LEAVES = {
    kind.__name__: kind
    for kind in (AlwaysSuccess, AlwaysFailure, Script, ScriptCondition, SetBlackboard, UnsetBlackboard, Sleep, WasEntryUpdated)
}

__all__ = ["LEAVES", *sorted(LEAVES)]
