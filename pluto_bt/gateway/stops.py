"""Stops on their way to the executive: each is done after it came, and a flood of them is only a few."""

from __future__ import annotations

from pluto_bt.gateway.requests import Estop, Stop

WAITING = 1024


class Stops:
    """At most one stop is under way; those that come meanwhile are done together by the next."""

    def __init__(self) -> None:
        self._under_way: list[str] = []  # ids that the next answer serves
        self._waiting: list[Stop | Estop] = []

    def add(self, request: Stop | Estop) -> Stop | Estop | None:
        """What to send to the executive now, None if it must wait."""
        self._waiting.append(request)
        return None if self._under_way else self._next()

    def answered(self) -> tuple[list[str], Stop | Estop | None]:
        """The ids that the answer serves, and what to send next."""
        ids, self._under_way = self._under_way, []
        return ids, self._next() if self._waiting else None

    @property
    def is_under_way(self) -> bool:
        """True while a stop has no answer yet."""
        return bool(self._under_way)

    @property
    def is_flood(self) -> bool:
        """True if more wait than anybody means."""
        return len(self._waiting) > WAITING

    def _next(self) -> Stop | Estop:
        latched = [request for request in self._waiting if isinstance(request, Estop)]
        chosen = (latched or self._waiting)[-1]
        self._under_way = [request.id for request in self._waiting]
        self._waiting = []
        return chosen
