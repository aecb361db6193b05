"""The client's side of the protocol without socket and clock: bytes and times are passed in. `Client` and `AsyncClient` are shells around it.

It outlives connections. When one is lost (`closed`) and the next one stands (`opened`), it says hello and subscribes again, and says again
what may be said twice; see `ask.fate` for the rest. A lease is never acquired again by itself: a robot moves because a program
decided so, not because a line came back.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from xml.etree import ElementTree

from pluto_bt.gateway.ask import Ask, Fate, fate
from pluto_bt.gateway.errors import BadRequestError, GatewayError, NoAnswerError, NoConnectionError, TurnedAwayError, error_in
from pluto_bt.gateway.parting import PASSING, Parting
from pluto_bt.gateway.xml_text import Attribute, element

Element = ElementTree.Element
KEPT = 10_000  # messages that nobody has read; beyond, the oldest are dropped
QUIET_S = 10.0  # so long without a word, and the line is tried by a ping
MUTE_S = 20.0  # so long have we said nothing: the gateway takes who is mute for a minute for gone, however well he listens
LINE_BYTES = 64 << 20  # what answers with longer lines is no gateway
RENEWALS = 3  # in the time of one lease, if nothing else is asked for


class Dialogue:
    """What one client asks and hears.

    Attributes:
        inbox: messages that answer no request: values, events, and what follows an `ok`; `dropped` counts those that nobody read in time.
        streams: by id of a request; what follows its answer goes there instead of the inbox.
        welcome: the gateway's last `<hello>`.
        lease_error: why the lease that was to be kept is not ours any more.
        final: why the conversation is over for good.
        is_open: a connection stands. is_dead: it stands, but the other side is silent: close it.
    """

    def __init__(self, hello: Mapping[str, str], timeout_s: float, ids: str) -> None:
        """`hello`: its attributes, "" = not said. `ids`: what all our ids begin with; it must be new for each client of a session."""
        self.timeout_s = timeout_s
        self.inbox: deque[Element] = deque()
        self.streams: dict[str, deque[Element]] = {}
        self.dropped = 0
        self.welcome: Element | None = None
        self.lease_error: GatewayError | None = None
        self.final: GatewayError | None = None
        self.is_open = self.is_dead = False
        self._parting = Parting()
        self._hello = {name: value for name, value in hello.items() if value}
        self._ids, self._count = ids, 0
        self._out = bytearray()
        self._rest = b""
        self._asks: dict[str, Ask] = {}
        self._fates: dict[str, Fate] = {}
        self._subscriptions: dict[str, Ask] = {}  # by topic or pattern
        self._given_up: dict[str, None] = {}
        self._said_again: set[str] = set()  # ids of subscriptions that are not answered anew
        self._heard_s = self._said_s = 0.0
        self._is_pinging = False
        self._every_s = 0.0  # the lease is renewed; 0 = it is not
        self._renew_s = math.inf
        self._topics: dict[str, str] = {}  # id of a subscribe that is not answered -> its topic

    # asking ------------------------------------------------------------------------------------------------------
    def ask(self, tag: str, body: str, attributes: Mapping[str, Attribute], now_s: float, *, is_run: bool = False) -> Ask:
        """Ask something; an `id` in the attributes is kept. What the gateway says is found in the `Ask`."""
        given = {"id": self._new_id(), **attributes}
        id = str(given["id"])
        one = Ask(id, tag, (element(tag, given, body) + "\n").encode(), now_s + self.timeout_s, is_run=is_run)
        if self.final is not None or id in self._asks:
            one.fail(self.final or BadRequestError("invalid", f'the id "{id}" is that of another request, which is not answered yet'))
            return one
        self._asks[id] = one
        self._said_s = now_s
        self._fates[id] = fate(tag, given, "session" in self._hello)
        if tag == "subscribe":
            self._topics[id] = str(given["topic"])
        elif tag == "unsubscribe":
            self._subscriptions.pop(str(given.get("topic")), None)
        if self.is_open:
            self._out += one.line
        return one

    def forget(self, one: Ask) -> None:
        """Nobody waits for its answer any more: it is not said again on another connection."""
        if one.id in self._asks:
            self._given_up[self._end(one.id).id] = None

    def say(self, data: bytes) -> None:
        """Bytes as they are; what comes back is for the inbox."""
        self._out += data

    def say_once(self, tag: str, body: str, attributes: Mapping[str, Attribute]) -> str:
        """One message, on this connection or never; its id. What comes back is for the inbox."""
        given = {"id": self._new_id(), **attributes}
        self.say((element(tag, given, body) + "\n").encode())
        return str(given["id"])

    def keep_lease(self, every_s: float, now_s: float) -> None:
        """Renew the lease from now on, so often; 0 = no more."""
        self._every_s, self.lease_error = every_s, None
        self._renew_s = now_s + every_s if every_s > 0.0 else math.inf

    def to_send(self) -> bytes:
        """What the connection is to carry now."""
        out, self._out = bytes(self._out), bytearray()
        return out

    # the connection ----------------------------------------------------------------------------------------------
    def opened(self, now_s: float) -> None:
        """A connection stands: say who we are, subscribe again, say again what is not answered."""
        self.is_open, self.is_dead, self._is_pinging = True, False, False
        self._rest, self._out, self._heard_s, self._said_s = b"", bytearray(), now_s, now_s
        self._given_up.clear()
        self._said_again = {one.id for one in self._subscriptions.values()}
        again = [one.line for one in (*self._subscriptions.values(), *self._asks.values())]
        if self._hello:
            self.ask("hello", "", {"version": "1.0", **self._hello}, now_s).on_change = self._greeted
        for line in again:
            self._out += line
        if self._every_s:
            self._renew(now_s)

    def closed(self, why: str, *, is_plain: bool = False) -> None:
        """The connection is gone; `is_plain`: it was one without TLS. What may be said again waits for the next one."""
        self.is_open = self.is_dead = False
        why = self._parting.closed(why, is_plain=is_plain)
        for id, one in list(self._asks.items()):
            if self._fates[id] == "moot":
                self._end(id).hear(Element("ok", {"id": id}))
            elif one.tag == "hello" or self._fates[id] == "lost":
                self._end(id).fail(self._parting.loss_of(one.tag, why))

    def reason(self, otherwise: GatewayError) -> GatewayError:
        """Why there is no connection, if more is known than `otherwise`."""
        return self._parting.reason(otherwise)

    def end(self, error: GatewayError) -> None:
        """The conversation is over; everything that waits hears why."""
        self.final = self.final or error
        self.is_open = False
        for id in list(self._asks):
            self._end(id).fail(self.final)

    # hearing -----------------------------------------------------------------------------------------------------
    def feed(self, data: bytes, now_s: float) -> None:
        """Bytes from the gateway, a message a line. What is no message ends the conversation."""
        self._heard_s, self._is_pinging = now_s, False
        *lines, self._rest = (self._rest + data).split(b"\n")
        try:
            if len(self._rest) > LINE_BYTES:
                raise ValueError(f"a line of more than {LINE_BYTES} bytes")
            for line in lines:
                if self.final is None and line.strip():
                    self._hear(ElementTree.fromstring(line.decode()))
        except (ElementTree.ParseError, ValueError) as error:
            self.end(TurnedAwayError("not-well-formed", f"what answers is no gateway: {error}"))

    def _hear(self, message: Element) -> None:
        id = message.get("id", "")
        if message.tag == "error" and message.get("fatal") == "true":
            last = error_in(message)
            self._parting.heard(last)
            if last.code not in PASSING:
                self.end(last)
            return
        self._parting.heard()
        if id not in self._asks:
            if id in self._given_up:
                del self._given_up[id]
            elif id not in self._said_again or message.tag != "ok":
                self._keep(message)
            self._said_again.discard(id)
        elif message.tag == "error":
            self._topics.pop(id, None)
            self._end(id).fail(error_in(message))
        else:
            self._answered(self._asks[id], message)

    def _answered(self, one: Ask, message: Element) -> None:
        if one.id in self._topics:
            self._subscriptions[self._topics.pop(one.id)] = one
        if not one.is_run or message.tag == "result":
            self._end(one.id)
        one.hear(message)

    def _keep(self, message: Element) -> None:
        stream = self.streams.get(message.get("id", ""))
        if stream is not None:
            stream.append(message)
            return
        self.inbox.append(message)
        if len(self.inbox) > KEPT:
            self.inbox.popleft()
            self.dropped += 1

    # time --------------------------------------------------------------------------------------------------------
    @property
    def due_s(self) -> float:
        """When `tick` has something to do."""
        return min(self._renew_s if self.is_open else math.inf, self._ping_s, *(one.ends_s for one in self._asks.values()), math.inf)

    @property
    def _ping_s(self) -> float:
        """When one of us has been silent for too long."""
        return min(self._heard_s + QUIET_S, self._said_s + MUTE_S) if self.is_open and not self._is_pinging else math.inf

    def tick(self, now_s: float) -> None:
        """Give up what is overdue, renew the lease, try a silent line."""
        for id in [id for id, one in self._asks.items() if one.ends_s <= now_s]:
            one = self._end(id)
            self._given_up[id] = None
            if self.is_open:
                one.fail(NoAnswerError("no-answer", f"no answer to <{one.tag}> within {self.timeout_s:g} s"))
            else:
                one.fail(self.reason(NoConnectionError("no-connection", f"no connection to say <{one.tag}> for {self.timeout_s:g} s")))
        if self.is_open and self._renew_s <= now_s:
            self._renew(now_s)
        if now_s >= self._ping_s:
            self._is_pinging = True
            self.ask("ping", "", {}, now_s).on_change = self._pinged

    def _renew(self, now_s: float) -> None:
        self._renew_s = now_s + self._every_s
        self.ask("lease", "", {"op": "renew"}, now_s).on_change = self._renewed

    def _renewed(self, one: Ask) -> None:
        if one.error is not None and one.error.code not in ("no-connection", "no-answer", *PASSING):
            self.keep_lease(0.0, 0.0)
            self.lease_error = one.error

    def _pinged(self, one: Ask) -> None:
        self.is_dead = self.is_dead or (isinstance(one.error, NoAnswerError) and self._is_pinging)

    def _greeted(self, one: Ask) -> None:
        self.welcome = one.reply
        if isinstance(one.error, NoAnswerError):
            self.is_dead = True
        elif one.error is not None and one.error.code not in ("no-connection", *PASSING):
            self.end(one.error)  # who we say to be is refused, and would be again

    def _new_id(self) -> str:
        self._count += 1
        return f"{self._ids}{self._count}"

    def _end(self, id: str) -> Ask:
        del self._fates[id]
        return self._asks.pop(id)
