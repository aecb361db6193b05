"""The keys of a visitor by ssh, as prompt_toolkit's input: no pipe that could be full, and Ctrl-C goes before all that waits."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext

from prompt_toolkit.input import Input
from prompt_toolkit.input.vt100_parser import Vt100Parser
from prompt_toolkit.key_binding.key_processor import KeyPress

INTERRUPT = "\x03"
SLICE_CHARACTERS = 64
"""How much of a paste is taken up before the other visitors have their turn."""
UNREAD_CHARACTERS = 1 << 20


class Keyboard(Input):
    """What was typed and not yet taken up. It belongs to the loop that runs when it is attached."""

    def __init__(self) -> None:
        self._unread = ""
        self._at = 0  # what is before it has been read
        self._hear: Callable[[], None] | None = None
        self._is_due = False
        self._pressed: list[KeyPress] = []
        self._parser = Vt100Parser(self._pressed.append)

    def type(self, text: str) -> bool:
        """Take it, at once; False if so much waits that it is not taken. As at any terminal, Ctrl-C forgets what was typed before it."""
        at = text.rfind(INTERRUPT)
        if at >= 0:
            self._unread, self._at = text[at:], 0
            self._parser.reset()  # it may stand in the midst of a paste
        elif len(self._unread) - self._at + len(text) > UNREAD_CHARACTERS:
            return False
        else:
            self._unread, self._at = self._unread[self._at :] + text, 0
        self._call_soon()
        return True

    def _call_soon(self) -> None:
        if self._hear is not None and self._at < len(self._unread) and not self._is_due:
            self._is_due = True
            asyncio.get_running_loop().call_soon(self._call)

    def _call(self) -> None:
        self._is_due = False
        if self._hear is not None:
            self._hear()
        self._call_soon()

    # Input -------------------------------------------------------------------------------------------------------
    def read_keys(self) -> list[KeyPress]:
        """The next few."""
        text = self._unread[self._at : self._at + SLICE_CHARACTERS]
        self._at += len(text)
        self._parser.feed(text)
        return self._take()

    def flush_keys(self) -> list[KeyPress]:
        """No more comes for now: Escape was Escape."""
        self._parser.flush()
        return self._take()

    def _take(self) -> list[KeyPress]:
        taken = self._pressed[:]
        self._pressed.clear()
        return taken

    def attach(self, input_ready_callback: Callable[[], None]) -> AbstractContextManager[None]:
        """From now on this one hears, until the context ends."""
        return self._heard_by(input_ready_callback)

    def detach(self) -> AbstractContextManager[None]:
        """Nobody hears, until the context ends."""
        return self._heard_by(None)

    @contextmanager
    def _heard_by(self, hear: Callable[[], None] | None) -> Iterator[None]:
        before, self._hear = self._hear, hear
        self._call_soon()
        try:
            yield
        finally:
            self._hear = before
            self._call_soon()

    @property
    def closed(self) -> bool:
        """A visitor who is gone is told of otherwise."""
        return False

    def raw_mode(self) -> AbstractContextManager[None]:
        """The terminal is at the other end, and raw."""
        return nullcontext()

    cooked_mode = raw_mode

    def fileno(self) -> int:
        """There is none."""
        raise OSError("the keys come over the network")

    def typeahead_hash(self) -> str:
        """Whose keys are kept from one prompt to the next."""
        return f"ssh-{id(self)}"
