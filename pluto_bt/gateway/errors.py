"""What can go wrong for a client of the gateway, one class for each thing that a program mends in its own way.

```
PlutoError
└─ GatewayError            .code is the word of PROTOCOL.md, or one of the two of ours
   ├─ NoConnectionError    no-connection: no gateway there, or the connection went before the answer came
   │  └─ UnheardError      it hung up on a client without TLS, and had not said a word: it speaks TLS, most likely
   ├─ NoAnswerError        no-answer: the gateway is there and did not answer in time
   ├─ TurnedAwayError      the gateway ended the connection and says why (every fatal code)
   ├─ NoLeaseError         no-lease, lease-held: somebody else may drive
   ├─ WrongStateError      wrong-state, busy, conflict: not now; after a pause, a stopped thread, an answer
   ├─ EstoppedError        estopped: latched, until the holder of the lease releases it
   └─ BadRequestError      everything else: it would be refused again
```
"""

from __future__ import annotations

from xml.etree.ElementTree import Element

from pluto_bt.source import PlutoError


class GatewayError(PlutoError):
    """The gateway refused, or is not there. `line` and `column` are those of a document that was sent, 0 without one."""

    def __init__(self, code: str, text: str, line: int = 0, column: int = 0) -> None:
        super().__init__(text)
        self.code = code
        self.text = text
        self.line = line
        self.column = column


class NoConnectionError(GatewayError):
    """There is no gateway, or it went before it had answered."""


class UnheardError(NoConnectionError):
    """A gateway hung up on a client without TLS before it had said anything."""


class NoAnswerError(GatewayError):
    """The gateway is there and did not answer in time."""


class TurnedAwayError(GatewayError):
    """The gateway has ended the conversation, or has no place for one just now (`too-many-connections`)."""


class NoLeaseError(GatewayError):
    """Somebody else may drive, or nobody."""


class WrongStateError(GatewayError):
    """Not as things stand; the text says what must be done first."""


class EstoppedError(GatewayError):
    """The emergency stop holds."""


class BadRequestError(GatewayError):
    """What was asked is wrong in itself."""


_CLASSES: dict[str, type[GatewayError]] = {
    "no-connection": NoConnectionError,
    "no-answer": NoAnswerError,
    "no-lease": NoLeaseError,
    "lease-held": NoLeaseError,
    "wrong-state": WrongStateError,
    "busy": WrongStateError,
    "conflict": WrongStateError,
    "estopped": EstoppedError,
}


def error_of(code: str, text: str) -> GatewayError:
    """The error of that code, in its class."""
    return _CLASSES.get(code, BadRequestError)(code, text)


def error_in(message: Element) -> GatewayError:
    """What an `<error>` of the gateway says."""
    code = message.get("code", "internal")
    kind = TurnedAwayError if message.get("fatal") == "true" else _CLASSES.get(code, BadRequestError)
    return kind(code, message.text or "", int(message.get("line", "0")), int(message.get("col", "0")))
