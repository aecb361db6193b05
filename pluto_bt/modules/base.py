"""Adapter `base`: the wheels, sonar, bumpers and battery of the robot to their topics, velocity commands to the motors."""

from __future__ import annotations

from math import isfinite
from typing import Protocol, cast

from drivers.records import BatteryRecord, BumperRecord, OdometryRecord, Record, SonarRecord
from pluto_bt.blackboard.messages import ActuatorState, BatteryState, BumperState, Pair, SonarState
from pluto_bt.modules.context import Context, Device

DEAD_MAN_S = 0.3  # DESIGN.md, section 3: the base stops by itself without a command for so long
BUMPER_PERIOD_S = 0.1
REST: Pair = (0.0, 0.0)


class BaseDevice(Device, Protocol):
    """A device that can be driven."""

    def drive(self, speed_mps: float, turn_rate_radps: float) -> None:
        """Set the motors' target; the device stops by itself if this is not called for 0.3 s."""


class Base:
    """Publishes what the base delivers and hands it the newest velocity command; without one for 0.3 s the command is zero."""

    def __init__(self, context: Context) -> None:
        board = context.board
        self._device = cast(BaseDevice, context.devices["base"])
        self._inbox = context.inboxes["base"]
        self._say = context.say
        self._raw = board.publisher("ATRV2/Drive/Raw", "base")
        self._command = board.publisher("ATRV2/Drive/Command", "base")
        self._sonar = board.publisher("ATRV2/Sonar", "base")
        self._bumper = board.publisher("ATRV2/Bumper", "base")
        self._battery = board.publisher("ATRV2/Battery", "base")
        self._velocity = REST
        self._commanded_s = 0.0
        self._bumper_was: tuple[bool, bool] | None = None
        self._bumper_s = 0.0
        self._is_sane = True

    def start(self, now_s: float) -> None:
        """Motors at rest."""
        self._drive(REST, now_s)

    def stop(self) -> None:
        """Motors at rest."""
        self._device.drive(0.0, 0.0)

    def step(self, now_s: float) -> None:
        """Command first, so that it loses no step; then whatever the base has delivered."""
        letter = self._inbox.take()
        if letter is not None:
            velocity = letter.command.velocity
            self._drive(velocity if isfinite(velocity[0] + velocity[1]) else REST, now_s)
        elif self._velocity != REST and now_s - self._commanded_s > DEAD_MAN_S:
            self._drive(REST, now_s)
            self._say("warning", "base-dead-man", "base", f"no velocity command for {DEAD_MAN_S} s: the wheels stop")
        for record in self._device.read():
            self._publish(record, now_s)

    def _drive(self, velocity: Pair, now_s: float) -> None:
        self._device.drive(velocity[0], velocity[1])
        self._commanded_s = now_s
        if velocity != self._velocity:
            self._velocity = velocity
            self._command.put(ActuatorState(now_s, 0, REST, velocity), now_s)

    def _publish(self, record: Record, now_s: float) -> None:
        if type(record) is OdometryRecord:
            distance, heading, speed, turn = record.distance_m, record.heading_rad, record.speed_mps, record.turn_rate_radps
            if isfinite(distance + heading + speed + turn):
                self._is_sane = True
                self._raw.put(ActuatorState(record.stamp_s, 0, (distance, heading), (speed, turn)), now_s)
            elif self._is_sane:  # said once; the topic grows stale, and that stops the robot
                self._is_sane = False
                self._say("error", "bad-odometry", "base", f"odometry is not a number (distance {distance}, heading {heading}): dropped")
        elif type(record) is BumperRecord:
            self._publish_bumper(record, now_s)
        elif type(record) is SonarRecord:
            self._sonar.put(SonarState(record.stamp_s, record.ranges_m), now_s)
        elif type(record) is BatteryRecord:
            self._battery.put(BatteryState(record.stamp_s, record.voltage_v), now_s)

    def _publish_bumper(self, record: BumperRecord, now_s: float) -> None:
        """A change at once; the same again only every 0.1 s, however often the device says it."""
        panels = (record.front, record.back)
        if panels != self._bumper_was or now_s - self._bumper_s > BUMPER_PERIOD_S - 1e-6:
            self._bumper_was, self._bumper_s = panels, now_s
            self._bumper.put(BumperState(record.stamp_s, record.front, record.back), now_s)
