"""ReadAlarms, TryTurn, IsStuck, IsTilted."""

from __future__ import annotations

import math
from typing import Any

import pytest

from pluto_bt.blackboard.messages import ActuatorState, AlarmState, FVectorState, ImuState
from tests.behaviours.conftest import Stage


def alarm(stage: Stage, **what: Any) -> None:
    stage.robot.values["imu/alarms"] = AlarmState(stage.clock.now_s(), **what)


def turn(stage: Stage, mission: Any, wheels_radps: float, body_radps: float) -> str:
    """Tick until it is over, wheels and body turning at these rates."""
    wheels = body = 3.1  # near the wrap
    for _ in range(100):
        wheels, body = wheels + 0.1 * wheels_radps, math.remainder(body + 0.1 * body_radps, math.tau)
        now_s = stage.clock.now_s() + 0.1
        stage.robot.values["ATRV2/Drive/Raw"] = ActuatorState(now_s, 0, (0.0, wheels), (0.0, wheels_radps))
        stage.robot.values["dmu/state"] = ImuState(now_s, body)
        status = stage.tick(mission)
        if status != "RUNNING":
            return status
    raise AssertionError("TryTurn does not end")


@pytest.mark.parametrize(
    ("what", "wheels", "body", "status", "reason"),
    [
        ("free", 0.6, 0.6, "SUCCESS", ""),
        ("skidding takes its share", 0.6, 0.35, "SUCCESS", ""),
        ("high-centred", 0.6, 0.0, "FAILURE", "stuck"),
        ("thrown the other way", 0.6, -0.6, "FAILURE", "stuck"),
        ("wheels blocked", 0.0, 0.0, "FAILURE", "stuck"),
    ],
)
def test_a_try_turn_tells_whether_the_body_follows_the_wheels(what: str, wheels: float, body: float, status: str, reason: str) -> None:
    stage = Stage()
    mission = stage.load('<TryTurn angle_deg="-20" reason="{why}"/>')
    assert turn(stage, mission, wheels, body) == status
    assert mission.blackboard["why"] == reason
    assert stage.robot.commands[0].velocity == (0.0, pytest.approx(math.radians(40.0))), "-20 = to the left"
    assert stage.robot.commands[-1].velocity == (0.0, 0.0), "it lets go"


def test_a_try_turn_does_not_move_a_robot_that_leans(stage: Stage) -> None:
    alarm(stage, tilted=True, tilt_rad=math.radians(55.0))
    mission = stage.load('<TryTurn reason="{why}"/>')
    assert stage.tick(mission) == "FAILURE"
    assert mission.blackboard["why"] == "tilted"
    assert stage.robot.commands == []


def test_without_an_orientation_sensor_wheels_that_turn_must_do(stage: Stage) -> None:
    mission = stage.load('<TryTurn angle_deg="20"/>')
    heading = 0.0
    for _ in range(20):
        heading -= 0.05
        stage.robot.values["ATRV2/Drive/Raw"] = ActuatorState(stage.clock.now_s() + 0.1, 0, (0.0, heading), (0.0, -0.5))
        status = stage.tick(mission)
        if status != "RUNNING":
            break
    assert status == "SUCCESS"


def test_read_alarms_takes_them_back(stage: Stage) -> None:
    alarm(stage, stasis=True)
    mission = stage.load("<ReadAlarms/>")
    assert stage.tick(mission) == "RUNNING", "the next leaf must not see the old alarm"
    stage.clock.advance(0.05)
    alarm(stage)
    assert stage.tick(mission, 0.05) == "SUCCESS"
    assert stage.robot.alarms_read == 1


STUCK = FVectorState(0.1, (0.0, 0.0), (0, 2, 0, 0), "stuck")
FINE = FVectorState(0.1, (0.0, 0.0), (0, -1, 0, 0))


@pytest.mark.parametrize(
    ("sign", "goto", "alarms", "status"),
    [
        ("any", FINE, {}, "FAILURE"),
        ("any", STUCK, {}, "SUCCESS"),
        ("any", FINE, {"stasis": True}, "SUCCESS"),
        ("any", FINE, {"wheels_stuck": True}, "SUCCESS"),
        ("goto", FINE, {"stasis": True}, "FAILURE"),
        ("stasis", STUCK, {"wheels_stuck": True}, "FAILURE"),
        ("stasis", FINE, {"stasis": True}, "SUCCESS"),
        ("wheels", FINE, {"wheels_stuck": True}, "SUCCESS"),
        ("wheels", STUCK, None, "FAILURE"),
        ("any", STUCK, None, "SUCCESS"),
    ],
)
def test_is_stuck_by_each_sign(stage: Stage, sign: str, goto: FVectorState, alarms: dict[str, bool] | None, status: str) -> None:
    stage.robot.values["motion/status"] = goto
    if alarms is not None:
        alarm(stage, **alarms)
    assert stage.tick(stage.load(f'<IsStuck sign="{sign}"/>')) == status


@pytest.mark.parametrize(("port", "tilt_deg", "status"), [("", 51, "SUCCESS"), ("", 49, "FAILURE"), ('limit_deg="20"', 21, "SUCCESS"),
                                                         ('limit_deg="60"', 51, "FAILURE")])  # fmt: skip
def test_is_tilted(stage: Stage, port: str, tilt_deg: float, status: str) -> None:
    alarm(stage, tilted=tilt_deg > 50, tilt_rad=math.radians(tilt_deg))
    assert stage.tick(stage.load(f"<IsTilted {port}/>")) == status
