"""Work that takes long, beside the thread that gives it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from queue import SimpleQueue

Work = Callable[[], None]


class Aside:
    """A thread that does one piece of work after the other; it begins with the first, and nobody waits for it when the program ends."""

    def __init__(self) -> None:
        self._work: SimpleQueue[Work | None] = SimpleQueue()
        self._thread: threading.Thread | None = None

    def do(self, work: Work) -> None:
        """Soon. The work must not raise."""
        if self._thread is None:
            self._thread = threading.Thread(target=_go_on, args=(self._work,), name="gateway-aside", daemon=True)
            self._thread.start()
        self._work.put(work)

    def end(self) -> None:
        """No more after what is under way and waits."""
        if self._thread is not None:
            self._thread = None
            self._work.put(None)
            self._work = SimpleQueue()


def _go_on(queue: SimpleQueue[Work | None]) -> None:
    while (work := queue.get()) is not None:
        work()
