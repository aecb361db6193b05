"""The gateway as the executive's scheduler sees it: a Component that keeps one gateway process alive and serves its requests."""

from __future__ import annotations

import socket
from typing import NamedTuple

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.aside import Aside
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.courier import Courier
from pluto_bt.gateway.exchange import Exchange
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.listen import Address, open_listener
from pluto_bt.gateway.offspring import Offspring
from pluto_bt.gateway.port import RobotPort
from pluto_bt.gateway.wire import Down, Farewell, Scenery
from pluto_bt.runtime.clock import wall_ns

CLIENTS_A_PROCESS = 1 << 32
BACKLOG_BYTES = 256 * 1024
MEMORY = {"MALLOC_MMAP_THRESHOLD_": "131072", "MALLOC_TRIM_THRESHOLD_": "131072"}
"""Long messages are given back to the system when they are done. By itself glibc learns from them to keep such blocks, in pieces, for good."""


class Console(NamedTuple):
    """The web console: where it is served, and what it draws."""

    address: Address
    scenery: Scenery


class GatewayLink:
    """Listens at `address`, in a process of its own; the listening sockets stay ours, so that a restart loses no port and no caller.
    Without an address there is only the web console.

    `listen` (or `start`) raises InputError if the address cannot be had. A gateway that dies, or hangs, is restarted by `step`, later each time
    it dies soon.
    """

    def __init__(
        self,
        port: RobotPort,
        address: Address | None,
        access: Access | None = None,
        limits: Limits | None = None,
        audit: Audit | None = None,
        console: Console | None = None,
    ) -> None:
        self._address = address
        self._console = console
        self._access = access or Access()
        self._limits = limits or Limits()
        self._aside = Aside()
        self._exchange = Exchange(port, self._send, audit, self._aside.do)
        self._listener: socket.socket | None = None
        self._web: socket.socket | None = None
        self._courier: Courier | None = None
        self._process = Offspring("pluto_bt.gateway.process")
        self.restarts = 0

    @property
    def address(self) -> Address | None:
        """Where the gateway listens, None if it does not; with port 0 asked for, the port that was free."""
        return _bound(self._listener)

    @property
    def console_address(self) -> Address | None:
        """Where the web console is served, None if it is not."""
        return _bound(self._web)

    @property
    def is_lost(self) -> bool:
        """True while there is no process."""
        return self._process.pid is None

    @property
    def pid(self) -> int | None:
        """The gateway process."""
        return self._process.pid

    def listen(self) -> None:
        """Take the ports; harmless if they are ours already. Raises: InputError (for an asked port exit 2, for the default one a warning)."""
        if self._listener is None and self._address is not None:
            self._listener = open_listener(self._address, self._access)
        if self._web is None and self._console is not None:
            self._web = open_listener(self._console.address, self._access, "--web")

    def start(self, now_s: float) -> None:
        """Listen and spawn the process. Raises: InputError if `listen` was not called before and the port cannot be had."""
        self.listen()
        if self.is_lost:
            self._spawn(now_s)

    def step(self, now_s: float) -> None:
        """Answer, publish, and look after the process."""
        if not self._is_open:
            return
        if self._courier is not None and (self._courier.ended or self._courier.pulse.is_lost(wall_ns())):
            self._bury(now_s, self._courier)
        if self._process.is_due(now_s):
            self.restarts += 1
            self._spawn(now_s)
        self._exchange.step(now_s, self._has_room)

    def stop(self) -> None:
        """Tell the clients, end the process, free the port."""
        if not self._is_open:
            return
        self._send(Farewell())
        self._process.end()
        if self._courier is not None:
            self._courier.close()
        self._aside.end()
        self._exchange.end()
        for listener in filter(None, (self._listener, self._web)):
            listener.close()
        self._listener = self._web = self._courier = None

    @property
    def _is_open(self) -> bool:
        return self._listener is not None or self._web is not None

    def _spawn(self, now_s: float) -> None:
        ours = self._process.begin(now_s, (self._listener, self._web), environment=MEMORY)
        if ours is None:
            return
        scenery = None if self._console is None else self._console.scenery
        welcome = self._exchange.welcome(self._access, self._limits, 1 + self.restarts * CLIENTS_A_PROCESS, scenery)
        try:
            self._courier = Courier(ours, self._exchange.receive)
        except (OSError, RuntimeError):  # no room for its sockets, or for its thread
            ours.close()
            self._process.bury(now_s)
        else:
            self._courier.send(welcome)

    def _bury(self, now_s: float, courier: Courier) -> None:
        """It has ended, or hangs."""
        self._process.bury(now_s)
        courier.close()
        self._courier = None
        self._exchange.gateway_lost()

    def _has_room(self) -> bool:
        courier = self._courier
        return courier is not None and courier.waiting_bytes < BACKLOG_BYTES

    def _send(self, frame: Down) -> None:
        courier = self._courier
        if courier is not None:
            courier.send(frame)


def _bound(listener: socket.socket | None) -> Address | None:
    return None if listener is None else Address(*listener.getsockname()[:2])
