"""Inboxes: how commands travel. A link of the chain takes the newest command of its owner; stop beats all.

The owner of a link's inbox is the upper link while that one's thread runs, and the holder of the lease once it is stopped
(DESIGN.md, section 9). Others get `wrong-state`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

import msgspec

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.blackboard.plain_command import plain

WRONG_STATE = "wrong-state"


class Letter(msgspec.Struct, frozen=True, gc=False):
    """A command as it was posted."""

    source: str
    command: ActuatorState
    is_stop: bool


class Inbox:
    """The place where one link finds its commands. Newest wins; a stop is never overtaken by a command posted before it is taken."""

    def __init__(self, name: str, is_owner: Callable[[str], bool] = lambda source: True) -> None:
        self.name = name
        self.is_owner = is_owner
        self._wakers: tuple[Callable[[], None], ...] = ()
        self._stop_wakers: tuple[Callable[[], None], ...] = ()
        self._letter: Letter | None = None
        self._lock = threading.Lock()

    def post(self, source: str, command: ActuatorState) -> str:
        """Leave a command. Returns "" or the code of the refusal (`wrong-state`: `source` does not own this inbox now).

        Raises: TypeError if it is no command at all.
        """
        command = plain(command)
        with self._lock:  # asked inside: a command that was let in before the latch closed must not come after the stop that follows it
            if not self.is_owner(source):
                return WRONG_STATE
            if self._letter is None or not self._letter.is_stop:
                self._letter = Letter(source, command, False)
        for wake in self._wakers:
            wake()
        return ""

    def stop(self, source: str, stamp_s: float) -> None:
        """Zero velocity at once, whoever asks; a command that waits is dropped."""
        with self._lock:
            self._letter = Letter(source, ActuatorState(stamp_s), True)
        for wake in self._stop_wakers:
            wake()

    def take(self) -> Letter | None:
        """The newest letter, once."""
        if self._letter is None:
            return None  # whoever leaves one right now wakes the link after it
        with self._lock:
            letter, self._letter = self._letter, None
        return letter

    def on_post(self, wake: Callable[[], None], wake_for_stop: Callable[[], None] | None = None) -> None:
        """Call `wake` after each letter, for a stop `wake_for_stop` if it is given, in the sender's thread; both must be quick and must not raise."""
        self._wakers = (*self._wakers, wake)
        self._stop_wakers = (*self._stop_wakers, wake_for_stop or wake)
