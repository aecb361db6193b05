"""Leaves that need a device which the robot does not have: they would fail with `no-device` as soon as they are ticked."""

from __future__ import annotations

from typing import Any, Final

from pluto_bt.maps.platform import Devices
from pluto_bt.source import Fault, Faults
from pluto_bt.trees.checks.outcomes import GUARDS
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.values import parse_bool

# parents that have an answer to a child that fails, or may never tick it
PREPARED: Final = frozenset((
    "Fallback", "AsyncFallback", "ReactiveFallback", "ForceSuccess", "Inverter", "TryCatch", "IfThenElse", "WhileDoElse", "RecoveryNode",
    "Switch2", "Switch3", "Switch4", "Switch5", "Switch6",
))  # fmt: skip


def check_devices(root: Plan, devices: Devices, robot: str, *, may_fail: bool = False) -> tuple[Fault, ...]:
    """A fault at each leaf that lacks its device on `robot`, told once an element.

    A warning where the mission may be ready for the failure: in a branch of a Fallback and the like, behind a pre-condition, or with `may_fail`.
    """
    faults, told = Faults(), set[int]()
    waiting = [(root, may_fail)]
    while waiting:
        plan, is_ready = waiting.pop()
        is_ready = is_ready or plan.type_name in PREPARED or any(name in plan.element.attributes for name in GUARDS)
        waiting += [(child, is_ready) for child in reversed(plan.children)]
        make: Any = plan.node_type.make if plan.node_type is not None else None
        lack = make.lacks(devices) if hasattr(make, "lacks") and not _is_optional(plan) else ""
        if lack and id(plan.element) not in told:
            told.add(id(plan.element))
            tell = faults.warning if is_ready else faults.error
            what, expected = f"<{plan.type_name}> fails on this robot: {lack}", f"a robot with a {' or a '.join(make.DEVICES)}"
            tell(plan.element.place, "no-device", what, expected=expected, found=robot, mend=_mend(plan))
    return faults.in_order()


def _is_optional(plan: Plan) -> bool:
    """True if the node is told to do without, or if that is only known while it runs."""
    attribute = plan.element.attributes.get("optional")
    try:
        return attribute is not None and parse_bool(attribute.value)
    except ValueError:
        return True


def _mend(plan: Plan) -> str:
    can_do_without = plan.node_type is not None and "optional" in plan.node_type.ports
    return 'optional="true" lets it do nothing there' if can_do_without else "another --platform, or another node"
