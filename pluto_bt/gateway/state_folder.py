"""Where the gateway's programs keep what outlives a run: history and the ssh host key."""

from __future__ import annotations

import os
from pathlib import Path


def state_folder() -> Path:
    """The user's own folder, made if it is not there. Raises: OSError, RuntimeError where there is none."""
    folder = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local/state") / "pluto"
    folder.mkdir(parents=True, exist_ok=True)
    return folder
