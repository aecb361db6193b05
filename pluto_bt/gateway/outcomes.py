"""What came of each `command` and `run` of a named session, so that a repeated one acts once."""

from __future__ import annotations

from typing import Any

from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import AnyReply, Progress
from pluto_bt.gateway.requests import AnyRequest

SESSIONS = 64
OUTCOMES = 256


class Outcome:
    """A request and what was said to it: the direct reply, the newest progress, the result."""

    __slots__ = ("_replies", "request")

    def __init__(self, request: AnyRequest) -> None:
        self.request = request
        self._replies: dict[type[AnyReply], AnyReply] = {}

    def add(self, reply: AnyReply) -> None:
        """Keep a reply; of progress only the newest."""
        self._replies[type(reply)] = reply

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
    """The last outcomes of the last sessions; older ones are forgotten, least recently used first."""

    def __init__(self, sessions: int = SESSIONS, outcomes: int = OUTCOMES) -> None:
        self._limit_sessions = sessions
        self._limit_outcomes = outcomes
        self._sessions: dict[str, dict[str, Outcome]] = {}

    def find(self, session: str, request: AnyRequest) -> Outcome | None:
        """The stored outcome of the same request. Raises: RefusedError `conflict` if the id was used for another one."""
        if not session or not request.id:
            return None
        known = self._sessions.get(session, {}).get(request.id)
        if known is not None and known.request != request:
            raise RefusedError("conflict", f'id "{request.id}" was used in this session for another request; expected a new id, or the same content')
        return known

    def begin(self, session: str, request: AnyRequest) -> Outcome:
        """An outcome for a request that is about to act; stored if session and id are named."""
        outcome = Outcome(request)
        if session and request.id:
            of_session = self._sessions.pop(session, {})
            self._sessions[session] = of_session  # now the most recently used
            of_session[request.id] = outcome
            _forget_oldest(of_session, self._limit_outcomes)
            _forget_oldest(self._sessions, self._limit_sessions)
        return outcome

    def forget(self, session: str, request: AnyRequest) -> None:
        """The request did nothing after all."""
        self._sessions.get(session, {}).pop(request.id, None)


def _forget_oldest(things: dict[str, Any], limit: int) -> None:
    while len(things) > limit:
        del things[next(iter(things))]
