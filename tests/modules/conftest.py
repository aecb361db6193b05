"""A rig for adapters: a blackboard, inboxes and devices whose records the test feeds by hand."""

from __future__ import annotations

from typing import Any

import pytest

from drivers.records import Record
from pluto_bt.blackboard import Blackboard, Inbox, Publisher
from pluto_bt.blackboard.messages import Message
from pluto_bt.maps.platform import Body, Devices, Limits, Platform
from pluto_bt.modules.context import Context
from pluto_bt.runtime import VirtualClock


class FedDevice:
    """Delivers what the test puts in, and notes what it is told to do."""

    def __init__(self) -> None:
        self.records: list[Record] = []
        self.driven: list[tuple[float, ...]] = []

    def read(self) -> list[Record]:
        records, self.records = self.records, []
        return records

    def drive(self, speed_mps: float, turn_rate_radps: float) -> None:
        self.driven.append((speed_mps, turn_rate_radps))

    def calibrate(self, *figures: float) -> None:
        self.calibrated = figures

    def move(self, *target: float) -> None:
        self.driven.append(target)


class Rig:
    """One robot without a body."""

    def __init__(self, start: tuple[float, float, float] = (0.0, 0.0, 0.0), kinematics: str = "skid", **devices: Any) -> None:
        body = Body(kinematics=kinematics, outline_m=((0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4)), track_m=0.6)  # type: ignore[arg-type]
        limits = Limits(max_speed_mps=1.0, max_turn_rate_dps=60, acceleration_mps2=0.5, deceleration_mps2=1, turn_acceleration_dps2=90)
        self.events: list[tuple[str, str, str, str]] = []
        self._publishers: dict[str, Publisher] = {}
        self.devices = {name: FedDevice() for name in ("base", "laser", "dmu", "imu", "compass", "gps", "wrist", "marker", "speed")}
        self.context = Context(
            board=Blackboard(),
            clock=VirtualClock(),
            platform=Platform(name="rig", body=body, limits=limits, devices=Devices(**devices)),
            inboxes={name: Inbox(name) for name in ("base", "filter", "drive", "avoid", "motion", "wrist", "arm", "alarms")},
            devices=self.devices,
            map=None,
            say=lambda *event: self.events.append(event),
            is_running=lambda name: True,
            start_pose=start,
        )

    def put(self, topic: str, value: Message, now_s: float = 0.0) -> None:
        """Write a topic as its writer would."""
        board = self.context.board
        if topic not in self._publishers:
            self._publishers[topic] = board.publisher(topic, board.topic(topic).writer)
        self._publishers[topic].put(value, now_s)

    def newest(self, topic: str) -> Any:
        """The newest value, or None."""
        sample = self.context.board.newest(topic)
        return None if sample is None else sample.value

    def codes(self) -> list[str]:
        """The codes of the events so far."""
        return [event[1] for event in self.events]


@pytest.fixture
def make_rig() -> type[Rig]:
    return Rig
