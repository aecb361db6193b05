"""The ssh door as the executive's side sees it: a process that is started, looked after, and ends when we do."""

from __future__ import annotations

import socket
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from pluto_bt.gateway.listen import Address, open_listener
from pluto_bt.gateway.offspring import Offspring
from pluto_bt.gateway.pulse import Pulse
from pluto_bt.runtime.clock import wall_ns

DEFAULT_PORT = 7522
SAID_BYTES = 4096


class SshRequest(NamedTuple):
    """`--ssh` and `--ssh-keys`, and what the gateway will ask of the process: a token and TLS, "" = neither."""

    address: Address
    keys: Path
    token: str = ""
    certificate: str = ""


class SshLink:
    """Listens at an address, and keeps one process serving it; the listening socket stays ours, so that a restart loses no port and no caller."""

    def __init__(self, request: SshRequest, host_key: Path) -> None:
        """Raises: InputError if the address cannot be had."""
        self._keys = request.keys
        self._ticket = {"PLUTO_TOKEN": request.token, "PLUTO_CERTIFICATE": request.certificate}
        self._host_key = host_key
        self._listener: socket.socket | None = _listen(request.address)
        self.address = Address(*self._listener.getsockname()[:2])  # with port 0 asked for, the port that was free
        self._leash: socket.socket | None = None
        self._pulse = Pulse(wall_ns())
        self._process = Offspring("pluto_bt.gateway.ssh")

    @property
    def pid(self) -> int | None:
        """The process that serves."""
        return self._process.pid

    def start(self, now_s: float, gateway: Address) -> None:
        """Spawn the process; its visitors talk to this gateway. Raises: InputError if somebody took the port while we were stopped."""
        self._listener = self._listener or _listen(self.address)
        self._leash = self._process.begin(now_s, (self._listener,), (str(gateway), str(self._keys), str(self._host_key)), self._ticket)
        self._pulse = Pulse(wall_ns())

    def step(self, now_s: float, gateway: Address) -> bool:
        """Start it again if it died or hangs, later each time it dies soon. True if it was found so just now."""
        if self._process.has_ended or self._is_mute():
            self._let_go()
            self._process.bury(now_s)
            return True
        if self._process.is_due(now_s):
            self.start(now_s, gateway)
        return False

    def stop(self) -> None:
        """End the process, so that visitors are sent away, and free the port."""
        self._let_go()
        self._process.end()
        if self._listener is not None:
            self._listener.close()
        self._listener = None

    def _is_mute(self) -> bool:
        """It hangs: on the leash it says now and then that it goes round."""
        if self._leash is None:
            return False
        with suppress(OSError):  # nothing, or no more
            if self._leash.recv(SAID_BYTES, socket.MSG_DONTWAIT):
                self._pulse.hear()
        return self._pulse.is_lost(wall_ns())

    def _let_go(self) -> None:
        if self._leash is not None:
            self._leash.close()
        self._leash = None


def _listen(address: Address) -> socket.socket:
    """On any address, for keys are demanded."""
    return open_listener(address, option="--ssh")
