"""The ssh door (`--ssh`), a process of its own beside the gateway: keys only, the shell and nothing else.

Whoever comes in talks to the robot as any client of the gateway does. When a client is gone, however it went, its connection to the gateway
ends: the lease with it, and what it drove stops.
"""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import socket
import sys
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import asyncssh

from pluto_bt.gateway.key_ring import KeyRing, shown_name
from pluto_bt.gateway.listen import Address, parse_address
from pluto_bt.gateway.pulse import BEAT_S
from pluto_bt.gateway.ssh_visit import Visit
from pluto_bt.runtime.precedence import precedence

LOGIN_S = 15
KEEPALIVE_S, KEEPALIVES = 3, 3
LOGINS = 48
VISITS = 64
NICENESS = 10


@dataclass
class House:
    """What all connections share, and how many there are."""

    gateway: Address
    keys: Path
    logins: int = 0
    visits: int = 0


class Door(asyncssh.SSHServer):
    """One client at the door. Passwords, forwarding, sftp and scp are refused by asyncssh as long as nothing here offers them."""

    def __init__(self, house: House) -> None:
        self._house = house
        self._connection: asyncssh.SSHServerConnection
        self._keys: KeyRing | None = None
        self._name = ""
        self._is_in = False

    def connection_made(self, conn: asyncssh.SSHServerConnection) -> None:
        """Somebody knocks."""
        self._connection = conn
        self._house.logins += 1
        if self._house.logins > LOGINS:
            conn.abort()

    def begin_auth(self, username: str) -> bool:
        """The keys are read anew, so that one that was taken out opens no more; the user's name is only a name."""
        self._name = username
        with suppress(OSError, ValueError):
            self._keys = KeyRing(self._house.keys)
            self._connection.set_authorized_keys(self._keys)
        return True

    def public_key_auth_supported(self) -> bool:
        """The only way in."""
        return True

    def auth_completed(self) -> None:
        """In; known by his key, whose comment the robot's owner has vouched for, and only without one by the name that he gives himself."""
        self._is_in = True
        self._name = (self._keys.owner if self._keys is not None else "") or shown_name(self._name)
        self._house.logins -= 1

    def connection_lost(self, exc: Exception | None) -> None:
        """Gone; the visits of this connection are told by themselves."""
        if not self._is_in:
            self._house.logins -= 1

    def session_requested(self) -> Visit | bool:
        """A visit, if there is room for one more."""
        if self._house.visits >= VISITS:
            return False
        self._house.visits += 1
        return Visit(self._house.gateway, self._name, self._leave)

    def _leave(self) -> None:
        self._house.visits -= 1


async def serve(listener: socket.socket, leash: socket.socket, house: House, host_key: str) -> None:
    """Serve until the other end of the leash is gone."""
    over = asyncio.Event()
    leash.setblocking(False)
    asyncio.get_running_loop().add_reader(leash, over.set)
    door = await asyncssh.listen(
        sock=listener, server_factory=lambda: Door(house), server_host_keys=[host_key], config=None, server_version="pluto",
        public_key_auth=True, password_auth=False, kbdint_auth=False, host_based_auth=False, gss_host=None, agent_forwarding=False,
        x11_forwarding=False, allow_scp=False, sftp_factory=None, compression_algs=["none"], login_timeout=LOGIN_S, line_editor=False,
        keepalive_interval=KEEPALIVE_S, keepalive_count_max=KEEPALIVES, encoding="utf-8", errors="replace",
    )  # fmt: skip
    beating = asyncio.create_task(_beat(leash))
    await over.wait()
    beating.cancel()
    door.close()


async def _beat(leash: socket.socket) -> None:
    """From the same loop that serves: if one hangs, the other is silent."""
    while True:
        with suppress(OSError):  # nobody reads, or he is gone: then there is nothing to tell
            leash.send(b".")
        await asyncio.sleep(BEAT_S)


def main() -> None:
    """`ssh LEASH_FD LISTENER_FD GATEWAY KEYS HOST_KEY`."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in the run's terminal is the executive's
    with precedence() as is_permitted:
        pass
    if not is_permitted:  # the control loop is not sure to go before the arithmetic of logins
        os.nice(NICENESS)
    logging.getLogger("asyncssh").setLevel(logging.CRITICAL)  # who cannot get in is told so himself
    import_module("pluto_bt.gateway.shell.console")  # now: when the first visitor comes it would hold up all others
    leash, listener = (socket.socket(fileno=int(word)) for word in sys.argv[1:3])
    gateway, keys, host_key = sys.argv[3:6]
    asyncio.run(serve(listener, leash, House(parse_address(gateway), Path(keys)), host_key))


if __name__ == "__main__":
    main()
