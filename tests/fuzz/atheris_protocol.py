"""The gateway's protocol under atheris: `python -m tests.fuzz.atheris_protocol -max_total_time=600`. Any exception is a find."""

from __future__ import annotations

import sys

import atheris  # type: ignore[import-not-found,unused-ignore]

with atheris.instrument_imports(include=["pluto_bt.gateway"]):
    from tests.fuzz.protocol_play import Play


def one(data: bytes) -> None:
    """One stream, cut where its first byte says."""
    play = Play()
    cut = data[0] if data else 0
    play.feed([data[1 : 1 + cut], data[1 + cut :]])
    play.heard()


if __name__ == "__main__":
    atheris.Setup(sys.argv, one)
    atheris.Fuzz()
