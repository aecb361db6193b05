"""The gateway as a module: gives the link its view of the robot and steps it."""

from __future__ import annotations

from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.link import Console, GatewayLink
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.port import RobotPort
from pluto_bt.modules.context import Context
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.modules.scenery import scenery
from pluto_bt.source import InputError


class Gateway:
    """Listens from the moment it is made, so that a port in use is told before anything moves."""

    def __init__(self, context: Context) -> None:
        """Raises: InputError if an address that was asked for cannot be had; the default one in use is only a warning."""
        options = context.system.options
        self._say, self._options, self._doors = context.say, options, options.doors
        self._restarts, self._is_lost, self._trouble = 0, False, ""
        port = GatewayPort(context)
        self._console: Console | None = None
        if self._doors.web is not None:
            self._console = Console(self._doors.web, scenery(context.map or options.world, options.robot, port.name, mode="live"))
        self._link = self._open(port, self._doors.gateway)

    def _open(self, port: RobotPort, address: Address | None) -> GatewayLink | None:
        """The link with its ports taken; None if there is nothing to listen on."""
        doors = self._doors
        audit = Audit(doors.audit, lambda text: self._say("error", "no-audit", "gateway", text))
        link = GatewayLink(port, address, doors.access, self._options.robot.gateway, audit, self._console)
        try:
            link.listen()
        except InputError as error:
            if doors.is_gateway_asked or address is None or link.address is not None:
                raise
            fault = error.faults[0]
            self._trouble = f"{fault.message}: {fault.found}"
            return None if self._console is None else self._open(port, None)
        return link

    @property
    def address(self) -> Address | None:
        """Where the gateway listens, None if it does not."""
        return None if self._link is None else self._link.address

    @property
    def console_address(self) -> Address | None:
        """Where the web console is served, None if it is not."""
        return None if self._link is None else self._link.console_address

    @property
    def pid(self) -> int | None:
        """The gateway's process, None while there is none."""
        return None if self._link is None else self._link.pid

    def start(self, now_s: float) -> None:
        """Spawn the process and tell the addresses."""
        if self._trouble:
            self._say("warning", "no-gateway", "gateway", f"this run has no gateway: {self._trouble}; give another port with --gateway HOST:PORT")
        if self._link is None:
            return
        self._link.start(now_s)
        if self.address is not None:
            self._say("info", "gateway", "gateway", f"listening on {self.address}")
        if self.console_address is not None:
            access = self._doors.access
            scheme = "https" if access is not None and access.certificate else "http"
            self._say("info", "web-console", "gateway", f"the web console is at {scheme}://{self.console_address.reachable}/")

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
            self._say("warning", "gateway-lost", "gateway", "the gateway's process has ended, or hung; it is started again")
        if is_back:
            self._say("info", "gateway-restarted", "gateway", f"the gateway's process was started again (start {link.restarts + 1} of this run)")
        self._restarts, self._is_lost = link.restarts, link.is_lost
