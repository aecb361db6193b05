"""What a gateway beyond the loopback asks for before it talks."""

from __future__ import annotations

import os
import ssl
from typing import NamedTuple

from pluto_bt.gateway.client import Client, GatewayError
from pluto_bt.gateway.listen import Address

UNAUTHORISED = "unauthorised"


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

    def advice(self, error: GatewayError) -> str:
        """What the environment lacks, if that is why it came to this error; "" if it is not."""
        return "; PLUTO_TOKEN is not set: put your token there" if error.code == UNAUTHORISED and not self.token else ""


def stop(address: Address, ticket: Ticket) -> None:
    """Zero velocity at once; by name if the gateway knows us, without one if it does not: a stop is for anyone. Raises: GatewayError."""
    host, port = address
    tls = ticket.context()
    try:
        with Client(host, port, token=ticket.token, tls=tls, backoff=None) as client:
            client.stop()
    except GatewayError as error:
        if error.code != UNAUTHORISED:
            raise
        with Client(host, port, tls=tls, backoff=None) as client:
            client.stop()
