"""The ssh door as a module (`--ssh`): made before anything moves, so that a port in use or a file without keys is told in time."""

from __future__ import annotations

from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.ssh_keys import host_key
from pluto_bt.gateway.ssh_link import SshLink, SshRequest
from pluto_bt.modules.context import Context
from pluto_bt.modules.gateway import Gateway


class Ssh:
    """Keeps the process alive that serves the shell."""

    def __init__(self, context: Context) -> None:
        """Raises: InputError if the address or a host key cannot be had."""
        asked: SshRequest | None = context.system.options.doors.ssh
        assert asked is not None, "made only if it was asked for"
        self._context = context
        self._link = SshLink(asked, host_key())

    @property
    def address(self) -> Address:
        """Where it listens."""
        return self._link.address

    @property
    def pid(self) -> int | None:
        """The process that serves."""
        return self._link.pid

    def start(self, now_s: float) -> None:
        """Spawn the process and tell the address."""
        gateway = self._gateway()
        if gateway is None:
            self._context.say("warning", "no-ssh", "ssh", "nobody can come by ssh, for this run has no gateway; give one with --gateway HOST:PORT")
            return
        self._link.start(now_s, gateway)
        self._context.say("info", "ssh", "ssh", f"the shell is at ssh -p {self.address.port} {self.address.reachable.host}")

    def step(self, now_s: float) -> None:
        """Look after the process."""
        gateway = self._gateway()
        if gateway is not None and self._link.step(now_s, gateway):
            self._context.say("warning", "ssh-died", "ssh", "the process of the ssh door died, or hung; it is started again")

    def stop(self) -> None:
        """Send everybody away, and free the port."""
        self._link.stop()

    def _gateway(self) -> Address | None:
        part = self._context.system.part("gateway")
        return part.component.address if part is not None and isinstance(part.component, Gateway) else None
