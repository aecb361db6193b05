"""One line to many sockets at once: what that means, and the way that works everywhere."""

from __future__ import annotations

import errno
import os
import sys
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]


class Burst(Protocol):
    """A way to send one line to many sockets that never block."""

    def send(self, fds: Ints, line: bytes) -> Ints:
        """Send `line` to the sockets `fds` (n,), in that order, as far as each takes it without waiting.

        Returns: (n,) bytes that each took, or minus the errno of what it said instead. Nothing is under way any more.
        """


class Writes:
    """A write for each socket."""

    def send(self, fds: Ints, line: bytes) -> Ints:
        """See `Burst`."""
        write = os.write
        sent = np.full(len(fds), len(line), np.int32)
        for i, fd in enumerate(fds.tolist()):
            try:
                n_bytes = write(fd, line)
            except OSError as error:
                n_bytes = -(error.errno or errno.EIO)
            if n_bytes != len(line):
                sent[i] = n_bytes
        return sent


def fastest() -> Burst:
    """The ring that Linux shares with its programs, where there is one and it may be used; else plain writes."""
    if sys.platform == "linux":
        from pluto_bt.gateway.uring import Uring

        try:
            return Uring()
        except OSError:  # an old kernel, a container that forbids it, or an administrator
            pass
    return Writes()
