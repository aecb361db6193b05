"""The simulator: one robot in one world. Start reading at `Simulator.step`.

The robot's software sees `devices` alone; everything else here is the truth, for summaries, pictures and tests.
"""

from __future__ import annotations

import heapq
import threading
from collections.abc import Callable, Mapping

import numpy as np

from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.script import Action, Carry, FaultAction, Put, Remove
from pluto_bt.maps.world import World
from sim.body import Body
from sim.device import Device
from sim.faultboard import FaultBoard
from sim.ground import Ground
from sim.outfit import Outfit, Setting
from sim.outline import Outline
from sim.script import Script
from sim.simtime import NS, TICK_NS, SimTime, ticks_up
from sim.surroundings import Surroundings
from sim.travel import Contact, Travel


class Simulator:
    """Advances physics in ticks of 10 ms; equal calls with equal seeds give equal bits."""

    def __init__(
        self, world: World, platform: Platform, seed: int, start: tuple[float, float, float] | None = None, ideal: bool | None = None
    ) -> None:
        """`start`: else the world's robot pose, else the origin. `ideal`: the manual's dummies; None = as the world says."""
        self._time = SimTime()
        self._turn = threading.Lock()  # the scene serves one thread at a time, and displays ask for the clearance from theirs
        ideal = world.robot.ideal if ideal is None else ideal
        pose = start or world.robot.pose or (0.0, 0.0, 0.0)
        self._body = Body(platform, pose, seed, ideal, self._time)
        self._outline = Outline(np.array(platform.body.outline_m))
        self._around = Surroundings(world, self._time)
        self._ground = Ground(world)
        self._travel = Travel(self._body, self._outline, self._around, self._time)
        setting = Setting(world, platform, self._body, self._outline, self._ground, self._around, self._travel, self._time, seed, ideal)
        outfit = Outfit(setting)
        self.devices: Mapping[str, Device] = outfit.devices
        self._channels = tuple(outfit.channels.values())
        self._due = [(0, i) for i in range(len(self._channels))]
        self._script = Script(world)
        self._faults = FaultBoard(outfit.channels, self._body.motors, outfit.wrist, self._time)
        self._wrist = outfit.wrist
        self._slips = not ideal
        self._begun = False
        self.on_set_topic: Callable[[str, str], None] = lambda topic, value: None

    def warm(self) -> None:
        """Ask once what the robot touches, so that the first touch waits for no compilation. It changes nothing."""
        with self._turn:
            self._around.contacts(self._outline.at(self._body.pose))

    def step(self, now_s: float) -> None:
        """Advance to the last tick that is not after `now_s`; what is due on the way happens in order: script, motion, sensors."""
        end_ns = round(now_s * NS) // TICK_NS * TICK_NS
        with self._turn:
            if not self._begun:
                self._begun = True
                self._travel.look()
                self._happen()
            while self._time.now_ns < end_ns:
                self._body.apply_commands(self._time.now_ns)
                self._drive_until(min(end_ns, self._next_event_ns()))
                self._happen()

    def _next_event_ns(self) -> int:
        """The next tick at which anything but plain motion may happen; always in the future."""
        next_ns = min(self._script.next_ns(), self._faults.next_end_ns(), self._due[0][0], self._body.motors.next_change_ns())
        return max(ticks_up(next_ns), self._time.now_ns + TICK_NS)

    def _drive_until(self, until_ns: int) -> None:
        """Plain motion under one command on one ground."""
        slip = self._faults.slip
        if self._slips:
            slip = max(slip, self._ground.slip(self._body.x_m, self._body.y_m, self._body.wheel_speed_mps < 0.0))
        self._travel.advance((until_ns - self._time.now_ns) // TICK_NS, slip, self._faults.blocked)

    def _happen(self) -> None:
        """Everything that is due now."""
        now_ns = self._time.now_ns
        if self._faults.next_end_ns() <= now_ns:
            self._faults.end_due()
        if self._script.next_ns() <= now_ns:
            for action in self._script.due(now_ns):
                self._perform(action)
        for action in self._script.entered(self._body.x_m, self._body.y_m):
            self._perform(action)
        if self._wrist:
            self._wrist.bring_to(now_ns)
        while self._due[0][0] <= now_ns:
            i = self._due[0][1]
            self._channels[i].fire(now_ns, self._time.now_s)
            heapq.heapreplace(self._due, (self._channels[i].due_ns, i))

    def _perform(self, action: Action) -> None:
        """Carry out one line of the script."""
        if isinstance(action, FaultAction):
            self._faults.begin(action)
        elif isinstance(action, Remove):
            self._around.remove(action.id)
            self._travel.forget()
        elif isinstance(action, Put):
            self._around.place(action.id, action.x_m, action.y_m)
            self._travel.forget()
        elif isinstance(action, Carry):
            self._body.carry((action.x_m, action.y_m, self._body.theta_rad if action.theta_rad is None else action.theta_rad))
            self._travel.forget()
        else:
            self.on_set_topic(action.topic, action.value)

    @property
    def on_software_fault(self) -> Callable[[FaultAction, bool], None]:
        """Called with (fault, True) when a `module:NAME` or `leaf:NAME` fault begins, (fault, False) when it ends."""
        return self._faults.on_software_fault

    @on_software_fault.setter
    def on_software_fault(self, callback: Callable[[FaultAction, bool], None]) -> None:
        self._faults.on_software_fault = callback

    @property
    def time_s(self) -> float:
        """The tick that the world has reached."""
        return self._time.now_s

    @property
    def pose(self) -> tuple[float, float, float]:
        """True pose: x m, y m, theta rad within [-pi, pi]."""
        return (self._body.x_m, self._body.y_m, wrap_angle(self._body.theta_rad))

    @property
    def velocity(self) -> tuple[float, float]:
        """True velocity of the body: m/s, rad/s."""
        return (self._body.speed_mps, self._body.turn_rate_radps)

    @property
    def distance_m(self) -> float:
        """Length of the true path."""
        return self._body.path_m

    @property
    def collisions(self) -> list[Contact]:
        """Contacts with own speed towards the thing."""
        return self._travel.collisions

    @property
    def hit_by(self) -> list[Contact]:
        """Contacts without own speed towards the thing."""
        return self._travel.hit_by

    @property
    def clearance_m(self) -> float:
        """Exact distance from the outline to everything solid, now; 0 in contact."""
        with self._turn:
            return self._travel.look()

    @property
    def min_clearance_m(self) -> float:
        """The smallest clearance of the run so far."""
        return self._travel.min_clearance_m

    @property
    def actors(self) -> dict[str, tuple[float, float, float]]:
        """Actors that are present: id → (x m, y m, radius m)."""
        return self._around.actors()

    @property
    def outline_m(self) -> tuple[tuple[float, float], ...]:
        """The robot's outline in the map frame, for pictures."""
        return tuple((x, y) for x, y in self._outline.at(self._body.pose).tolist())
