"""What goes to a visitor by ssh, as a text file."""

from __future__ import annotations

from contextlib import suppress

import asyncssh

UNREAD_BYTES = 1 << 20


class Stream:
    """One of the two streams to the client, as a text file; who does not read them is sent away, for memory is not endless."""

    encoding = "utf-8"

    def __init__(self, channel: asyncssh.SSHServerChannel[str], *, is_error: bool, is_terminal: bool) -> None:
        self._channel = channel
        self._send = channel.write_stderr if is_error else channel.write
        self._is_terminal = is_terminal

    def write(self, text: str) -> int:
        """Send it."""
        if self._channel.get_write_buffer_size() > UNREAD_BYTES:
            self._channel.abort()
        else:
            with suppress(OSError):  # the client is gone, which is noticed elsewhere
                self._send(text.replace("\n", "\r\n") if self._is_terminal else text)
        return len(text)

    def flush(self) -> None:
        """Nothing waits here."""

    def isatty(self) -> bool:
        """A person looks on."""
        return self._is_terminal
