"""All clients of one gateway process: who is connected, what is watched, and the way to the executive and back."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from pluto_bt.gateway.describe import describe
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Description
from pluto_bt.gateway.requests import AnyRequest, Describe
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.subscriptions import matches
from pluto_bt.gateway.wire import Answer, Ask, Batch, Gone, Up, Watch, Welcome
from pluto_bt.source import did_you_mean


class Hub:
    """The sessions and the newest values; no socket, no clock.

    Args:
        welcome: what the executive said first.
        send: takes a frame for the executive; never blocks.
        now_s: our own clock (any zero) at the welcome.
    """

    def __init__(self, welcome: Welcome, send: Callable[[Up], None], now_s: float) -> None:
        self.limits: Limits = welcome.limits
        self.robot = welcome.robot
        self.token = welcome.token
        self._topics = welcome.topics
        self._catalogue = welcome.catalogue
        self._send = send
        self._sessions: dict[int, Session] = {}
        self._asked: set[int] = set()  # clients that the executive has heard of
        self._next_client = welcome.first_client
        self._newest: dict[str, Newest] = {}
        self._watched: tuple[str, ...] = ()
        self._run_minus_ours_s = welcome.now_s - now_s

    # clients -----------------------------------------------------------------------------------------------------
    def open(self, now_s: float) -> Session:
        """A session for a new connection; if there is no place it is already closing, with the error to send."""
        taken = sum(not session.closing for session in self._sessions.values())
        is_reserve = taken >= self.limits.clients - self.limits.operator_places
        session = Session(self._next_client, self, now_s, is_reserve=is_reserve)
        self._next_client += 1
        self._sessions[session.client] = session
        if taken >= self.limits.clients:
            session.fail("too-many-connections", f"{taken} clients are connected, and no more are taken")
        return session

    def close(self, session: Session) -> None:
        """The connection is gone."""
        if self._sessions.pop(session.client, None) is None:
            return
        if session.client in self._asked:
            self._asked.discard(session.client)
            self._send(Gone(session.client))
        self.watch()

    def shut(self) -> None:
        """The executive ends: tell everybody."""
        for session in self._sessions.values():
            session.fail("shutdown", "the robot's software ends")

    # from the executive ------------------------------------------------------------------------------------------
    def receive(self, frame: Batch | Answer, now_s: float) -> Iterable[int]:
        """Take a frame; the clients who have something to be sent by it."""
        if isinstance(frame, Answer):
            session = self._sessions.get(frame.client)
            if session is None:
                return ()
            session.answer(frame, now_s)
            return (frame.client,)
        self._run_minus_ours_s = frame.now_s - now_s
        values = [Newest(value.topic, value.seq, frame.now_s - value.written_s, now_s, value.payload) for value in frame.values]
        events = [Newest("events", seq, frame.now_s - event.stamp_s, now_s, event) for seq, event in frame.events]
        self._newest |= {newest.topic: newest for newest in values if newest.topic in self._watched}
        for session in self._sessions.values():
            session.subscriptions.offer(values, now_s)
            session.events(events, now_s)
        return tuple(self._sessions)

    def run_s(self, now_s: float) -> float:
        """The run's clock, as well as it is known here."""
        return now_s + self._run_minus_ours_s

    # for sessions ------------------------------------------------------------------------------------------------
    def ask(self, client: int, session: str, name: str, request: AnyRequest) -> None:
        """Hand a request to the executive."""
        self._asked.add(client)
        self._send(Ask(client, session, name, request))

    def describe(self, request: Describe) -> Description:
        """What exists. Raises: RefusedError."""
        return describe(request, self._topics, self._catalogue)

    def require_topic(self, pattern: str) -> None:
        """Raises: RefusedError `unknown-topic` if the pattern means no topic of this run."""
        if not any(matches(pattern, topic) for topic in self._topics):
            raise RefusedError("unknown-topic", f'unknown topic "{pattern}"; {did_you_mean(pattern, self._topics) or "<describe/> lists all"}')

    def subscribed(self, session: Session, now_s: float) -> None:
        """Watch what the session wants now, and give it what is already here."""
        self.watch()
        session.subscriptions.offer(self._newest.values(), now_s)

    def watch(self) -> None:
        """Tell the executive which topics are wanted, if that has changed."""
        wanted = tuple(topic for topic in self._topics if any(session.subscriptions.flow(topic) for session in self._sessions.values()))
        if wanted != self._watched:
            self._watched = wanted
            self._newest = {topic: newest for topic, newest in self._newest.items() if topic in wanted}
            self._send(Watch(wanted))
