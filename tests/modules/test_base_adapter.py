"""The base adapter: commands, dead-man, topics."""

from __future__ import annotations

import math
from typing import Any

from drivers.records import BatteryRecord, BumperRecord, OdometryRecord, SonarRecord
from pluto_bt.blackboard.messages import ActuatorState, BatteryState, SonarState
from pluto_bt.modules.base import Base


def velocity(v: float, w: float) -> ActuatorState:
    return ActuatorState(0.0, 0, velocity=(v, w))


def test_newest_velocity_goes_to_the_motors_and_is_published_when_it_changes(make_rig: Any) -> None:
    rig = make_rig()
    base, inbox = Base(rig.context), rig.context.inboxes["base"]
    base.start(0.0)
    for k, v in enumerate((0.1, 0.2, 0.2)):
        inbox.post("drive", velocity(9.0, 9.0))
        inbox.post("drive", velocity(v, 0.0))
        base.step(0.1 * k)
    assert rig.devices["base"].driven == [(0.0, 0.0), (0.1, 0.0), (0.2, 0.0), (0.2, 0.0)]
    sample = rig.context.board.newest("ATRV2/Drive/Command")
    assert sample.seq == 2 and sample.value.velocity == (0.2, 0.0) and sample.value.stamp_s == 0.1


def test_without_a_command_for_03_s_the_wheels_stop_once_and_it_is_said(make_rig: Any) -> None:
    rig = make_rig()
    base = Base(rig.context)
    rig.context.inboxes["base"].post("drive", velocity(0.5, 0.1))
    for k in range(60):
        base.step(k * 0.02)
        is_moving = rig.devices["base"].driven[-1] != (0.0, 0.0)
        assert is_moving == (k * 0.02 <= 0.3)
    assert rig.devices["base"].driven == [(0.5, 0.1), (0.0, 0.0)]
    assert rig.codes() == ["base-dead-man"]


def test_a_stop_is_zero_velocity_and_rubbish_is_too(make_rig: Any) -> None:
    rig = make_rig()
    base, inbox = Base(rig.context), rig.context.inboxes["base"]
    inbox.stop("operator", 0.0)
    inbox.post("drive", velocity(0.5, 0.0))
    base.step(0.0)
    inbox.post("drive", velocity(math.nan, 0.0))
    base.step(0.02)
    assert rig.devices["base"].driven == [(0.0, 0.0), (0.0, 0.0)]


def test_records_become_topics(make_rig: Any) -> None:
    rig = make_rig()
    base = Base(rig.context)
    rig.devices["base"].records = [
        OdometryRecord(0.02, 0.03, 1.5, 0.2, 0.4, 0.1),
        SonarRecord(0.01, 0.03, (1.0, 2.0)),
        BatteryRecord(0.0, 0.03, 25.5),
    ]
    base.step(0.03)
    raw = rig.newest("ATRV2/Drive/Raw")
    assert (raw.stamp_s, raw.position, raw.velocity) == (0.02, (1.5, 0.2), (0.4, 0.1))
    assert rig.newest("ATRV2/Sonar") == SonarState(0.01, (1.0, 2.0))
    assert rig.newest("ATRV2/Battery") == BatteryState(0.0, 25.5)


def test_odometry_that_is_not_a_number_is_dropped_and_said_once(make_rig: Any) -> None:
    rig = make_rig()
    base = Base(rig.context)
    rig.devices["base"].records = [OdometryRecord(0.1 * k, 0.1 * k, math.nan, 0.0, 0.0, 0.0) for k in range(5)]
    base.step(0.5)
    assert rig.newest("ATRV2/Drive/Raw") is None
    assert rig.codes() == ["bad-odometry"]


def test_bumpers_change_at_once_and_else_every_tenth_of_a_second(make_rig: Any) -> None:
    rig = make_rig()
    base, written = Base(rig.context), []
    for k in range(20):
        rig.devices["base"].records = [BumperRecord(k * 0.02, k * 0.02, 7 <= k < 9, False)]
        base.step(k * 0.02)
        sample = rig.context.board.newest("ATRV2/Bumper")
        if not written or sample.seq != written[-1][1]:
            written.append((k, sample.seq, sample.value.front))
    assert [(k, front) for k, _, front in written] == [(0, False), (5, False), (7, True), (9, False), (14, False), (19, False)]
