"""Spellings of version 3 of the format (bt_xml.md, section 12), so that an old file is refused with a word that helps."""

from __future__ import annotations

from typing import Final

NODES: Final = {
    "SequenceStar": "SequenceWithMemory",
    "SubTreePlus": "SubTree",
    "RetryUntilSuccesful": "RetryUntilSuccessful",
    "BlackboardCheckInt": "Precondition",
    "BlackboardCheckDouble": "Precondition",
    "BlackboardCheckString": "Precondition",
    "BlackboardCheckBool": "Precondition",
}
PORTS: Final = {
    ("Parallel", "threshold"): "success_count",
    ("Parallel", "success_threshold"): "success_count",
    ("Parallel", "failure_threshold"): "failure_count",
}
PRIVATE: Final = {"__autoremap": '_autoremap="true"', "__shared_blackboard": '_autoremap="true"'}
SUBTREE_HINT: Final = 'if this is a file of version 3: there a="b" on a SubTree meant a="{b}"'


def new_name_of_node(name: str) -> str:
    """The name in version 4 of a node that version 3 called otherwise, or ""."""
    return NODES.get(name, "")


def new_name_of_port(node: str, port: str) -> str:
    """The name in version 4 of a port that version 3 called otherwise, or ""."""
    return PORTS.get((node, port), "")


def new_attribute(name: str) -> str:
    """What stands in version 4 for a private attribute of version 3, or ""."""
    return PRIVATE.get(name, "")
