"""Who is who: connections come and go, sessions stay; leases and outcomes belong to sessions."""

from __future__ import annotations

from pluto_bt.gateway.wire import Ask


class Callers:
    """The key of a client is his session's name, or his connection if he named none."""

    def __init__(self) -> None:
        self._client_of: dict[str, int] = {}  # key -> its newest connection
        self._key_of: dict[int, str] = {}

    def meet(self, ask: Ask) -> tuple[str, str | None]:
        """The key under which the client's lease and outcomes stand, and the one that he leaves for it, if any.

        The newest connection of a session hears what follows.
        """
        key, old = ask.session or f"#{ask.client}", self._key_of.get(ask.client)
        left = self.gone(ask.client) if old is not None and old != key else None
        self._key_of[ask.client] = key
        self._client_of[key] = max(ask.client, self._client_of.get(key, 0))
        return key, left

    def gone(self, client: int) -> str | None:
        """A connection ended; the key that nobody answers to any more, None if its session has a newer connection."""
        key = self._key_of.pop(client, None)
        if key is None or self._client_of.get(key) != client:
            return None
        del self._client_of[key]
        return key

    def all_gone(self) -> list[str]:
        """All connections ended at once; the keys that cannot come back."""
        lost = [key for key in (self.gone(client) for client, key in list(self._key_of.items()) if key.startswith("#")) if key is not None]
        self._key_of.clear()
        self._client_of.clear()
        return lost

    def client_of(self, key: str) -> int | None:
        """The connection that hears for this key."""
        return self._client_of.get(key)
