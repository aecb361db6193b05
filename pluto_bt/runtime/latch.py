"""The safety latch: the ONE place that says "nothing may move". The stop filter obeys it directly, so that nothing above can move the robot."""

from __future__ import annotations

import threading
from typing import NamedTuple

ESTOP, OPERATOR_STOP = "estop", "operator-stop"
RANK = (ESTOP, OPERATOR_STOP)  # which one is named first if both hold


class Hold(NamedTuple):
    """Why the robot is held: one word, one sentence."""

    word: str
    text: str


class SafetyLatch:
    """Set by people, released by people; releasing moves nothing. Thread-safe."""

    def __init__(self) -> None:
        self._holds: dict[str, Hold] = {}
        self._lock = threading.Lock()
        self.held: Hold | None = None  # read by the stop filter and by every inbox of the chain

    def set(self, word: str, text: str) -> None:
        """Hold the robot for the reason `word`, ESTOP or OPERATOR_STOP; the newest sentence counts."""
        with self._lock:
            self._holds[word] = Hold(word, text)
            self._tell()

    def release(self, word: str) -> bool:
        """Take back one reason; True if it held. Nothing moves by that: the stop dropped every command."""
        with self._lock:
            was_held = self._holds.pop(word, None) is not None
            self._tell()
        return was_held

    def hold(self, word: str) -> Hold | None:
        """The hold for this reason, None without one."""
        return self._holds.get(word)

    def _tell(self) -> None:
        self.held = next((self._holds[word] for word in RANK if word in self._holds), None)
