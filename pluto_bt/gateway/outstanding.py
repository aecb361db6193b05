"""What one client has asked of the executive and has no answer to yet."""

from __future__ import annotations

from collections import deque

from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.port import RefusedError


class Outstanding:
    """Bounded in number and in bytes; true while there is any."""

    def __init__(self, limits: Limits) -> None:
        self._most, self._most_bytes = limits.outstanding, limits.mission_bytes
        self._sizes_bytes: deque[int] = deque()

    @property
    def size_bytes(self) -> int:
        """Of all of them."""
        return sum(self._sizes_bytes)

    def __bool__(self) -> bool:
        return bool(self._sizes_bytes)

    def add(self, size_bytes: int) -> None:
        """One more; a single one may have any size. Raises: RefusedError `busy`."""
        sizes_bytes = self._sizes_bytes
        if len(sizes_bytes) >= self._most or (sizes_bytes and self.size_bytes + size_bytes > self._most_bytes):
            text = f"{len(sizes_bytes)} requests ({self.size_bytes} bytes) of this client wait for the executive; wait for their replies"
            raise RefusedError("busy", text)
        sizes_bytes.append(size_bytes)

    def answered(self) -> None:
        """The oldest has its answer."""
        self._sizes_bytes.popleft()
