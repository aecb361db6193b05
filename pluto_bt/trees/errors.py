"""Errors of missions.

    PlutoError
    ├── InputError
    │   └── MissionError     the file cannot be loaded; `.faults` has every fault
    ├── TickError            a node broke its promise while ticking; the tree has been halted
    └── StepError            inside the engine only: which node it was; the mission turns it into a TickError

A leaf that reads or writes a port meets a PortMisfit, which is a TypeError, as py_trees' own ports would raise it.
"""

from __future__ import annotations

from typing import Any, Final

from pluto_bt.source import InputError, PlutoError

RAISED: Final = (Exception, SystemExit)  # what the code of a leaf may raise: its sys.exit() is a bug of it, and must not end the robot's program


class MissionError(InputError):
    """A mission that cannot be loaded; `faults` holds all faults of all its files."""


class TickError(PlutoError):
    """An error while ticking. The tree is halted before this is raised.

    Attributes:
        path, type: the node and its type name.
        file, line: where the node stands in the mission ("" and 0 if it came from no file).
        reason: what went wrong, without the place.
    """

    def __init__(self, path: str, type_name: str, file: str, line: int, reason: str) -> None:
        self.path, self.type, self.file, self.line, self.reason = path, type_name, file, line, reason
        where = f" at {file or '<text>'}:{line}" if line else ""
        super().__init__(f"node {path!r} ({type_name}){where}: {reason}")


class PortMisfit(TypeError):  # noqa: N818  a leaf of py_trees expects a TypeError; the text is a sentence for people
    """The value of a port does not fit its type."""


class StepError(PlutoError):
    """Raised by a node while it steps; carries the node on its way up to the mission."""

    def __init__(self, node: Any, reason: str) -> None:
        self.node, self.reason = node, reason
        super().__init__(reason)
