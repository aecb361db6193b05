"""One line to many sockets with one call of the kernel: io_uring, two rings in memory that is shared with the kernel, seen as numpy columns.

A burst fills in the columns "fd", "addr" and "len" of as many entries as there are sockets; the rest of an entry never changes. None of the
sends may wait, so all is done when the call returns, and nothing of the line is needed any more. A ring belongs to the thread that made it.

Ref: io_uring_setup(2), io_uring_enter(2), linux/io_uring.h. Needs Linux 6.1.
"""

from __future__ import annotations

import ctypes
import errno
import mmap
import os
import socket

import numpy as np
from numpy.typing import NDArray

from pluto_bt.gateway.burst import Ints

ENTRIES = 1024
"""Sends of one call, a power of two; a longer burst takes more calls."""
_SETUP, _ENTER = 425, 426  # the system calls, by the same numbers on all machines
_FLAGS = 1 << 7 | 1 << 12 | 1 << 13  # SUBMIT_ALL, SINGLE_ISSUER, DEFER_TASKRUN
_SINGLE_MMAP, _GETEVENTS, _OP_SEND = 1, 1, 26
_RINGS_AT, _ENTRIES_AT = 0, 0x10000000  # where mmap finds them

_PARAM_WORDS = 30  # of struct io_uring_params, and which of them is what:
_SETUP_FLAGS, _CQ_ENTRIES, _FEATURES = 2, 1, 5
_SQ_HEAD, _SQ_TAIL, _SQ_ORDER, _CQ_HEAD, _CQ_TAIL, _CQ_RESULTS = 10, 11, 16, 20, 21, 25  # offsets within the rings

_ENTRY = np.dtype(
    {
        "names": ["opcode", "fd", "addr", "len", "flags", "user"],
        "formats": ["u1", "i4", "u8", "u4", "u4", "u8"],
        "offsets": [0, 4, 16, 24, 28, 32],
        "itemsize": 64,
    }
)
_RESULT = np.dtype([("user", "u8"), ("result", "i4"), ("flags", "u4")])


class Uring:
    """Implements `Burst`. Raises: OSError where the kernel has no such ring, or forbids it."""

    def __init__(self) -> None:
        self._call = ctypes.CDLL(None, use_errno=True).syscall
        self._call.restype, self._call.argtypes = ctypes.c_long, [ctypes.c_long] * 7
        params = np.zeros(_PARAM_WORDS, np.uint32)
        params[_SETUP_FLAGS] = _FLAGS
        self._fd = self._kernel(_SETUP, ENTRIES, params.ctypes.data)
        try:
            if not params[_FEATURES] & _SINGLE_MMAP:
                raise OSError(errno.ENOSYS, "the rings are not in one piece")
            self._map(params)
        except OSError:
            self.close()
            raise

    def _map(self, params: NDArray[np.uint32]) -> None:
        """The rings' columns, and what stays the same in all entries."""
        at = params.tolist()
        n_results = at[_CQ_ENTRIES]
        length = max(at[_SQ_ORDER] + 4 * ENTRIES, at[_CQ_RESULTS] + _RESULT.itemsize * n_results)
        rings = mmap.mmap(self._fd, length, offset=_RINGS_AT)
        self._head, self._tail, self._done, self._posted = (
            np.frombuffer(rings, np.uint32, 1, at[word]) for word in (_SQ_HEAD, _SQ_TAIL, _CQ_HEAD, _CQ_TAIL)
        )
        np.frombuffer(rings, np.uint32, ENTRIES, at[_SQ_ORDER])[:] = np.arange(ENTRIES)
        self._results = np.frombuffer(rings, _RESULT, n_results, at[_CQ_RESULTS])
        self._entries = np.frombuffer(mmap.mmap(self._fd, _ENTRY.itemsize * ENTRIES, offset=_ENTRIES_AT), _ENTRY, ENTRIES)
        self._entries["opcode"] = _OP_SEND
        self._entries["flags"] = socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL
        self._entries["user"] = np.arange(ENTRIES)

    def send(self, fds: Ints, line: bytes) -> Ints:
        """See `Burst`."""
        chunks = [self._send(fds[at : at + ENTRIES], line) for at in range(0, len(fds), ENTRIES)]
        return chunks[0] if len(chunks) == 1 else np.concatenate([np.zeros(0, np.int32), *chunks])

    def _send(self, fds: Ints, line: bytes) -> Ints:
        """At most `ENTRIES` sockets. What the kernel does not take, for want of memory, could not be sent now."""
        n, begin, entries = len(fds), int(self._tail[0]), self._entries
        places = (begin + np.arange(n)) % ENTRIES
        entries["fd"][places] = fds
        entries["addr"] = np.frombuffer(line, np.uint8).ctypes.data
        entries["len"] = len(line)
        self._tail[0] = (begin + n) & 0xFFFFFFFF
        by_place = np.full(ENTRIES, -errno.EAGAIN, np.int32)
        n_taken = n_done = 0
        while n_done < n:
            try:
                n_taken += self._kernel(_ENTER, self._fd, n - n_taken, n - n_done, _GETEVENTS)
            except InterruptedError:
                pass
            except OSError:
                if n_done == n_taken:
                    self._tail[0] = self._head[0]
                    break
            n_done += self._collect(by_place)
        return by_place[places]

    def _collect(self, by_place: Ints) -> int:
        """Take what the kernel says; how many sends are done."""
        done, results = int(self._done[0]), self._results
        n = (int(self._posted[0]) - done) & 0xFFFFFFFF
        new = results[(done + np.arange(n)) % len(results)]
        by_place[new["user"]] = new["result"]
        self._done[0] = (done + n) & 0xFFFFFFFF
        return n

    def close(self) -> None:
        """Give the ring back."""
        os.close(self._fd)

    def _kernel(self, number: int, *words: int) -> int:
        """A system call. Raises: OSError."""
        result = int(self._call(number, *words, *[0] * (6 - len(words))))
        if result < 0:
            code = ctypes.get_errno()
            raise OSError(code, os.strerror(code))
        return result
