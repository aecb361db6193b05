"""What the gateway asks of a connection's socket."""

from __future__ import annotations

import asyncio
import socket


def keep_buffers_small(transport: asyncio.Transport, mark_bytes: int) -> None:
    """Kernel and library would hide megabytes of stale values from a slow reader."""
    transport.set_write_buffer_limits(high=mark_bytes)
    connection = transport.get_extra_info("socket")
    if connection is not None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if hasattr(socket, "TCP_NOTSENT_LOWAT"):
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, mark_bytes)


def common_name(transport: asyncio.Transport) -> str:
    """The common name of a verified client certificate, "" without one."""
    subject = (transport.get_extra_info("peercert") or {}).get("subject", ())
    return next((value for names in subject for name, value in names if name == "commonName"), "")
