"""Which faults are in force: begins and ends them on records, motors, wrist and software."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Mapping

from pluto_bt.maps.script import FaultAction
from sim.channel import Channel
from sim.motors import Motors
from sim.simtime import NEVER_NS, NS, SimTime, ticks_up
from sim.wrist import WristDevice

FATAL_S = 20.0  # how long a laser takes to reboot, if the script does not say (sick_lms200 sheet, §10)
DEFAULT_SLIP = 1.0

CHANNELS: dict[str, tuple[str, ...]] = {  # device of a script → the channels whose records it spoils
    "base": ("odometry", "sonar", "bumpers", "battery"),
    "imu": ("dmu", "imu"),
}
SOFTWARE = ("module:", "leaf:")


class FaultBoard:
    """Begins faults on demand and ends them in time. Attributes: `slip`, the share of wheel motion lost by faults; `blocked`: wheels held."""

    def __init__(self, channels: Mapping[str, Channel], motors: Motors, wrist: WristDevice | None, time: SimTime) -> None:
        self._channels, self._motors, self._wrist, self._time = channels, motors, wrist, time
        self._ends: list[tuple[int, int, FaultAction]] = []
        self._count = 0
        self._active: list[FaultAction] = []
        self.on_software_fault: Callable[[FaultAction, bool], None] = lambda action, begins: None
        self.slip = 0.0
        self.blocked = False

    def next_end_ns(self) -> int:
        """When the next fault ends."""
        return self._ends[0][0] if self._ends else NEVER_NS

    def begin(self, action: FaultAction) -> None:
        """Let a fault begin now."""
        for_s = action.for_s or (FATAL_S if action.kind == "fatal" else 0.0)
        if for_s > 0.0:
            self._count += 1
            heapq.heappush(self._ends, (ticks_up(self._time.now_ns + round(for_s * NS)), self._count, action))
        if action.device.startswith(SOFTWARE):
            self.on_software_fault(action, True)
            return
        self._active.append(action)
        for channel in self._channels_of(action):
            channel.faults.begin(action)
        self._apply()

    def end_due(self) -> None:
        """End the faults whose time is over."""
        while self.next_end_ns() <= self._time.now_ns:
            action = heapq.heappop(self._ends)[2]
            if action.device.startswith(SOFTWARE):
                self.on_software_fault(action, False)
                continue
            self._active = [other for other in self._active if other is not action]
            for channel in self._channels_of(action):
                channel.faults.end(action)
            self._apply()

    def _channels_of(self, action: FaultAction) -> list[Channel]:
        names = CHANNELS.get(action.device, (action.device,))
        return [self._channels[name] for name in names if name in self._channels]

    def _apply(self) -> None:
        """What the faults in force do to motion."""
        base = [action for action in self._active if action.device == "base"]
        self.blocked = any(action.kind in ("blocked", "stuck") for action in base)
        self._motors.deaf = any(action.kind in ("off", "hang") for action in base)
        slips = [action.value for action in self._active if action.kind == "slip" and action.device in ("base", "odometry")]
        self.slip = max((min(max(DEFAULT_SLIP if value is None else value, 0.0), 1.0) for value in slips), default=0.0)
        if self._wrist:
            self._wrist.bring_to(self._time.now_ns)
            self._wrist.stuck = any(action.device == "wrist" and action.kind in ("stuck", "blocked", "off", "hang") for action in self._active)
