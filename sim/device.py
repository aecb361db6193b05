"""Devices of the simulated robot: queues of records, filled by sensors, emptied by whoever reads. Same interface as a real driver."""

from __future__ import annotations

import heapq
from collections.abc import Callable

from drivers.records import Record
from sim.motors import Motors
from sim.simtime import SimTime

UNREAD_LIMIT = 2048  # records kept for a reader that does not come; the oldest go first


class Device:
    """A source of records. `read` never blocks; it may be called from another thread than the simulator's."""

    def __init__(self, name: str, time: SimTime) -> None:
        self.name = name
        self._time = time
        self._on_the_way: list[tuple[float, int, Record]] = []
        self._count = 0

    def send(self, record: Record) -> None:
        """Let a record arrive at its `arrival_s`."""
        self._count += 1
        heapq.heappush(self._on_the_way, (record.arrival_s, self._count, record))
        if len(self._on_the_way) > UNREAD_LIMIT:
            heapq.heappop(self._on_the_way)

    def read(self) -> list[Record]:
        """What arrived since the last call, newest last."""
        arrived: list[Record] = []
        waiting = self._on_the_way
        if waiting:
            now_s = self._time.now_s + 1e-9
            while waiting and waiting[0][0] <= now_s:
                arrived.append(heapq.heappop(waiting)[2])
        return arrived


class BaseDevice(Device):
    """The base: odometry, sonar, bumper and battery records; takes velocities. Without a command for 0.3 s it stops by itself."""

    def __init__(self, name: str, time: SimTime, motors: Motors) -> None:
        super().__init__(name, time)
        self._motors = motors
        self.on_calibrate: Callable[[float, float], None] = lambda counts_per_m, effective_track_m: None

    def drive(self, speed_mps: float, turn_rate_radps: float) -> None:
        """Set the targets of the motors, robot frame; held within the platform's limits."""
        self._motors.drive(speed_mps, turn_rate_radps)

    def calibrate(self, counts_per_m: float, effective_track_m: float) -> None:
        """From now on the base makes metres and radians of its counts with these figures; distance and heading so far stay."""
        self.on_calibrate(counts_per_m, effective_track_m)
