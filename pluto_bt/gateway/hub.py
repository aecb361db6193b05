"""All clients of one gateway process: who is connected, what is watched, and the way to the executive and back."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from pluto_bt.gateway.channels import Channels
from pluto_bt.gateway.describe import Described, describe, described
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outlets import Outlets
from pluto_bt.gateway.places import Places
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Description, Ok
from pluto_bt.gateway.requests import AnyRequest, Describe, Subscribe, Unsubscribe
from pluto_bt.gateway.session import Session
from pluto_bt.gateway.subscriptions import ALIASES, Flow, matches
from pluto_bt.gateway.wire import Answer, Ask, Batch, Gone, Refused, Up, Watch, Welcome
from pluto_bt.source import did_you_mean

INTEREST_S = 5.0
"""A topic that somebody `get`s is watched for so long, so that the next `get` is answered here."""


class Hub:
    """The sessions and the newest values; no socket, no clock.

    Args:
        welcome: what the executive said first.
        send: takes a frame for the executive; never blocks.
        now_s: our own clock (any zero) at the welcome.
        outlets: where the sockets of clients are, if they have any.
    """

    def __init__(self, welcome: Welcome, send: Callable[[Up], None], now_s: float, outlets: Outlets | None = None) -> None:
        self.limits: Limits = welcome.limits
        self.robot = welcome.robot
        self.access = welcome.access
        self.topics = welcome.topics
        self.places = Places(welcome.limits)
        self.batches = 0  # how often the executive has told what has changed
        self._catalogue, self._described = welcome.catalogue, tuple[Described, ...]()
        self._send = send
        self._sessions: dict[int, Session] = {}
        self._evicted: list[int] = []  # who is still to be told
        self._asked: set[int] = set()  # clients that the executive has heard of
        self._next_client = welcome.first_client
        self.outlets = outlets or Outlets()
        self._channels = Channels(welcome.topics, self.outlets)
        self._interest: dict[str, float] = {}  # topics that were asked for by `get`, and until when they are watched for it
        self._watched: tuple[str, ...] = ()
        self._run_minus_ours_s = welcome.now_s - now_s

    # clients -----------------------------------------------------------------------------------------------------
    def open(self, now_s: float) -> Session:
        """A session for a new connection; if there is no place it is already closing, with the error to send."""
        self._make_room()
        taken = sum(not session.closing for session in self._sessions.values())
        is_reserve = taken >= self.limits.clients - self.limits.operator_places
        session = Session(self._next_client, self, now_s, is_reserve=is_reserve)
        self._next_client += 1
        self._sessions[session.client] = session
        if taken >= self.limits.clients:
            session.fail("too-many-connections", f"{taken} clients are connected, and no more are taken")
        return session

    def _make_room(self) -> None:
        """If all places are taken, the operators' too: who sits there and has not shown that he is one gives way, the oldest first."""
        places = [session for session in self._sessions.values() if not session.closing]
        if len(places) >= self.limits.clients:
            strangers = [session for session in places if session.is_stranger]
            for session in strangers[:1]:
                session.fail("too-many-connections", "this place is for operators: <stop/>, or hello with such a name, was expected at once")
                self._evicted.append(session.client)

    def close(self, session: Session) -> None:
        """The connection is gone."""
        if self._sessions.pop(session.client, None) is None:
            return
        if session.client in self._asked:
            self._asked.discard(session.client)
            self._send(Gone(session.client))
        old = dict(session.subscriptions.flows)
        session.end()
        self._leave(old, session)
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
        self.batches += 1
        touched: dict[int, None] = {}
        for value in frame.values:
            if value.topic not in self._watched:  # it was on its way when the last listener left; nothing would make it new again
                continue
            newest = Newest(value.topic, value.seq, frame.now_s - value.written_s, now_s, value.payload)
            self._hand_out(self._channels.offer(newest, now_s), touched)
        if frame.events:
            events = [Newest("events", seq, frame.now_s - event.stamp_s, now_s, event) for seq, event in frame.events]
            touched |= {session.client: None for session in self._sessions.values() if session.events(events, now_s)}
        return touched

    def tick(self, now_s: float) -> Iterable[int]:
        """Look after manners and rates, some times a second; the clients who have something to be sent."""
        touched: dict[int, None] = dict.fromkeys(self._evicted)
        self._evicted.clear()
        for client in self.places.slow(now_s):
            self._sessions[client].fail("timeout", f"others wait: expected a long message to be whole within {self.limits.document_s:g} s")
            touched[client] = None
        self._hand_out(self._channels.late(now_s), touched)
        if any(until_s <= now_s for until_s in self._interest.values()):
            self._interest = {topic: until_s for topic, until_s in self._interest.items() if until_s > now_s}
            self.watch()
        return touched

    def run_s(self, now_s: float) -> float:
        """The run's clock, as well as it is known here."""
        return now_s + self._run_minus_ours_s

    def _hand_out(self, flows: Iterable[Flow], touched: dict[int, None]) -> None:
        sessions = self._sessions
        for flow in flows:
            session = sessions.get(flow.client)
            if session is not None:
                session.subscriptions.put(flow)
                touched[flow.client] = None

    # for sessions ------------------------------------------------------------------------------------------------
    def ask(self, session: Session, request: AnyRequest, size_bytes: int = 0) -> None:
        """Hand a request to the executive; it came as a message of so many bytes."""
        self._asked.add(session.client)
        person = session.name if self.access.keys else ""
        self._send(Ask(session.client, session.session, session.name, request, session.peer, person, size_bytes))

    def refused(self, session: Session, what: str, code: str, text: str) -> None:
        """Tell the audit log what a client may not do."""
        self._send(Refused(session.client, session.session, session.name, session.peer, what, code, text))

    def describe(self, request: Describe) -> Description:
        """What exists. Raises: RefusedError."""
        self._described = self._described or described(self.topics, self._catalogue)
        return describe(request, self._described)

    def get(self, topic: str, now_s: float) -> Newest | None:
        """The newest value of a topic if it is known here; if not, it will be."""
        name = ALIASES.get(topic, topic)
        if name not in self.topics or name == "events":
            return None
        is_new = name not in self._interest
        self._interest[name] = now_s + INTEREST_S
        if is_new and name not in self._watched:
            self.watch()
            return None
        return self._channels.newest(name)

    def _require_topic(self, pattern: str) -> None:
        """Raises: RefusedError `unknown-topic` if the pattern means no topic of this run."""
        if not any(matches(pattern, topic) for topic in self.topics):
            raise RefusedError("unknown-topic", f'unknown topic "{pattern}"; {did_you_mean(pattern, self.topics) or "<describe/> lists all"}')

    def wish(self, session: Session, request: Subscribe | Unsubscribe, now_s: float) -> None:
        """Watch what the session wants from now on, and give it what is already here. Raises: RefusedError."""
        old = dict(session.subscriptions.flows)
        if isinstance(request, Subscribe):
            self._require_topic(request.topic)
            session.subscriptions.add(request, self.topics)
        elif not session.subscriptions.remove(request.topic):
            raise RefusedError("invalid", f'expected a topic or pattern that was subscribed to, found "{request.topic}"')
        session.say(Ok(id=request.id))
        self._leave(old, session)
        self.watch()
        subscriptions = session.subscriptions
        for topic, flow in subscriptions.flows.items():
            if old.get(topic) is not flow and self._channels.join(topic, flow, now_s):
                subscriptions.put(flow)

    def _leave(self, old: dict[str, Flow], session: Session) -> None:
        for topic, flow in old.items():
            if session.subscriptions.flows.get(topic) is not flow:
                self._channels.leave(topic, flow)

    def watch(self) -> None:
        """Tell the executive which topics are wanted, if that has changed."""
        wished = {topic for session in self._sessions.values() for topic in session.subscriptions.flows}
        wanted = tuple(topic for topic in self.topics if topic in wished or topic in self._interest)
        if wanted != self._watched:
            self._channels.forget(topic for topic in self._watched if topic not in wanted)
            self._watched = wanted
            self._send(Watch(wanted))
