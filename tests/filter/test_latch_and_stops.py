"""Operator stop and emergency stop on the whole robot: latched in one place, released without motion."""

from __future__ import annotations

import math

import pytest

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.gateway.port import RefusedError
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.runtime.latch import ESTOP, OPERATOR_STOP, SafetyLatch
from tests.filter.test_no_contact import hall
from tests.filter.whole_robot import WholeRobot


@pytest.fixture
def robot() -> WholeRobot:
    one = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0))
    one.drive(0.4, 0.0, 1.5)
    assert one.commanded[0] > 0.3
    return one


def test_the_latch_names_the_emergency_stop_first_and_holds_until_both_are_released() -> None:
    latch = SafetyLatch()
    latch.set(OPERATOR_STOP, "shell")
    latch.set(ESTOP, "smoke")
    assert latch.held == (ESTOP, "smoke")
    assert latch.release(ESTOP) and not latch.release(ESTOP)
    assert latch.held == (OPERATOR_STOP, "shell")
    latch.release(OPERATOR_STOP)
    assert latch.held is None


def test_no_inbox_of_the_chain_takes_motion_while_the_latch_holds_and_the_release_moves_nothing(robot: WholeRobot) -> None:
    port = GatewayPort(robot.system.context)
    port.estop("client", "smoke")
    robot.run(0.05)
    assert robot.commanded == (0.0, 0.0)
    for link in ("filter", "drive", "avoid", "motion"):
        for source in ("tester", "drive", "avoid", "motion", "mission"):
            assert robot.system.inboxes[link].post(source, ActuatorState(robot.now_s, 0, (0.0, 0.0), (0.5, 0.0))) == "wrong-state"
    assert robot.system.inboxes["wrist"].post("tester", ActuatorState(robot.now_s)) == "", "the wrist moves nobody"
    assert (robot.verdict.reason, robot.verdict.text) == ("estop", "smoke")
    robot.run(1.0)
    port.release_estop("client")
    robot.run(2.0)
    assert robot.commanded == (0.0, 0.0) and abs(robot.system.simulator.velocity[0]) < 1e-6
    port.post_command("drive", ActuatorState(robot.now_s, 0, (0.0, 0.0), (0.3, 0.0)), "client")
    robot.run(1.0)
    assert robot.commanded[0] == pytest.approx(0.3), "a new command is a deliberate act"


def test_commands_are_refused_with_a_word_while_the_emergency_stop_holds(robot: WholeRobot) -> None:
    port = GatewayPort(robot.system.context)
    port.estop("client", "")
    with pytest.raises(RefusedError) as refused:
        port.post_command("drive", ActuatorState(robot.now_s, 0, (0.0, 0.0), (0.3, 0.0)), "client")
    assert refused.value.code == "estopped"


def test_a_command_posted_right_after_the_stop_does_not_undo_it(robot: WholeRobot) -> None:
    robot.system.operator_stop("shell")
    robot.order(0.5, 0.0)  # a leaf that was in the middle of its tick
    robot.run(1.0)
    assert robot.commanded == (0.0, 0.0)
    assert robot.verdict.reason == OPERATOR_STOP


@pytest.mark.parametrize("velocity", [(math.nan, 0.0), (0.1, math.inf)])
def test_what_is_no_velocity_is_zero(velocity: tuple[float, float]) -> None:
    robot = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0), level="filter")
    robot.drive(*velocity, 0.5)
    assert (robot.commanded, robot.verdict.reason) == ((0.0, 0.0), "bad-command")


def test_a_link_above_that_falls_silent_is_noticed() -> None:
    robot = WholeRobot(hall(), "atrv2", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.4, 0.0, 1.0)
    robot.run(0.3)
    assert robot.commanded == (0.0, 0.0)


def test_blocked_wheels_are_let_go_and_tried_again() -> None:
    from pluto_bt.maps.script import At, FaultAction
    from pluto_bt.maps.world import World

    world = World("hall", shapes=hall().shapes, script=(At(3.0, (FaultAction("base", "blocked", for_s=4.0),)),))
    robot = WholeRobot(world, "atrv2", (0.0, 0.0, 0.0), level="filter")
    robot.drive(0.4, 0.0, 2.9)
    assert robot.verdict.reason == "odometry-frozen"
    assert "the encoders say" in robot.verdict.text
    robot.drive(0.4, 0.0, 6.0)
    assert robot.verdict.reason == "" and robot.system.simulator.velocity[0] > 0.3
