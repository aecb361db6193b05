"""The robot that missions see: its status is that of its own command alone."""

from __future__ import annotations

from typing import Any

from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import BatteryState, FVectorState
from pluto_bt.modules.robot_link import RobotLink

AT_GOAL = FVectorState(0.0, (0.0, 0.0), (0, 1, 0, 0))


def link_of(rig: Any) -> RobotLink:
    link = RobotLink(rig.context)
    robot: Robot = link  # mypy: it is one
    assert robot.platform is rig.context.platform
    return link


def motion_accepts(rig: Any, now_s: float) -> None:
    letter = rig.context.inboxes["motion"].take()
    rig.put("motion/command", letter.command, now_s)


def test_a_latched_status_of_an_earlier_command_is_not_ours(make_rig: Any) -> None:
    rig = make_rig()
    link = link_of(rig)
    rig.put("motion/status", AT_GOAL, 0.0)  # from the goto before
    ticket = link.command(32, (3.0, 4.0), (0.5, 1.0), 0.3)
    link.refresh(0.1)
    assert link.status(ticket) is None  # not yet taken
    rig.context.clock.advance(0.1)
    motion_accepts(rig, 0.1)
    link.refresh(0.1)
    assert link.status(ticket) is None  # taken, but the status is still the old one
    rig.put("motion/status", FVectorState(0.1, element=(0, -1, 0, 0)), 0.1)
    link.refresh(0.2)
    status = link.status(ticket)
    assert status is not None and status.element[1] == -1


def test_the_status_ends_when_another_command_is_taken(make_rig: Any) -> None:
    rig = make_rig()
    link = link_of(rig)
    ticket = link.command(2, (1.0, 0.0))
    motion_accepts(rig, 0.0)
    rig.put("motion/status", AT_GOAL, 0.0)
    link.refresh(0.0)
    assert link.status(ticket) == AT_GOAL
    rig.context.clock.advance(0.1)
    again = link.command(2, (1.0, 0.0))  # the same words at another time are another command
    motion_accepts(rig, 0.1)
    rig.put("motion/status", AT_GOAL, 0.1)
    link.refresh(0.1)
    assert link.status(ticket) is None and link.status(again) == AT_GOAL


def test_the_newest_command_of_a_tick_wins_and_stop_beats_all(make_rig: Any) -> None:
    rig = make_rig()
    link, inbox = link_of(rig), rig.context.inboxes["motion"]
    link.command(0)
    link.command(32, (2.0, 0.0), tolerance_m=0.4, force=2.0)
    letter = inbox.take()
    assert (letter.source, letter.command.flags, letter.command.acceleration, letter.command.force) == ("mission", 32, (0.4, 0.0), (2.0,))
    link.stop()
    link.command(32, (2.0, 0.0))
    assert inbox.take().is_stop


def test_a_refusal_is_on_the_ticket(make_rig: Any) -> None:
    rig = make_rig()
    rig.context.inboxes["motion"].is_owner = lambda source: False
    assert link_of(rig).command(0).refused == "wrong-state"


def test_a_tick_sees_one_moment(make_rig: Any) -> None:
    rig = make_rig()
    link = link_of(rig)
    rig.put("ATRV2/Battery", BatteryState(1.0, 25.0), 1.0)
    assert link.newest("ATRV2/Battery") is None and link.is_stale("ATRV2/Battery")
    link.refresh(2.0)
    assert link.newest("ATRV2/Battery") == BatteryState(1.0, 25.0)
    assert link.age_s("ATRV2/Battery") == 1.0 and not link.is_stale("ATRV2/Battery")
    rig.put("ATRV2/Battery", BatteryState(2.0, 24.0), 2.0)
    assert link.newest("ATRV2/Battery") == BatteryState(1.0, 25.0)
    link.refresh(9.0)
    assert link.is_stale("ATRV2/Battery")


def test_wrist_and_words(make_rig: Any) -> None:
    rig = make_rig()
    link = link_of(rig)
    link.point_wrist(0.5, -0.1, 0.3, 1.0)
    command = rig.context.inboxes["wrist"].take().command
    assert (command.position, command.velocity, command.acceleration) == ((0.5, -0.1), (0.3, 0.3), (1.0, 1.0))
    link.say("hello")
    assert rig.events == [("info", "say", "mission", "hello")]
