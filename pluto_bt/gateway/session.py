"""One client in the gateway: what his bytes lead to, and what he is sent. No socket, no clock: bytes and time are passed in."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from pluto_bt.gateway import requests
from pluto_bt.gateway.access import SCOPES, Key, may, scope_of, shown_scopes
from pluto_bt.gateway.encode import encode
from pluto_bt.gateway.framing import Message
from pluto_bt.gateway.manners import Manners
from pluto_bt.gateway.newest import Newest
from pluto_bt.gateway.outstanding import Outstanding
from pluto_bt.gateway.parse import parse
from pluto_bt.gateway.places import Place
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.protocol import STOPS, Connection
from pluto_bt.gateway.replies import CAPABILITIES, AnyReply, Error, Hello, Pong, Value, with_id
from pluto_bt.gateway.requests import AnyRequest, Estop, Stop, acts
from pluto_bt.gateway.stops import Stops
from pluto_bt.gateway.subscriptions import ALIASES, Subscriptions
from pluto_bt.gateway.wire import Answer

if TYPE_CHECKING:
    from pluto_bt.gateway.hub import Hub

OPERATORS = frozenset({"operator", "shell", "console"})


class Session:
    """A connection with what the client asked for. `receive`, `tick` and `to_send` are all that a server needs.

    Args:
        is_reserve: the connection took one of the operators' places: it must stop the robot or say hello as an operator.

    Attributes:
        peer: the client's address, for the audit log; the server sets it.
        name, session: what he said in hello; with a token, the name that belongs to it.
        place: of his long message; while that `is_held_up`, give us no more of it.
    """

    def __init__(self, client: int, hub: Hub, now_s: float, *, is_reserve: bool = False) -> None:
        self.client = client
        self.peer = self.name = self.session = ""
        self.subscriptions = Subscriptions(client)
        self._hub = hub
        self._connection = Connection(hub.limits)
        self.queue = self._connection.queue  # replies that wait for `to_send`
        self._stops = Stops()
        self._scopes: tuple[str, ...] = () if hub.access.keys else SCOPES
        self._is_known = not hub.access.keys  # by a token, or by a certificate
        self._greeted = False
        self._answered_at = hub.batches  # how much the executive had told when it last answered: that is out of date
        self._is_reserve, self._has_stopped = is_reserve, False
        self._outstanding = Outstanding(hub.limits)
        self.place = Place(hub.places, client)
        self._taken_bytes = 0  # of the message that is being taken
        self._manners = Manners(hub.limits, now_s)

    @property
    def is_waiting(self) -> bool:
        """True while an answer of the executive is outstanding."""
        return bool(self._outstanding) or self._stops.is_under_way

    @property
    def is_stranger(self) -> bool:
        """True for who sits in an operator's place and has not shown that he is one."""
        return self._is_reserve and not self._greeted and not self._has_stopped

    @property
    def closing(self) -> bool:
        """The connection ends: send what is left, half-close, discard input."""
        return self._connection.closing

    def known_as(self, key: Key | None) -> None:
        """The TLS library has verified a client certificate: it stands for a token."""
        if key is not None:
            self.name, self._scopes, self._is_known = key.name, key.scopes, True

    # from the client ---------------------------------------------------------------------------------------------
    def receive(self, data: bytes, now_s: float) -> None:
        """Bytes from the client, all at once."""
        for _ in self.taking(data, now_s):
            pass

    def taking(self, data: bytes, now_s: float) -> Iterator[None]:
        """Bytes from the client, a message each time, so that others may have their turn between two of them."""
        self._manners.heard(now_s)
        for message in self._connection.feed(data, now_s):
            self._take(message, now_s)
            yield
        self._mind_place(now_s)

    def _mind_place(self, now_s: float) -> None:
        self.place.mind(self._connection.unfinished_bytes, self._outstanding.size_bytes, now_s)

    def _take(self, message: Message, now_s: float) -> None:
        if self.closing and message.tag not in STOPS:
            return
        id, self._taken_bytes = message.attrib.get("id", "")[:128], len(message.raw)
        try:
            request = parse(message)
            if self._may_speak(request):
                self._do(request, now_s)
            else:
                self._note_refused(message, "too-many-connections" if self._is_known else "unauthorised", "its sender has not said who he is")
        except RefusedError as refusal:
            self._note_refused(message, refusal.code, refusal.text)
            self.say(Error(id=id, code=refusal.code, text=refusal.text, line=message.line, column=message.column))
        except Exception as error:  # a fault of ours ends this connection, not those of all the others
            self.say(Error(id=id, code="internal", text=f"<{message.tag}>: {type(error).__name__}: {error}"))
            self._connection.close()

    def _note_refused(self, message: Message, code: str, text: str) -> None:
        if acts(message.tag, message.attrib.get("op", "")):
            self._hub.refused(self, message.tag, code, text)

    def _may_speak(self, request: AnyRequest) -> bool:
        """A stop always; else what the place and the token demand."""
        if isinstance(request, Stop | Estop):
            return True
        is_hello = isinstance(request, requests.SayHello)
        if self._is_reserve and not self._greeted and not (isinstance(request, requests.SayHello) and request.name.partition(" ")[0] in OPERATORS):
            self.fail("too-many-connections", f"the last places are for operators: <stop/>, or hello with a name of {', '.join(sorted(OPERATORS))}")
            return False
        if not self._is_known and not is_hello:
            self.fail("unauthorised", 'expected <hello token="…"/> as the first message')
            return False
        if not is_hello and not may(self._scopes, request):
            scope, mine = scope_of(request), shown_scopes(self._scopes)
            raise RefusedError("read-only", f"expected somebody with the scope {scope}, found {self.name or 'a client'} with {mine}")
        return True

    def _do(self, request: AnyRequest, now_s: float) -> None:
        hub = self._hub
        match request:
            case Stop() | Estop():
                self._stop(request)
            case requests.SayHello():
                self._hello(request, now_s)
            case requests.Ping():
                self.say(Pong(id=request.id, t=request.t, time_s=hub.run_s(now_s)))
            case requests.Describe():
                self.say(hub.describe(request))
            case requests.Subscribe() | requests.Unsubscribe():
                hub.wish(self, request, now_s)
            case requests.Get():
                self._get(request, now_s)
            case requests.Bye():
                self._connection.close()
            case _:
                self._ask(request)

    def _hello(self, request: requests.SayHello, now_s: float) -> None:
        if self._greeted:
            raise RefusedError("wrong-state", "hello is said once a connection; connect anew for another name or session")
        if request.version.split(".")[0] != "1":
            self.fail("unsupported-version", f'expected version 1.0, found "{request.version}"', request.id)
            return
        if not self._is_known or (request.token and self._hub.access.keys):
            key = self._hub.access.by_token(request.token)
            if key is None:
                self.fail("unauthorised", "the token is none of those in the gateway's file of people", request.id)
                self._hub.refused(self, "hello", "unauthorised", f"a token that is nobody's, from somebody who calls himself {request.name!r}")
                return
            self.known_as(key)
        self._greeted = True
        self.name, self.session = self.name or request.name, request.session
        robot = self._hub.robot
        self.say(Hello(id=request.id, robot=robot, session=self.session, time_s=self._hub.run_s(now_s), capabilities=CAPABILITIES))

    def _stop(self, request: Stop | Estop) -> None:
        self._has_stopped = True
        now = self._stops.add(request)
        if now is not None:
            self._hub.ask(self, now)
        if self._stops.is_flood:
            self.fail("rate-limit", "a thousand stops wait for their answer; the robot is being stopped")

    def _ask(self, request: AnyRequest) -> None:
        self._outstanding.add(self._taken_bytes)
        self._hub.ask(self, request, self._taken_bytes)

    def _get(self, request: requests.Get, now_s: float) -> None:
        """Answered here if what is known here is no older than anything that this client has heard from the executive; else asked for."""
        is_fresh = not self._outstanding and self._hub.batches > self._answered_at
        newest = self._hub.get(request.topic, now_s)
        if newest is None or not is_fresh:
            self._ask(request)
            return
        self._connection.send(newest.line(now_s, shown=request.topic, id=request.id))

    # to the client -----------------------------------------------------------------------------------------------
    def say(self, reply: AnyReply) -> None:
        """A reply: never dropped."""
        self._connection.send(encode(reply))

    def fail(self, code: str, text: str, id: str = "") -> None:
        """A fatal error."""
        self._connection.fail(code, text, id=id)
        self.place.leave()

    def end(self) -> None:
        """The connection is gone. What it kept goes at once: somebody may still know this object for a while."""
        self._connection.close()
        self.subscriptions.end()
        self.place.end()

    def answer(self, answer: Answer, now_s: float) -> None:
        """The executive's word to one of our requests."""
        reply = answer.reply
        self._answered_at = self._hub.batches
        if answer.lane == "stop":
            ids, following = self._stops.answered()
            for id in ids:
                self.say(with_id(reply, id))
            if following is not None:
                self._hub.ask(self, following)
            return
        if answer.lane == "direct":
            self._outstanding.answered()
            self._mind_place(now_s)
        if isinstance(reply, Value):
            newest = Newest(ALIASES.get(reply.topic, reply.topic), reply.seq, reply.age_s, now_s, reply.payload)
            self._connection.send(newest.line(now_s, shown=reply.topic, id=reply.id))
        else:
            self.say(reply)

    def events(self, events: list[Newest], now_s: float) -> bool:
        """Events are lines like values, but none is dropped. True if this client wants them."""
        flow = self.subscriptions.flows.get("events")
        if flow is not None:
            for event in events:
                self._connection.send(event.line(now_s, id=flow.wish.id))
        return flow is not None

    def to_send(self, now_s: float, room_bytes: int) -> bytes:
        """Replies, then the values that are due and fit into `room_bytes`."""
        connection, subscriptions = self._connection, self.subscriptions
        if not connection.waiting_bytes and not connection.closing:
            return subscriptions.take(now_s, room_bytes) if subscriptions.due else b""
        out = connection.to_send()
        return out if connection.closing else out + subscriptions.take(now_s, room_bytes - len(out))

    def tick(self, now_s: float, unread_bytes: int) -> None:
        """Watch the client's manners: silence, and replies that he does not read."""
        is_unknown = not self._is_known or self.is_stranger
        if fault := self._manners.fault(now_s, unread_bytes, is_unknown=is_unknown, is_held_up=self.place.is_held_up):
            self.fail(*fault)
