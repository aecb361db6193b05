"""The two sockets of the monitor and the thread that serves them. It only ever reads what the executive has left for it."""

from __future__ import annotations

import threading
from typing import Final

import zmq

from pluto_bt.groot.protocol import Desk
from pluto_bt.source import Place
from pluto_bt.source.faults import fail

LOOK_EVERY_MS: Final = 100
SEND_WITHIN_MS: Final = 1000
TRIES: Final = 20  # to find two free neighbours when any port will do
LARGEST_REQUEST: Final = 1 << 20


class Server:
    """REP on `port`, PUB on the one after it. `start` runs the thread, `stop` ends it."""

    def __init__(self, desk: Desk, host: str, port: int) -> None:
        """Take both ports; port 0 = any two neighbours. Raises: InputError if they cannot be had."""
        self._desk = desk
        self._context = zmq.Context()
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="groot", daemon=True)
        self.host, self.port = host, self._bind(host, port)
        if not self.port:
            self._context.destroy(linger=0)
            fail(Place(file="--groot"), "port-in-use", f"the monitor cannot listen on {host}:{port} and {port + 1}",
                 expected="two free neighbouring ports", mend="give another port, or stop the program that has these")  # fmt: skip

    def _bind(self, host: str, port: int) -> int:
        """Both sockets; the port, 0 if it cannot be had."""
        for _ in range(1 if port else TRIES):
            self._replies, self._publisher = self._context.socket(zmq.REP), self._context.socket(zmq.PUB)
            self._replies.setsockopt(zmq.MAXMSGSIZE, LARGEST_REQUEST)
            self._replies.setsockopt(zmq.SNDTIMEO, SEND_WITHIN_MS)
            try:
                taken = port or self._replies.bind_to_random_port(f"tcp://{host}")
                if port:
                    self._replies.bind(f"tcp://{host}:{port}")
                self._publisher.bind(f"tcp://{host}:{taken + 1}")
            except (zmq.ZMQError, zmq.ZMQBindError):
                self._replies.close(0)
                self._publisher.close(0)
            else:
                return taken
        return 0

    def start(self) -> None:
        """Serve from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Serve no more, and free the ports."""
        self._is_over.set()
        if self._thread.is_alive():
            self._thread.join(timeout=2.0)
        self._context.destroy(linger=0)

    def _serve(self) -> None:
        while not self._is_over.is_set():
            if not self._replies.poll(LOOK_EVERY_MS):
                continue
            try:
                self._replies.send_multipart(self._desk.answer(self._replies.recv_multipart()))
            except zmq.Again:  # whoever asked has gone
                continue
