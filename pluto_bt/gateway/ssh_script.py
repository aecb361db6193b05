"""The lines of a script that comes by ssh, as long as they wait for the one that is being done."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

LINE_CHARACTERS = 1 << 16
UNREAD_CHARACTERS = 1 << 20


class TooMuchError(Exception):
    """More than a script has. The text says what was expected."""


class Script:
    """Text in, whole lines out.

    What waits is bounded. The channel is not paused instead: a channel that is paused does not hear that its client has gone.
    """

    def __init__(self) -> None:
        self._lines: asyncio.Queue[str] = asyncio.Queue()
        self._begun = ""  # a line without its end
        self._unread = 0  # characters in the queue

    def add(self, text: str) -> None:
        """More of it. Raises: TooMuchError."""
        *lines, self._begun = (self._begun + text).split("\n")
        for line in lines:
            self._put(line + "\n")
        if len(self._begun) > LINE_CHARACTERS:
            raise TooMuchError(f"expected lines of at most {LINE_CHARACTERS} characters")
        if self._unread > UNREAD_CHARACTERS:
            raise TooMuchError(f"expected at most {UNREAD_CHARACTERS} characters that wait for the line before them, found {self._unread}")

    def end(self) -> None:
        """It is whole; the last line may be without its end."""
        if self._begun:
            self._put(self._begun)
        self._put("")

    def _put(self, line: str) -> None:
        self._unread += len(line)
        self._lines.put_nowait(line)

    async def lines(self) -> AsyncIterator[str]:
        """Each as soon as it is there, until the end."""
        while line := await self._lines.get():
            self._unread -= len(line)
            yield line
