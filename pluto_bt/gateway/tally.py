"""What repeats itself in the audit log: the first is written in full, the others are counted, so that a flood washes away nothing."""

from __future__ import annotations

import threading
from collections.abc import Hashable
from typing import Any

Entry = dict[str, Any]
WINDOW_S, MOST = 30.0, 256


class Tally:
    """Counts of repetitions. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sums: dict[Hashable, tuple[float, Entry, int]] = {}  # since when, the first one, how many followed
        self._deed: Hashable = None  # what was done last, by whomever

    def is_first(self, own: Hashable, shared: Hashable, entry: Entry, now_s: float) -> bool:
        """True if this is to be written; else it is counted under the key `own`, or under `shared` where there are too many of those."""
        with self._lock:
            key = own if own in self._sums or len(self._sums) < MOST else shared
            since_s, first, count = self._sums.get(key, (now_s, entry, -1))
            self._sums[key] = since_s, first, count + 1
            return count < 0

    def deed(self, deed: Hashable) -> list[Entry]:
        """Something was done. If it is another thing than before, repetitions of that one are news again: their sums up to now."""
        with self._lock:
            if deed == self._deed:
                return []
            old, self._deed = self._deed, deed
            return self._closed([key for key in self._sums if isinstance(key, tuple) and key[-1] == old])

    def due(self, now_s: float) -> list[Entry]:
        """The sums whose time is over; infinity = all."""
        with self._lock:
            return self._closed([key for key, (since_s, _, _) in self._sums.items() if now_s - since_s >= WINDOW_S])

    def _closed(self, keys: list[Hashable]) -> list[Entry]:
        sums = [self._sums.pop(key) for key in keys]
        return [entry | {"content": {}, "times": count, "since_s": round(since_s, 3)} for since_s, entry, count in sums if count]
