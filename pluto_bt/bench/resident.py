"""The memory of a process."""

from __future__ import annotations

from pathlib import Path

PAGE_BYTES = 4096


def resident_mb(pid: int | None = None) -> float:
    """What a process has in memory, MB; None = this one."""
    pages = int(Path(f"/proc/{pid or 'self'}/statm").read_text(encoding="ascii").split()[1])
    return pages * PAGE_BYTES / 1e6
