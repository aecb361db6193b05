"""Who is who: connections come and go, sessions stay; leases and outcomes belong to sessions."""

from __future__ import annotations

from pluto_bt.gateway.wire import Ask, Key


class Callers:
    """The connections of each key; the newest hears what follows."""

    def __init__(self) -> None:
        self._clients_of: dict[Key, set[int]] = {}
        self._key_of: dict[int, Key] = {}

    def meet(self, ask: Ask) -> tuple[Key, Key | None]:
        """The key under which the client's lease and outcomes stand, and the one that he leaves for it, if nobody else answers to that."""
        key, old = ask.key, self._key_of.get(ask.client)
        left = self.gone(ask.client) if old is not None and old != key else None
        self._key_of[ask.client] = key
        self._clients_of.setdefault(key, set()).add(ask.client)
        return key, left

    def gone(self, client: int) -> Key | None:
        """A connection ended; the key that nobody answers to any more, None if its session has another connection."""
        key = self._key_of.pop(client, None)
        if key is None:
            return None
        self._clients_of[key].discard(client)
        if self._clients_of[key]:
            return None
        del self._clients_of[key]
        return key

    def all_gone(self) -> list[Key]:
        """All connections ended at once; the keys that cannot come back."""
        lost: list[Key] = [key for key in self._clients_of if isinstance(key, int)]
        self._key_of.clear()
        self._clients_of.clear()
        return lost

    def client_of(self, key: Key) -> int | None:
        """The connection that hears for this key."""
        return max(self._clients_of.get(key, ()), default=None)
