"""The one shape of everything that runs."""

from __future__ import annotations

from typing import Protocol


class Component(Protocol):
    """An active part. It never sleeps and never asks the time: the scheduler calls `step` when it is due.

    `start` and `stop` may be called more than once; starting twice is harmless. `step` does what is due and returns at once.
    """

    def start(self, now_s: float) -> None:
        """Get ready; called before the first step and again after a restart."""

    def step(self, now_s: float) -> None:
        """Do what is due at `now_s`."""

    def stop(self) -> None:
        """Let go of what `start` took."""
