"""The trace of a run: one JSON line a tick and a command, and the SHA-256 of all of them. Equal seeds give equal hashes."""

from __future__ import annotations

import hashlib
import threading
from pathlib import Path
from typing import IO

import msgspec


class Trace:
    """Collects lines; keeps only the running hash and, if asked, writes the lines to a file."""

    def __init__(self, path: Path | None = None) -> None:
        self._hash = hashlib.sha256()
        self._file: IO[bytes] | None = path.open("wb") if path is not None else None
        self._encoder = msgspec.json.Encoder()
        self._lock = threading.Lock()
        self.lines = 0

    def line(self, entry: dict[str, object]) -> None:
        """Add one line; the numbers stand with all their digits."""
        text = self._encoder.encode(entry) + b"\n"
        with self._lock:
            self._hash.update(text)
            self.lines += 1
            if self._file is not None:
                self._file.write(text)

    def sha256(self) -> str:
        """The hash of all lines so far."""
        with self._lock:
            return self._hash.hexdigest()

    def close(self) -> None:
        """Write out what is buffered."""
        with self._lock:
            if self._file is not None:
                self._file.close()
                self._file = None
