"""The ssh door as the executive's side sees it: a process that is started, looked after, and ends when we do."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from pluto_bt.gateway.listen import BACKLOG, Address
from pluto_bt.source import Place
from pluto_bt.source.faults import fail

BACK_OFF_S = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0)
STEADY_S = 30.0
DEFAULT_PORT = 7522
_PROGRAM = "from pluto_bt.gateway.ssh import main; main()"


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
        self._listener: socket.socket | None = open_ssh_listener(request.address)
        self.address = Address(*self._listener.getsockname()[:2])  # with port 0 asked for, the port that was free
        self._leash: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._begun_s = 0.0
        self._deaths = 0
        self._retry_s: float | None = None

    @property
    def pid(self) -> int | None:
        """The process that serves."""
        return self._process.pid if self._process else None

    def start(self, now_s: float, gateway: Address) -> None:
        """Spawn the process; its visitors talk to this gateway. Raises: InputError if somebody took the port while we were stopped."""
        self._listener = self._listener or open_ssh_listener(self.address)
        self._leash, theirs = socket.socketpair()
        # The program's own path goes along, and -P keeps the current folder out of it: a user's folder must not shadow a package.
        path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
        words = [str(self._listener.fileno()), str(theirs.fileno()), str(gateway), str(self._keys), str(self._host_key)]
        fds = (self._listener.fileno(), theirs.fileno())
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", _PROGRAM, *words], pass_fds=fds, stdin=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": path, **self._ticket},
        )  # fmt: skip
        theirs.close()
        self._begun_s, self._retry_s = now_s, None

    def step(self, now_s: float, gateway: Address) -> bool:
        """Start it again if it died, later each time it dies soon. True if it was found dead just now."""
        if self._process is not None and self._process.poll() is not None:
            self._end()
            self._deaths = self._deaths + 1 if now_s - self._begun_s < STEADY_S else 1
            self._retry_s = now_s + BACK_OFF_S[min(self._deaths, len(BACK_OFF_S)) - 1]
            return True
        if self._retry_s is not None and now_s >= self._retry_s:
            self.start(now_s, gateway)
        return False

    def stop(self) -> None:
        """End the process, so that visitors are sent away, and free the port."""
        self._end()
        self._retry_s = None
        if self._listener is not None:
            self._listener.close()
        self._listener = None

    def _end(self) -> None:
        if self._leash is not None:
            self._leash.close()
        if self._process is not None:
            try:
                self._process.wait(timeout=1.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._process = self._leash = None


def open_ssh_listener(address: Address) -> socket.socket:
    """A listening socket on any address, for keys are demanded. Raises: InputError if it does not exist or is in use."""
    place = Place(file="--ssh")
    try:
        family, _, _, _, target = socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)[0]
    except OSError as error:
        fail(place, "bad-address", f'unknown host "{address.host}"', found=str(error), mend="give 127.0.0.1, or an address of this machine")
    listener = socket.socket(family, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(target)
        listener.listen(BACKLOG)
    except OSError as error:
        listener.close()
        mend = "stop the other program, or give another port: --ssh 127.0.0.1:0 takes any free one"
        fail(place, "address-in-use", f"cannot listen on {address}", found=error.strerror or str(error), mend=mend)
    return listener
