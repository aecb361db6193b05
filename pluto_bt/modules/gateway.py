"""The gateway as a module: gives the link its view of the robot and steps it."""

from __future__ import annotations

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
        port = GatewayPort(context)
        self._watch = port.why_watch
        self._say = context.say
        self._console: Console | None = None
        if options.web is not None:
            self._console = Console(options.web, scenery(context.map or options.world, options.robot, port.name, mode="live"))
        self._trouble = ""
        address = options.gateway or (Address() if options.has_gateway else None)
        self._link = self._open(port, address, is_asked=options.gateway is not None)

    def _open(self, port: RobotPort, address: Address | None, *, is_asked: bool) -> GatewayLink | None:
        """The link with its ports taken; None if there is nothing to listen on."""
        link = GatewayLink(port, address, console=self._console)
        try:
            link.listen()
        except InputError as error:
            if is_asked or link.address is not None or address is None:
                raise
            self._trouble = error.faults[0].message
            return None if self._console is None else self._open(port, None, is_asked=False)
        return link

    @property
    def address(self) -> Address | None:
        """Where the gateway listens, None if it does not."""
        return None if self._link is None else self._link.address

    @property
    def console_address(self) -> Address | None:
        """Where the web console is served, None if it is not."""
        return None if self._link is None else self._link.console_address

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
            self._say("info", "web-console", "gateway", f"the web console is at http://{self.console_address}/")

    def step(self, now_s: float) -> None:
        """Answer, publish, look after the process."""
        if self._link is not None:
            self._watch.step(now_s)
            self._link.step(now_s)

    def stop(self) -> None:
        """Tell the clients, end the process, free the port."""
        if self._link is not None:
            self._link.stop()
