"""Why a connection ended, as far as its client knows."""

from __future__ import annotations

from pluto_bt.gateway.errors import GatewayError, NoConnectionError, TurnedAwayError, UnheardError

NO_PLACE = "too-many-connections"
PASSING = frozenset({"slow-consumer", "timeout", NO_PLACE})
"""Fatal, but a new connection may fare better."""
UNHEARD = "without a word (one with TLS does so to a client without its certificate: name it in PLUTO_CERTIFICATE, a program by tls=)"


class Parting:
    """The gateway's last word; or that it never said one to a client without TLS, which asks for another cure."""

    def __init__(self) -> None:
        self._word: GatewayError | None = None  # till the next connection says anything else
        self._unheard: UnheardError | None = None
        self._has_heard = False

    def heard(self, fatal: GatewayError | None = None) -> None:
        """The gateway said something, perhaps that it is over."""
        self._has_heard, self._unheard, self._word = True, None, fatal

    def closed(self, why: str, *, is_plain: bool) -> str:
        """The connection is gone; why, in full."""
        if is_plain and not self._has_heard:
            why = f"{why} {UNHEARD}"
            self._unheard = UnheardError("no-connection", why)
        return why

    def loss_of(self, tag: str, why: str) -> GatewayError:
        """What the one hears whose request went down with the connection: the gateway's own word, if it gave one."""
        if self._word is None:
            kind = NoConnectionError if self._unheard is None else UnheardError
            return kind("no-connection", f"{why} before it answered <{tag}>; whether that was done is not known")
        doubt = "" if self._word.code == NO_PLACE else f"; whether <{tag}> was done is not known"
        return TurnedAwayError(self._word.code, self._word.text + doubt)

    def reason(self, otherwise: GatewayError) -> GatewayError:
        """Why there is no connection: the gateway's last word, if that was to end it; that it never said one."""
        return self._word or self._unheard or otherwise
