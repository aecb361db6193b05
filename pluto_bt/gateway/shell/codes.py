"""Exit codes of the shell, and the error behind each of them."""

from __future__ import annotations

from pluto_bt.source import PlutoError

DONE, FAILED, USAGE, INTERRUPTED = 0, 1, 2, 130


class UsageError(PlutoError):
    """The command was not said as it must be; the text names what was expected and what was found."""


class FailedError(PlutoError):
    """The command was understood, and could not be done."""
