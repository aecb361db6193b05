"""The wall watchdog: names a part that never returns and gets the run to an end.

In lockstep the hung part holds the only thread, so the watchdog interrupts it with a signal whose handler raises `Hung` there.
"""

from __future__ import annotations

import ctypes
import signal
import threading
from collections.abc import Callable
from types import FrameType

from pluto_bt.runtime.clock import wall_ns


class Hung(BaseException):
    """Raised in a thread that made no progress. Not an Exception: a leaf's `except Exception` must not swallow it."""


class Watchdog:
    """Watches a counter that must move at least every `limit_s` seconds of the wall while armed."""

    def __init__(self, progress: Callable[[], int], limit_s: float) -> None:
        self._progress = progress
        self._limit_ns = round(limit_s * 1e9)
        self._period_s = min(0.25, limit_s / 4)
        self._done = threading.Event()
        self._thread: threading.Thread | None = None
        self._watched = threading.get_ident()
        self._old_handler: object = None
        self._in_main = threading.current_thread() is threading.main_thread()

    def __enter__(self) -> Watchdog:
        if self._in_main:
            self._old_handler = signal.signal(signal.SIGUSR2, self._raise)
        self._thread = threading.Thread(target=self._watch, name="pluto-watchdog", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *unused: object) -> None:
        self._done.set()
        if self._thread is not None:
            self._thread.join()
        if self._in_main:
            signal.signal(signal.SIGUSR2, self._old_handler)  # type: ignore[arg-type]  # what signal() gave is what it takes

    def _raise(self, number: int, frame: FrameType | None) -> None:
        raise Hung("no progress")

    def _watch(self) -> None:
        seen, since_ns = self._progress(), wall_ns()
        while not self._done.wait(self._period_s):
            now = self._progress()
            if now != seen:
                seen, since_ns = now, wall_ns()
            elif wall_ns() - since_ns > self._limit_ns:
                self._interrupt()
                since_ns = wall_ns()

    def _interrupt(self) -> None:
        if self._in_main:
            signal.pthread_kill(self._watched, signal.SIGUSR2)
        else:  # a thread cannot be signalled; the exception comes at its next bytecode
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self._watched), ctypes.py_object(Hung))
