"""A process of ours beside the executive: begun with sockets that stay ours, begun again when it dies, ended when we end."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence

BACK_OFF_S = (0.0, 0.5, 1.0, 2.0, 5.0, 10.0)
STEADY_S = 30.0
FAREWELL_S = 1.0


class Offspring:
    """Runs `main()` of one module. Who looks after it says when it was found dead; it is due again later each time it dies soon."""

    def __init__(self, module: str) -> None:
        self._program = f"from {module} import main; main()"
        self._process: subprocess.Popen[bytes] | None = None
        self._begun_s = 0.0
        self._deaths = 0
        self._due_s: float | None = None

    @property
    def pid(self) -> int | None:
        """None while there is none."""
        return self._process.pid if self._process else None

    @property
    def has_ended(self) -> bool:
        """It is gone, and nobody has noticed yet."""
        return self._process is not None and self._process.poll() is not None

    def begin(
        self, now_s: float, sockets: Sequence[socket.socket | None], words: Sequence[str] = (), environment: Mapping[str, str] | None = None
    ) -> socket.socket | None:
        """Start it; its words are the numbers of its end of a line to us and of these sockets (-1 = None), then `words`.

        Returns:
            Our end of the line; None if there is no room for a process just now: then it is due again later, as after a death.
        """
        self._begun_s, self._due_s = now_s, None
        try:
            return self._start(sockets, words, environment or {})
        except OSError:
            self.bury(now_s)
            return None

    def _start(self, sockets: Sequence[socket.socket | None], words: Sequence[str], environment: Mapping[str, str]) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs:
            fds = [-1 if one is None else one.fileno() for one in (theirs, *sockets)]
            try:
                self._process = self._spawn([*map(str, fds), *words], [fd for fd in fds if fd >= 0], environment)
            except OSError:
                ours.close()
                raise
        return ours

    def _spawn(self, words: Sequence[str], fds: Sequence[int], environment: Mapping[str, str]) -> subprocess.Popen[bytes]:
        # The program's own path goes along, and -P keeps the current folder out of it: a user's folder must not shadow a package.
        path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
        return subprocess.Popen(
            [sys.executable, "-P", "-c", self._program, *words], pass_fds=fds, stdin=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": path, **environment},
        )  # fmt: skip

    def is_due(self, now_s: float) -> bool:
        """It died, and should be begun again now."""
        return self._due_s is not None and now_s >= self._due_s

    def bury(self, now_s: float) -> None:
        """It is dead, or of no use: end it at once, to begin again."""
        self.end(patience_s=0.0)
        self._deaths = self._deaths + 1 if now_s - self._begun_s < STEADY_S else 1
        self._due_s = now_s + BACK_OFF_S[min(self._deaths, len(BACK_OFF_S)) - 1]

    def end(self, patience_s: float = FAREWELL_S) -> None:
        """Let it end by itself for so long, then kill it."""
        self._due_s = None
        process, self._process = self._process, None
        if process is None:
            return
        try:
            process.wait(patience_s)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
