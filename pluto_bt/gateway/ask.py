"""One request of a client, from the moment it is asked until it is over."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Literal
from xml.etree.ElementTree import Element

from pluto_bt.gateway.errors import GatewayError
from pluto_bt.gateway.requests import looks
from pluto_bt.gateway.xml_text import Attribute

Fate = Literal["again", "lost", "moot"]

_STOPS = {"stop", "estop"}
_ONCE_A_SESSION = {"command", "run"}


class Ask:
    """A request and what became of it. A run is over with its result; everything else with its first reply.

    Attributes:
        line: the request as it is sent.
        ends_s: when its answer is overdue, by the clock of its client.
        told: what a run has said so far, the `<ack>` first.
        reply, error: one of the two is there when it is over.
        on_change: called after each thing that is said to it.
    """

    def __init__(self, id: str, tag: str, line: bytes, ends_s: float, *, is_run: bool = False) -> None:
        self.id, self.tag, self.line, self.ends_s, self.is_run = id, tag, line, ends_s, is_run
        self.told: deque[Element] = deque()
        self.is_acknowledged = False
        self.reply: Element | None = None
        self.error: GatewayError | None = None
        self.on_change: Callable[[Ask], None] = lambda ask: None

    @property
    def is_over(self) -> bool:
        """Answered, or given up."""
        return self.reply is not None or self.error is not None

    def hear(self, message: Element) -> None:
        """A message with our id that is no error."""
        if self.is_run and message.tag != "result":
            if message.tag != "ack" or not self.is_acknowledged:  # a run that was asked for again is acknowledged again
                self.told.append(message)
            self.is_acknowledged = True
            self.ends_s = float("inf")  # it takes as long as it takes; its deadline is the robot's
        else:
            self.reply = message
        self.on_change(self)

    def fail(self, error: GatewayError) -> None:
        """It will not be answered any more."""
        self.error = error
        self.on_change(self)

    def when_over(self, call: Callable[[Ask], None]) -> None:
        """Call this once it is over, at once if it is."""
        if self.is_over:
            call(self)
        else:
            self.on_change = call

    def answer(self) -> Element:
        """The reply. Raises: GatewayError."""
        if self.error is not None:
            raise self.error
        assert self.reply is not None, "asked before it was over"
        return self.reply


def fate(tag: str, attributes: dict[str, Attribute], has_session: bool) -> Fate:
    """What to do with a request whose connection went before its answer came: say it again, or tell that its outcome is not known.

    What only looks can be said again, and so can a stop. A command or a run acts once in a named session, so it can, too. An
    `unsubscribe` is moot: the new connection has no subscription.
    """
    if tag == "unsubscribe":
        return "moot"
    is_harmless = tag in _STOPS or looks(tag, str(attributes.get("op", "get")))
    return "again" if is_harmless or (has_session and tag in _ONCE_A_SESSION) else "lost"
