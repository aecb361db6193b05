"""One command of the shell."""

from __future__ import annotations

from dataclasses import dataclass

from pluto_bt.gateway.shell.arguments import Argument
from pluto_bt.gateway.shell.driving import Act


@dataclass(frozen=True, slots=True)
class Row:
    """A command: its name, what it takes, what it means, who does it.

    Attributes:
        drives: it holds the lease while it goes on.
        shell: the sub-shell it belongs to; "" = all of them.
    """

    name: str
    arguments: tuple[Argument, ...]
    doc: str
    act: Act
    drives: bool = False
    shell: str = ""

    @property
    def usage(self) -> str:
        """How it is said."""
        return " ".join([self.name, *(argument.shown for argument in self.arguments)])
