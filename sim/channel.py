"""One sensor on its way to its device: when it is due, what faults do to its records, and in which order they arrive."""

from __future__ import annotations

from typing import Protocol

import msgspec

from drivers.records import Record
from sim.device import Device
from sim.record_faults import RecordFaults
from sim.simtime import NS


class Sensor(Protocol):
    """What a simulated sensor has. A record is stamped with the time of the truth it was made from."""

    @property
    def period_ns(self) -> int:
        """Time between two samples."""

    def sample(self, now_s: float) -> Record | None:
        """A reading of the truth now; None if the device would not send one."""


class Channel:
    """A sensor, its faults and its device. A serial line keeps the order: a delayed record holds up those behind it."""

    def __init__(self, name: str, sensor: Sensor, device: Device, faults: RecordFaults) -> None:
        self.name = name
        self.faults = faults
        self.due_ns = 0
        self._sensor, self._device, self._period_ns = sensor, device, sensor.period_ns
        self._arrival_s = 0.0

    def send_past(self, for_s: float) -> None:
        """Send what the sensor read while the robot stood at its start, up to the beginning of the run; it waits for its first reader."""
        for k in range(round(for_s * NS) // self._period_ns, 0, -1):
            record = self._sensor.sample(-k * self._period_ns / NS)
            if record is not None:
                self._device.send(record)

    def fire(self, now_ns: int, now_s: float) -> None:
        """Take the sample that is due."""
        while self.due_ns <= now_ns:
            self.due_ns += self._period_ns
        record = self._sensor.sample(now_s)
        if record is None or (record := self.faults.pass_on(record, now_s)) is None:
            return
        if record.arrival_s < self._arrival_s:
            record = msgspec.structs.replace(record, arrival_s=self._arrival_s)
        self._arrival_s = record.arrival_s
        self._device.send(record)
