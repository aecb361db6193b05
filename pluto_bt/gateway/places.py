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
        self._since_s: dict[int, float | None] = {}  # by client, since when he sends; None: just now; infinity: he waits for the answer
        self._waiting: dict[int, Callable[[], None]] = {}  # by client, whom to tell that he has a place

    def take(self, client: int, now_s: float, wake: Callable[[], None]) -> bool:
        """A place for who begins to send, or goes on; False if he must wait: `wake` is called when he has one."""
        if client in self._since_s:
            if self._since_s[client] == math.inf:  # his next long one
                self._since_s[client] = now_s
        elif self._waiting or len(self._since_s) >= self._count:
            self._waiting[client] = wake
        else:
            self._since_s[client] = now_s
        return client in self._since_s

    def rest(self, client: int) -> None:
        """His message is whole: he keeps his place until it is answered, and nobody calls him slow."""
        self._since_s[client] = math.inf

    def leave(self, client: int) -> None:
        """He needs none any more, or is gone; harmless if he had none."""
        self._waiting.pop(client, None)
        self._since_s.pop(client, 0.0)
        while self._waiting and len(self._since_s) < self._count:
            first = next(iter(self._waiting))
            wake = self._waiting.pop(first)
            self._since_s[first] = None
            wake()

    def slow(self, now_s: float) -> list[int]:
        """Who has been sending for too long while others wait. Call it now and then."""
        since_s = self._since_s = {client: now_s if since_s is None else since_s for client, since_s in self._since_s.items()}
        return [client for client, begun_s in since_s.items() if begun_s is not None and now_s - begun_s >= self._patience_s] if self._waiting else []


class Place:
    """One client's place, and whether he has it.

    Attributes:
        is_held_up: he must wait for it: take no more of his message until `on_free` is called, which the server sets.
    """

    def __init__(self, places: Places, client: int) -> None:
        self._places, self._client = places, client
        self._is_mine = self.is_held_up = False
        self.on_free: Callable[[], None] = _nobody

    def mind(self, unfinished_bytes: int, unanswered_bytes: int, now_s: float) -> None:
        """A long message needs its place from its beginning until it is answered."""
        if unfinished_bytes > LONG_BYTES:
            self._is_mine = self._places.take(self._client, now_s, self._freed)
            self.is_held_up = not self._is_mine
        elif self._is_mine and unanswered_bytes > LONG_BYTES:
            self._places.rest(self._client)
        elif self._is_mine or self.is_held_up:
            self.leave()

    def _freed(self) -> None:
        self._is_mine, self.is_held_up = True, False
        self.on_free()

    def leave(self) -> None:
        """No more is sent."""
        was_held_up, self._is_mine, self.is_held_up = self.is_held_up, False, False
        self._places.leave(self._client)
        if was_held_up:
            self.on_free()

    def end(self) -> None:
        """The client is gone."""
        self.on_free = _nobody
        self.leave()


def _nobody() -> None:
    """Who waits for a place in a process without sockets."""
