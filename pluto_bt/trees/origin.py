"""Where a mission came from."""

from __future__ import annotations

from typing import Final, NamedTuple


class Origin(NamedTuple):
    """Where a mission came from: its text, or the file that was read; `files` are the paths of that file and all it includes."""

    text: str = ""
    file: str = ""
    files: tuple[str, ...] = ()


NOWHERE: Final = Origin()
