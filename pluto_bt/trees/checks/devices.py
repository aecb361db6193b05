"""Leaves that need a device which the robot does not have: they would fail with `no-device` as soon as they are ticked."""

from __future__ import annotations

from typing import Final

from pluto_bt.maps.platform import Devices
from pluto_bt.source import Fault, Faults
from pluto_bt.trees.checks.outcomes import GUARDS
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.values import parse_bool

# parents that fail when a child fails; every other one may have an answer to that, or never tick it
HANDS_ON: Final = frozenset((
    "Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence", "PipelineSequence", "NonblockingSequence", "PersistentSequence", "SubTree",
    "ForceFailure", "KeepRunningUntilFailure", "Repeat", "RetryUntilSuccessful", "RunOnce", "Delay", "Timeout",
    "RateController", "DistanceController", "SpeedController", "GoalUpdatedController", "GoalUpdater",
))  # fmt: skip
MOST_FAILURES: Final = {"Parallel": "failure_count", "ParallelAll": "max_failures"}  # by default the first failure decides


def check_devices(root: Plan, devices: Devices, robot: str, *, may_fail: bool = False) -> tuple[Fault, ...]:
    """A fault at each leaf that lacks its device on `robot`, told once an element.

    A warning where the mission may be ready for the failure: below a parent that does not hand it on, behind a pre-condition, or with `may_fail`.
    """
    lacking: dict[int, tuple[Plan, bool]] = {}  # by id of an element; a tree that is used twice has each of its elements twice
    waiting = [(root, may_fail)]
    while waiting:
        plan, is_ready = waiting.pop()
        is_ready = is_ready or any(name in plan.element.attributes for name in GUARDS)
        waiting += [(child, is_ready or not _hands_on(plan)) for child in reversed(plan.children)]
        if _lack(plan, devices) and not _is_optional(plan):
            _, is_ready_elsewhere = lacking.get(id(plan.element), (plan, True))
            lacking[id(plan.element)] = plan, is_ready and is_ready_elsewhere
    faults = Faults()
    for plan, is_ready in lacking.values():
        tell = faults.warning if is_ready else faults.error
        what = f"<{plan.type_name}> fails on this robot: {_lack(plan, devices)}"
        tell(plan.element.place, "no-device", what, expected="a robot that has it", found=robot, mend=_mend(plan))
    return faults.in_order()


def _lack(plan: Plan, devices: Devices) -> str:
    """The sentence of a leaf class that says what it needs (`DEVICES`); "" of all others."""
    lacks = getattr(plan.node_type and plan.node_type.make, "lacks", None)
    return "" if lacks is None else str(lacks(devices))


def _hands_on(plan: Plan) -> bool:
    """True if the node fails with the first child that fails."""
    most = MOST_FAILURES.get(plan.type_name)
    return plan.type_name in HANDS_ON or (most is not None and most not in plan.element.attributes)


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
