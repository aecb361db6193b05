"""Where motion leaves its orders for the executive: run this job, or end the one that runs. Newest wins. Thread-safe."""

from __future__ import annotations

import threading

from pluto_bt.skills.jobs import Job


class JobBox:
    """The newest order."""

    def __init__(self) -> None:
        self._is_new = False
        self._job: Job | None = None
        self._lock = threading.Lock()

    def put(self, job: Job | None) -> None:
        """Order a job; None = end the one that runs."""
        with self._lock:
            self._is_new, self._job = True, job

    def take(self) -> tuple[bool, Job | None]:
        """(whether there is a new order, the order), once."""
        if not self._is_new:
            return False, None
        with self._lock:
            self._is_new = False
            return True, self._job
