"""Faults on a stream of records: one small function for each kind, the same for every type of record.

What a fault's `value` acts on is the table VALUE_FIELDS; `nan`, `garbage` and `stuck` act on every number of the reading.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

import msgspec
import numpy as np

from drivers.records import (
    BatteryRecord,
    BumperRecord,
    CompassRecord,
    GpsRecord,
    InertialRecord,
    MarkerRecord,
    OdometryRecord,
    Record,
    ScanRecord,
    SonarRecord,
    SpeedRecord,
    WristRecord,
)
from pluto_bt.maps.script import FaultAction
from sim.noise import Noise

R = TypeVar("R", bound=Record)
Change = Callable[[float], float]

# fmt: off
ALL_FIELDS: dict[type[Record], tuple[str, ...]] = {  # the measured numbers
    ScanRecord:     ("ranges_m",),
    SonarRecord:    ("ranges_m",),
    BumperRecord:   ("front", "back"),
    OdometryRecord: ("distance_m", "heading_rad", "speed_mps", "turn_rate_radps"),
    BatteryRecord:  ("voltage_v",),
    InertialRecord: ("turn_rates_radps", "accelerations_mps2", "theta_rad", "phi_rad", "psi_rad"),
    CompassRecord:  ("heading_rad",),
    GpsRecord:      ("x_m", "y_m"),
    MarkerRecord:   ("x_m", "y_m", "theta_rad", "quality"),
    SpeedRecord:    ("speed_mps",),
    WristRecord:    ("pan_rad", "tilt_rad", "pan_rate_radps", "tilt_rate_radps"),
}
VALUE_FIELDS: dict[type[Record], tuple[str, ...]] = ALL_FIELDS | {  # what noise, bias, jump and wrong add to
    OdometryRecord: ("distance_m",),
    InertialRecord: ("turn_rates_radps",),
    MarkerRecord:   ("x_m", "y_m"),
    WristRecord:    ("pan_rad",),
}
# fmt: on
GARBAGE = 1e6  # nonsense is spread this wide
FATAL_RANGE_M = -1.0


class RecordFault:
    """A fault while it lasts, with what it has to remember."""

    def __init__(self, action: FaultAction, noise: Noise, last: Record | None) -> None:
        self.action = action
        self.noise = noise
        self.held = last
        self.next_s = 0.0
        self.value = action.value if action.value is not None else 0.0

    def change(self, record: R, fields: tuple[str, ...], change: Change) -> R:
        """The record with every number of these fields changed (of a scan or sonar ring: the beams that the fault names)."""
        return msgspec.structs.replace(record, **{field: self._changed(getattr(record, field), change) for field in fields})

    def _changed(self, value: Any, change: Change) -> Any:
        if isinstance(value, bool):
            return bool(change(float(value)))
        if isinstance(value, (int, float)):
            return change(value)
        first, last = self.action.beams or (0, len(value) - 1)
        numbers = [change(float(number)) if first <= i <= last else float(number) for i, number in enumerate(value)]
        if isinstance(value, tuple):
            return tuple(numbers)
        array = np.array(numbers)
        array.setflags(write=False)
        return array


def _off(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Nothing arrives."""
    return None


def _frozen(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """The last good reading again and again, old stamp and all."""
    return msgspec.structs.replace(fault.held, arrival_s=record.arrival_s) if fault.held is not None else None


def _stuck(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Fresh stamps, but the numbers stay at `value`, or as they were when the fault began."""
    fields = ALL_FIELDS[type(record)]
    if fault.action.value is not None:
        return fault.change(record, VALUE_FIELDS[type(record)], lambda _: fault.value)
    if type(fault.held) is not type(record):
        fault.held = record
    return msgspec.structs.replace(record, **{field: getattr(fault.held, field) for field in fields})


def _nan(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Not a number; a switch reads as pressed."""
    return fault.change(record, ALL_FIELDS[type(record)], lambda _: math.nan)


def _garbage(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Nonsense, different in every reading; switches press at random."""
    if isinstance(record, BumperRecord):
        return fault.change(record, ALL_FIELDS[BumperRecord], lambda _: float(fault.noise.uniform() < 0.5))
    return fault.change(record, ALL_FIELDS[type(record)], lambda _: GARBAGE * fault.noise.normal())


def _slow(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Only `rate` readings a second."""
    if now_s < fault.next_s - 1e-9:
        return None
    fault.next_s = now_s + 1.0 / (fault.action.rate or 1.0)
    return record


def _late(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """Arrives `delay` later."""
    return msgspec.structs.replace(record, arrival_s=record.arrival_s + (fault.action.delay_s or 0.0))


def _drop(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """A share `rate` of the readings is lost."""
    share = 1.0 if fault.action.rate is None else fault.action.rate
    return None if fault.noise.uniform() < share else record


def _noise(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """`value` is the standard deviation of additional noise."""
    return fault.change(record, VALUE_FIELDS[type(record)], lambda number: number + fault.value * fault.noise.normal())


def _bias(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """`value` is added."""
    return fault.change(record, VALUE_FIELDS[type(record)], lambda number: number + fault.value)


def _fatal(fault: RecordFault, record: Record, now_s: float) -> Record | None:
    """The laser reboots: −1 in every beam, at the usual rate."""
    return fault.change(record, ALL_FIELDS[type(record)], lambda _: FATAL_RANGE_M)


KINDS: dict[str, Callable[[RecordFault, Record, float], Record | None]] = {
    "off": _off, "hang": _off, "frozen": _frozen, "stuck": _stuck, "nan": _nan, "garbage": _garbage, "slow": _slow, "late": _late,
    "drop": _drop, "noise": _noise, "bias": _bias, "wrong": _bias, "jump": _bias, "fatal": _fatal,
}  # fmt: skip


class RecordFaults:
    """The faults in force on one sensor, in the order they began."""

    def __init__(self, noise: Noise) -> None:
        self._noise = noise
        self._active: list[RecordFault] = []
        self._last: Record | None = None

    def begin(self, action: FaultAction) -> None:
        """From now on."""
        if action.kind in KINDS:
            self._active.append(RecordFault(action, self._noise, self._last))

    def end(self, action: FaultAction) -> None:
        """Over."""
        self._active = [fault for fault in self._active if fault.action is not action]

    def pass_on(self, record: Record, now_s: float) -> Record | None:
        """What the faults leave of a reading; None = it is lost."""
        if not self._active:
            self._last = record
            return record
        passed: Record | None = record
        for fault in self._active:
            if passed is not None:
                passed = KINDS[fault.action.kind](fault, passed, now_s)
        return passed
