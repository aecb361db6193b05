"""Who may drive: one holder at a time, for a time he must keep renewing. Plain state; the time is passed in."""

from __future__ import annotations

from dataclasses import dataclass

from pluto_bt.gateway.port import OnLoss, RefusedError
from pluto_bt.gateway.wire import Key


@dataclass(frozen=True, slots=True)
class Held:
    """A lease that somebody holds. `key` is his session or connection, `name` what people call him."""

    key: Key
    name: str
    epoch: int
    until_s: float
    ttl_s: float
    on_loss: OnLoss


class Leases:
    """The one lease of the robot. `epoch` counts its holders, so that a late command of an old one can be told."""

    def __init__(self) -> None:
        self._held: Held | None = None
        self._epoch = 0

    @property
    def held(self) -> Held | None:
        """The lease as it stands (an expired one stands until `expire` is called)."""
        return self._held

    def holds(self, key: Key, now_s: float) -> bool:
        """True if `key` may drive at `now_s`."""
        return self._held is not None and self._held.key == key and now_s < self._held.until_s

    def acquire(self, key: Key, name: str, ttl_s: float, on_loss: OnLoss, now_s: float) -> Held:
        """Take a free lease; the holder renews his by it. Call `expire` first. Raises: RefusedError `lease-held`."""
        held = self._held
        if held is not None and held.key != key:
            left_s = held.until_s - now_s
            raise RefusedError("lease-held", f'the lease is held by {held.name} for another {left_s:.1f} s; wait, or op="take" takes it away')
        return self._give(key, name, held.epoch if held else self._next_epoch(), ttl_s, on_loss, now_s)

    def take(self, key: Key, name: str, ttl_s: float, on_loss: OnLoss, now_s: float) -> Held | None:
        """Take the lease from whoever holds it; the lease that he lost, None if nobody did."""
        lost = self._held if self._held is not None and self._held.key != key else None
        keep = self._held is not None and lost is None
        self._give(key, name, self._epoch if keep else self._next_epoch(), ttl_s, on_loss, now_s)
        return lost

    def renew(self, key: Key, now_s: float) -> Held:
        """Hold on for another ttl. Raises: RefusedError `no-lease`."""
        held = self._held
        if held is None or not self.holds(key, now_s):
            raise RefusedError("no-lease", f"expected the holder of the lease; {held.name if held else 'nobody'} holds it; acquire it first")
        return self._give(key, held.name, held.epoch, held.ttl_s, held.on_loss, now_s)

    def end(self, key: Key) -> Held | None:
        """`key` lets go, or is gone; the lease that ended, None if he held none."""
        held = self._held
        if held is None or held.key != key:
            return None
        self._held = None
        return held

    def expire(self, now_s: float) -> Held | None:
        """The lease that has run out by `now_s`, once."""
        held = self._held
        return self.end(held.key) if held is not None and now_s >= held.until_s else None

    def _next_epoch(self) -> int:
        self._epoch += 1
        return self._epoch

    def _give(self, key: Key, name: str, epoch: int, ttl_s: float, on_loss: OnLoss, now_s: float) -> Held:
        self._held = Held(key, name, epoch, now_s + ttl_s, ttl_s, on_loss)
        return self._held
