"""The gateway as a module: gives the link its view of the robot and steps it."""

from __future__ import annotations

from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.link import GatewayLink
from pluto_bt.gateway.listen import Address
from pluto_bt.modules.context import Context
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.source import InputError


class Gateway:
    """Listens from the moment it is made, so that a port in use is told before anything moves."""

    def __init__(self, context: Context) -> None:
        """Raises: InputError if the address that was asked for cannot be had; the default one in use is only a warning."""
        options = context.system.options
        self._say = context.say
        self._restarts, self._is_lost, self._trouble = 0, False, ""
        audit = Audit(options.gateway_audit, lambda text: self._say("error", "no-audit", "gateway", text))
        link = GatewayLink(GatewayPort(context), options.gateway or Address(), options.gateway_access, options.robot.gateway, audit)
        self._link: GatewayLink | None = link
        try:
            link.listen()
        except InputError as error:
            if options.gateway is not None:
                raise
            self._link, self._trouble = None, error.faults[0].message

    @property
    def address(self) -> Address | None:
        """Where the gateway listens, None if it does not."""
        return None if self._link is None else self._link.address

    @property
    def pid(self) -> int | None:
        """The gateway's process, None while there is none."""
        return None if self._link is None else self._link.pid

    def start(self, now_s: float) -> None:
        """Spawn the process and tell the address."""
        if self._link is None:
            self._say("warning", "no-gateway", "gateway", f"this run has no gateway: {self._trouble}; give another port with --gateway HOST:PORT")
            return
        self._link.start(now_s)
        self._say("info", "gateway", "gateway", f"listening on {self._link.address}")

    def step(self, now_s: float) -> None:
        """Answer, publish, look after the process."""
        if self._link is not None:
            self._link.step(now_s)
            self._tell(self._link)

    def stop(self) -> None:
        """Tell the clients, end the process, free the port."""
        if self._link is not None:
            self._link.stop()

    def _tell(self, link: GatewayLink) -> None:
        """What operators should know of the process."""
        is_back = link.restarts != self._restarts
        if (link.is_lost or is_back) and not self._is_lost:
            self._say("warning", "gateway-lost", "gateway", "the gateway's process has ended; it is started again")
        if is_back:
            self._say("info", "gateway-restarted", "gateway", f"the gateway's process was started again ({link.restarts} times so far)")
        self._restarts, self._is_lost = link.restarts, link.is_lost
