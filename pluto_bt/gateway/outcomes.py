"""What came of each `command` and `run` of a named session, so that a repeated one acts once."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import msgspec

from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import AnyReply, Progress
from pluto_bt.gateway.requests import AnyRequest
from pluto_bt.gateway.wire import Key

SESSIONS = 64
OUTCOMES = 256
OUTCOME_BYTES, MOST_BYTES = 512, 8 * 1024 * 1024
"""What one takes at least, and what all may take together."""
_encoder = msgspec.msgpack.Encoder(order="deterministic")


class Outcome:
    """What was said to a request: the direct reply, the newest progress, the result. Of the request itself only a digest is kept.

    Attributes:
        size_bytes: about what it takes.
        on_growth: told by how many bytes that changed.
    """

    __slots__ = ("_digest", "_replies", "on_growth", "size_bytes")

    def __init__(self, request: AnyRequest) -> None:
        self._digest = _digest(request)
        self._replies: dict[type[AnyReply], AnyReply] = {}
        self.size_bytes = OUTCOME_BYTES
        self.on_growth: Callable[[int], None] = _nobody_counts

    def is_of(self, request: AnyRequest) -> bool:
        """True if it is that of the same request, content and all."""
        return _digest(request) == self._digest

    def add(self, reply: AnyReply) -> None:
        """Keep a reply; of progress only the newest."""
        self._replies[type(reply)] = reply
        before, self.size_bytes = self.size_bytes, OUTCOME_BYTES + sum(len(_encoder.encode(kept)) for kept in self._replies.values())
        self.on_growth(self.size_bytes - before)

    @property
    def direct(self) -> AnyReply:
        """The first reply."""
        return next(iter(self._replies.values()))

    @property
    def later(self) -> list[AnyReply]:
        """What followed it; progress only as long as there is no result."""
        follow = list(self._replies.values())[1:]
        return [reply for reply in follow if not isinstance(reply, Progress)] or follow


class Outcomes:
    """The last outcomes of the last sessions, bounded in number and in bytes; older ones are forgotten, least recently used sessions first.

    Attributes:
        size_bytes: about what all take.
    """

    def __init__(self, sessions: int = SESSIONS, outcomes: int = OUTCOMES, most_bytes: int = MOST_BYTES) -> None:
        self._limit_sessions = sessions
        self._limit_outcomes = outcomes
        self._most_bytes = most_bytes
        self._sessions: dict[Key, dict[str, Outcome]] = {}
        self.size_bytes = 0

    def find(self, key: Key, request: AnyRequest) -> Outcome | None:
        """The stored outcome of the same request. Raises: RefusedError `conflict` if the id was used for another one."""
        known = self._sessions.get(key, {}).get(request.id)
        if known is not None and not known.is_of(request):
            raise RefusedError("conflict", f'id "{request.id}" was used in this session for another request; expected a new id, or the same content')
        return known

    def begin(self, key: Key, request: AnyRequest) -> Outcome:
        """An outcome for a request that is about to act; stored if session and id are named."""
        outcome = Outcome(request)
        if not isinstance(key, int) and request.id:
            self.forget(key, request)
            of_session = self._sessions.pop(key, {})
            self._sessions[key] = of_session  # now the most recently used
            of_session[request.id] = outcome
            outcome.on_growth = self._grow
            self._grow(outcome.size_bytes)
            while len(of_session) > self._limit_outcomes:
                self._drop(key, next(iter(of_session)))
            while len(self._sessions) > self._limit_sessions or (self.size_bytes > self._most_bytes and self.size_bytes > outcome.size_bytes):
                oldest = next(iter(self._sessions))
                self._drop(oldest, next(iter(self._sessions[oldest])))
        return outcome

    def forget(self, key: Key, request: AnyRequest) -> None:
        """The request did nothing after all."""
        if request.id in self._sessions.get(key, {}):
            self._drop(key, request.id)

    def _drop(self, key: Key, id: str) -> None:
        outcome = self._sessions[key].pop(id)
        outcome.on_growth = _nobody_counts
        self.size_bytes -= outcome.size_bytes
        if not self._sessions[key]:
            del self._sessions[key]

    def _grow(self, by_bytes: int) -> None:
        self.size_bytes += by_bytes


def _nobody_counts(by_bytes: int) -> None:
    """It is not kept."""


def _digest(request: AnyRequest) -> bytes:
    return hashlib.sha256(_encoder.encode(request)).digest()
