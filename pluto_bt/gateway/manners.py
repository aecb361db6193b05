"""What a client must do to stay: speak now and then, say who he is in time, read what he is told."""

from __future__ import annotations

from pluto_bt.gateway.limits import Limits


class Manners:
    """The times of one client."""

    def __init__(self, limits: Limits, now_s: float) -> None:
        self._limits = limits
        self._began_s = self._heard_s = now_s

    def heard(self, now_s: float) -> None:
        """A byte came."""
        self._heard_s = now_s

    def fault(self, now_s: float, unread_bytes: int, *, is_unknown: bool, is_held_up: bool) -> tuple[str, str] | None:
        """Code and text of what he lacks, None if nothing; who is held up cannot be heard."""
        limits = self._limits
        if unread_bytes > limits.backlog_bytes:
            return "slow-consumer", f"{unread_bytes} bytes of replies wait unread; expected at most {limits.backlog_bytes}"
        if is_unknown and now_s - self._began_s >= limits.hello_s:
            return "timeout", f"expected hello within {limits.hello_s:g} s"
        if now_s - self._heard_s >= limits.idle_s and not is_held_up:
            return "timeout", f"no byte came for {limits.idle_s:g} s; send <ping/> now and then"
        return None
