"""Module `alarms`: stasis, stuck wheels and tilt on the blackboard, until they are read."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pluto_bt.blackboard.messages import ActuatorState, AlarmState, ImuState
from pluto_bt.maps.platform import Inertial
from pluto_bt.modules.alarms import Alarms


class Scene:
    """A rig whose wheels and body turn as the test says; steps at 20 Hz."""

    def __init__(self, make_rig: Any, **devices: Any) -> None:
        self.rig = make_rig(**(devices or {"imu": Inertial(absolute=True)}))
        self.topic = "imu/state" if not devices else "dmu/state"
        self.module = Alarms(self.rig.context)
        self.module.start(0.0)
        self.n = 0
        self.wheels = self.body = 0.0

    def run(self, steps: int, wheels_radps: float = 0.0, body_radps: float = 0.0, tilt: tuple[float, float] = (0.0, 0.0),
            command: tuple[float, float] = (0.0, 0.0)) -> AlarmState:  # fmt: skip
        for _ in range(steps):
            self.n += 1
            now_s = 0.05 * self.n
            self.wheels += 0.05 * wheels_radps
            self.body += 0.05 * body_radps
            self.rig.put("ATRV2/Drive/Command", ActuatorState(now_s, 0, (0.0, 0.0), command), now_s)
            self.rig.put("ATRV2/Drive/Raw", ActuatorState(now_s, 0, (0.0, self.wheels), (0.0, wheels_radps)), now_s)
            self.rig.put(self.topic, ImuState(now_s, math.remainder(self.body, math.tau), *tilt, bias_known=True), now_s)
            self.module.step(now_s)
        alarms = self.rig.newest("imu/alarms")
        assert isinstance(alarms, AlarmState)
        return alarms


@pytest.mark.parametrize("devices", [{}, {"dmu": Inertial()}])
def test_wheels_that_turn_a_body_that_does_not_raise_stasis_until_it_is_read(make_rig: Any, devices: dict[str, Any]) -> None:
    scene = Scene(make_rig, **devices)
    assert scene.run(61, 0.5, 0.05) == AlarmState(0.05 * 61, False, False, False, 0.0, 60), "the first step has nothing to compare with"
    assert scene.run(1, 0.5, 0.05).stasis
    assert scene.run(100).stasis
    scene.rig.context.inboxes["alarms"].post("mission", ActuatorState(0.0))
    assert not scene.run(1).stasis


def test_turning_across_the_wrap_of_the_yaw_is_no_stasis(make_rig: Any) -> None:
    assert Scene(make_rig).run(400, 0.8, 0.8).stasis_count == 0


def test_a_sensor_that_is_silent_counts_neither_way(make_rig: Any) -> None:
    scene = Scene(make_rig)
    scene.run(30, 0.5)
    scene.topic = "dmu/state"  # the imu says nothing from here on
    assert 29 + 3 <= scene.run(10, 0.5).stasis_count <= 29 + 4, "its last reading stands for 0.2 s"


def test_a_lean_beyond_the_limit_in_any_direction_is_told_while_it_lasts(make_rig: Any) -> None:
    scene = Scene(make_rig)
    assert not scene.run(1, tilt=(math.radians(49.5), 0.0)).tilted
    alarms = scene.run(1, tilt=(math.radians(-38.0), math.radians(38.0)))
    assert alarms.tilted and math.degrees(alarms.tilt_rad) == pytest.approx(51.6, abs=0.1)
    assert not scene.run(1).tilted


def test_commanded_wheels_that_stand_still_are_stuck(make_rig: Any) -> None:
    scene = Scene(make_rig)
    assert not scene.run(20, command=(0.3, 0.0)).wheels_stuck
    assert scene.run(1, command=(0.3, 0.0)).wheels_stuck
    assert scene.run(10).wheels_stuck
    scene.rig.context.inboxes["alarms"].post("mission", ActuatorState(0.0))
    assert not scene.run(1).wheels_stuck


def test_a_car_whose_wheels_know_no_turns_has_no_stasis(make_rig: Any) -> None:
    rig = make_rig(kinematics="ackermann", imu=Inertial(absolute=True))
    scene = Scene(lambda **devices: rig)
    assert scene.run(80, 0.5, 0.0).stasis_count == 0
