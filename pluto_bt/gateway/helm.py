"""Who drives: the one lease, and what its end entails."""

from __future__ import annotations

from collections.abc import Callable

from pluto_bt.gateway import inquiries, requests
from pluto_bt.gateway.leases import Held, Leases
from pluto_bt.gateway.port import RefusedError, RobotPort
from pluto_bt.gateway.replies import LeaseState
from pluto_bt.gateway.wire import Key


class Helm:
    """Gives the lease, and does what its holder asked for when he loses it.

    Args:
        end_run: told whose run ends with his lease, with which state, and why.
    """

    def __init__(self, port: RobotPort, end_run: Callable[[Key, str, str], None]) -> None:
        self._port, self._end_run = port, end_run
        self._leases = Leases()

    @property
    def held(self) -> Held | None:
        """The lease, None if nobody has it."""
        return self._leases.held

    def require(self, key: Key, now_s: float) -> None:
        """Raises: RefusedError `no-lease` for whoever does not hold it."""
        if not self._leases.holds(key, now_s):
            held = self._leases.held
            raise RefusedError("no-lease", f'the lease is held by {held.name if held else "nobody"}; acquire it first: <lease op="acquire"/>')

    def require_free_for(self, key: Key) -> None:
        """Raises: RefusedError `lease-held` if another one drives."""
        held = self._leases.held
        if held is not None and held.key != key:
            raise RefusedError("lease-held", f"{held.name} drives; a mission starts when the lease is free or yours")

    def answer(self, request: requests.Lease, key: Key, name: str, now_s: float) -> LeaseState:
        """Acquire, take, renew, release or look. Raises: RefusedError."""
        match request.op:
            case "acquire":
                self._leases.acquire(key, name, request.ttl_s, request.on_loss, now_s)
            case "take":
                lost = self._leases.take(key, name, request.ttl_s, request.on_loss, now_s)
                if lost is not None:
                    self._lost(lost, f"was taken by {name}", "preempted")
            case "renew":
                self._leases.renew(key, now_s)
            case "release":
                if self._leases.end(key) is None:
                    raise RefusedError("no-lease", "expected the holder of the lease")
        return inquiries.lease(self._leases.held, key, now_s)

    def expire(self, now_s: float) -> None:
        """Notice that it ran out."""
        lost = self._leases.expire(now_s)
        if lost is not None:
            self._lost(lost, "ran out")

    def gone(self, key: Key | None) -> None:
        """Nobody answers to this key any more."""
        held = self._leases.end(key) if key is not None else None
        if held is not None:
            self._lost(held, "ended with his connection")

    def _lost(self, held: Held, why: str, state: str = "cancelled") -> None:
        if held.on_loss == "continue":
            return
        source = f"the lease of {held.name} {why}"
        if held.on_loss == "stop":
            self._port.stop(source)
        elif self._port.mission_state().state == "running":
            self._port.mission("pause", "", "", source)
        self._end_run(held.key, state, source)
