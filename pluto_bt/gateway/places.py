"""Room for long messages: few clients at one time may send one. The bytes of the others wait in the kernel, which stops their senders."""

from __future__ import annotations

import math
from collections.abc import Callable

from pluto_bt.gateway.limits import Limits

LONG_BYTES = 16 * 1024
"""A message is long when so much of it is there and its end has not come."""


class Places:
    """Who has a place, and who waits for one, in the order in which they came."""

    def __init__(self, limits: Limits) -> None:
        self._count, self._patience_s = limits.documents, limits.document_s
        self._taken_s: dict[int, float] = {}  # by client, since when he sends; infinity: his message is whole and waits for its answer
        self._waiting: dict[int, Callable[[], None]] = {}  # by client, whom to tell when he has a place

    def take(self, client: int, now_s: float, wake: Callable[[], None]) -> bool:
        """A place for who begins to send, or goes on; False if there is none: `wake` is called when he is to ask again, and will have one."""
        if client in self._taken_s:
            if self._taken_s[client] == math.inf:  # his next long one
                self._taken_s[client] = now_s
            return True
        if client not in self._waiting and len(self._waiting) < self._free:
            self._taken_s[client] = now_s
        elif client in list(self._waiting)[: self._free]:
            del self._waiting[client]
            self._taken_s[client] = now_s
        else:
            self._waiting[client] = wake
        return client in self._taken_s

    def rest(self, client: int) -> None:
        """His message is whole: he keeps his place until it is answered, and nobody calls him slow."""
        self._taken_s[client] = math.inf

    def leave(self, client: int) -> None:
        """He needs none any more, or is gone; harmless if he had none."""
        self._waiting.pop(client, None)
        if self._taken_s.pop(client, None) is not None:
            for wake in list(self._waiting.values())[: self._free]:
                wake()

    def slow(self, now_s: float) -> list[int]:
        """Who has been sending for too long while others wait."""
        return [client for client, since_s in self._taken_s.items() if now_s - since_s >= self._patience_s] if self._waiting else []

    @property
    def _free(self) -> int:
        return self._count - len(self._taken_s)
