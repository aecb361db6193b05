"""What a command needs of the person it works for: somewhere to say things, and perhaps a keyboard."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager
from typing import Protocol, TextIO

from pluto_bt.gateway.shell.codes import UsageError

_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def printable(text: str) -> str:
    """The text without what a terminal would obey: the words of missions and clients are not ours."""
    return _CONTROLS.sub("\N{REPLACEMENT CHARACTER}", text)


Keys = AbstractAsyncContextManager[AsyncIterator[str]]


class Face(Protocol):
    """Where a command speaks."""

    @property
    def may_read_files(self) -> bool:
        """The person's files are the ones that this process sees; not so for who comes by ssh."""

    def say(self, text: str) -> None:
        """A line, or some, that stay."""

    def complain(self, text: str) -> None:
        """A line that tells of a failure."""

    def progress(self, text: str) -> None:
        """How it goes on; replaced by the next one, not shown where nobody looks."""

    def keys(self, shown: Callable[[], str]) -> Keys:
        """Keys as they are hit (`up`, `left`, `space`, `q`, …), while `shown` is displayed. Raises: UsageError without a keyboard."""


class PlainFace:
    """Two streams of text, without a keyboard."""

    def __init__(self, out: TextIO, errors: TextIO, *, may_read_files: bool = True) -> None:
        self._out = out
        self._errors = errors
        self._is_live = out.isatty()
        self.may_read_files = may_read_files

    def say(self, text: str) -> None:
        """A line on stdout."""
        print(f"{self._clear()}{printable(text)}", file=self._out, flush=True)

    def complain(self, text: str) -> None:
        """A line on stderr."""
        print(f"{self._clear()}pluto shell: {printable(text)}", file=self._errors, flush=True)

    def progress(self, text: str) -> None:
        """The same line again and again, on a terminal only."""
        if self._is_live:
            print(f"\r\x1b[K{printable(text)}", end="", file=self._out, flush=True)

    def keys(self, shown: Callable[[], str]) -> Keys:
        """There are none."""
        raise UsageError("this command needs a keyboard: say it inside `pluto shell`, at a terminal")

    def _clear(self) -> str:
        return "\r\x1b[K" if self._is_live else ""
