"""`pluto shell`: talk to a running robot."""

from __future__ import annotations


def main(argv: list[str]) -> int:
    """The shell is a client of the gateway and nothing more."""
    from pluto_bt.gateway.shell.main import main as shell

    return shell(argv)
