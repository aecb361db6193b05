"""The libraries that only some options need (extras of the package): asked for before the run begins."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Final

from pluto_bt.source import Faults, Place

EXTRAS: Final = {
    "groot": {"zmq": "pyzmq"},
    "record": {"mcap": "mcap"},
    "shell": {"asyncssh": "asyncssh", "prompt_toolkit": "prompt_toolkit"},
    "web": {"aiohttp": "aiohttp"},
}
"""By extra: what is imported, and what that is called where it is installed from."""


def need(extra: str, asked_by: str, faults: Faults) -> bool:
    """Whether the libraries of an extra are there; False and one fault at `asked_by` if not."""
    missing = [package for module, package in EXTRAS[extra].items() if find_spec(module) is None]
    if not missing:
        return True
    what = f"the {'library' if len(missing) == 1 else 'libraries'} {' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} not installed"
    faults.error(Place(asked_by), "not-installed", what, expected=" and ".join(missing), mend=f"pip install 'pluto_bt[{extra}]'")
    return False
