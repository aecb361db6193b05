"""A mission at work: the mission itself, an errand or a job, with its state as operators see it."""

from __future__ import annotations

from pluto_bt.trees.errors import TickError
from pluto_bt.trees.mission import Mission

IDLE, RUNNING, PAUSED, SUCCEEDED, FAILED, ABORTED = "idle", "running", "paused", "succeeded", "failed", "aborted"
ENDED = {"SUCCESS": SUCCEEDED, "FAILURE": FAILED, "SKIPPED": FAILED}


class Activity:
    """A mission at work: its state, and why it is in it."""

    def __init__(self, mission: Mission, number: int) -> None:
        self.mission = mission
        self.number = number
        self.state = RUNNING
        self.reason = ""
        self.text = ""
        self.ticks = 0
        self.error: TickError | None = None

    @property
    def is_over(self) -> bool:
        """True once it cannot be ticked any more."""
        return self.state in (SUCCEEDED, FAILED, ABORTED)

    def tick(self) -> None:
        """One decision."""
        self.ticks += 1
        try:
            status = self.mission.tick_once()
        except TickError as error:
            self.error = error
            self.state, self.reason, self.text = FAILED, "leaf-error", str(error)
            return
        if status in ENDED:
            self.state = ENDED[status]
            if self.state == FAILED:
                self.reason = self.mission.deciding_reason() or ("skipped" if status == "SKIPPED" else "failed")
                self.text = self.mission.deciding_text()

    def end(self, reason: str) -> None:
        """Halt the tree for good."""
        self.state, self.reason = ABORTED, reason  # first: over is over, also if a leaf raises while it lets go
        try:
            self.mission.halt()
        except TickError as error:
            self.error, self.text = error, str(error)
