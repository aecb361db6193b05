"""What a step tells its parent: py_trees' four statuses and SKIPPED, which py_trees has not.

A node never stores SKIPPED: only its parent is told.
"""

from __future__ import annotations

from enum import Enum
from typing import Final, Literal, TypeAlias

from py_trees.common import Status


class Skip(Enum):
    """The fifth answer of a step."""

    SKIPPED = "SKIPPED"


Result: TypeAlias = Status | Skip

SUCCESS: Final[Literal[Status.SUCCESS]] = Status.SUCCESS
FAILURE: Final[Literal[Status.FAILURE]] = Status.FAILURE
RUNNING: Final[Literal[Status.RUNNING]] = Status.RUNNING
IDLE: Final[Literal[Status.INVALID]] = Status.INVALID
SKIPPED: Final[Literal[Skip.SKIPPED]] = Skip.SKIPPED

STATUS_OF_NAME: Final[dict[str, Result]] = {
    "IDLE": IDLE,
    "RUNNING": RUNNING,
    "SUCCESS": SUCCESS,
    "FAILURE": FAILURE,
    "SKIPPED": SKIPPED,
}
NAME_OF_STATUS: Final[dict[Result, str]] = {status: name for name, status in STATUS_OF_NAME.items()}


def name_of(result: Result) -> str:
    """The name of an answer. Cheaper than a look into `NAME_OF_STATUS`, for which the Enum is asked for its hash in Python."""
    return "IDLE" if result is IDLE else result._name_
