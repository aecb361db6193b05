"""What a gateway beyond the loopback asks for before it talks."""

from __future__ import annotations

import os
import ssl
from typing import NamedTuple

from pluto_bt.gateway.client import GatewayError


class Ticket(NamedTuple):
    """What a gateway beyond the loopback asks for: a token, and the certificate (PEM file) that it must show; "" = not asked for."""

    token: str = ""
    certificate: str = ""

    @classmethod
    def of_environment(cls) -> Ticket:
        """From PLUTO_TOKEN and PLUTO_CERTIFICATE: what stands on a command line, everybody on the machine can read."""
        return cls(os.environ.get("PLUTO_TOKEN", ""), os.environ.get("PLUTO_CERTIFICATE", ""))

    def context(self) -> ssl.SSLContext | None:
        """TLS that trusts this certificate alone, whatever the host is called. Raises: GatewayError."""
        if not self.certificate:
            return None
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.check_hostname = False
        try:
            context.load_verify_locations(self.certificate)
        except OSError as error:
            raise GatewayError("no-connection", f"PLUTO_CERTIFICATE={self.certificate} cannot be read: {error}") from None
        return context
