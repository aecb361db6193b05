"""The threads that make the robot stop or move go before whatever else computes on its computer, where the system lets them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

PRIORITY = 1
"""Of the real-time priorities the least: before every ordinary program, after all that was given one on purpose."""


def take_precedence() -> bool:
    """Schedule the calling thread before all ordinary ones (SCHED_RR); what it starts is scheduled as usual.

    A kernel without preemption lets whoever computes go on until its next timer tick, 4 ms at 250 Hz. Nobody here computes for long: the kernel
    itself bounds the share of such threads (95 % of a processor).

    Returns:
        False where this is not permitted: the user is not root, and has no `ulimit -r`; or the system has no such policy.
    """
    try:
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(PRIORITY))
    except (AttributeError, OSError):
        return False
    return True


@contextmanager
def precedence(*, wanted: bool = True) -> Iterator[bool]:
    """The same for a while: afterwards the thread is an ordinary one. True within, if it was `wanted` and is permitted."""
    taken = wanted and take_precedence()
    try:
        yield taken
    finally:
        if taken:  # without the second word only root could go back
            os.sched_setscheduler(0, os.SCHED_OTHER | os.SCHED_RESET_ON_FORK, os.sched_param(0))
