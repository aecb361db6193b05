"""Where what outlives a run is kept: journals, the audit log, the shell's history, the ssh host key."""

from __future__ import annotations

import os
from pathlib import Path


def state_path() -> Path:
    """The user's own folder, which may not be there yet. Raises: RuntimeError where the user has no home."""
    return Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state") / "pluto"


def state_folder() -> Path:
    """The same, made if it is not there. Raises: OSError, RuntimeError."""
    folder = state_path()
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def open_private(path: str, flags: int) -> int:
    """The `opener` of a file that only the user may read; one that is there keeps its mode. Raises: OSError."""
    return os.open(path, flags, 0o600)
