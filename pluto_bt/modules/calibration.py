"""The calibration of the odometry: read from a file, and written to the base when the drive starts (Pluto manual, 6.1).

The file is TOML, two numbers under the names of the platform file; it is written anew after a change of tyre pressure, by whatever measured it:

    counts_per_m = 143214.0        # encoder counts of one metre
    effective_track_m = 1.15       # the track that turning behaves like when skidding
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Protocol

import msgspec
from msgspec import Meta

from pluto_bt.runtime.parameters import build
from pluto_bt.source import Faults
from pluto_bt.source.toml_reader import read_toml


class Calibration(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What turns counts into metres and radians."""

    counts_per_m: Annotated[float, Meta(gt=0, le=1e9, description="encoder counts of one metre")]
    effective_track_m: Annotated[float, Meta(gt=0, le=100, description="track that turning behaves like when skidding")]


class CalibratedBase(Protocol):
    """A base that takes a calibration."""

    def calibrate(self, counts_per_m: float, effective_track_m: float) -> None:
        """From now on reckon with these; distance and heading so far stay."""


def read_calibration(path: Path, shown: str) -> Calibration:
    """The calibration in a file.

    Raises: InputError with every fault of the file.
    """
    faults = Faults()
    table, locate = read_toml(path, shown, faults)
    calibration = None if faults.has_errors else build(Calibration, table, locate, faults)
    faults.raise_errors()
    assert calibration is not None  # build gives None only together with a fault
    return calibration
