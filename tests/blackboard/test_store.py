"""The blackboard: one writer, sequence numbers, snapshots that do not change, histories, wake-ups, inboxes."""

from __future__ import annotations

import math
import threading
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.blackboard import TOPICS, Blackboard, Inbox, Sample, TopicError
from pluto_bt.blackboard.codes import Avoidance, CommandType, LinkStatus, code_name, split_flags, status_name
from pluto_bt.blackboard.inbox import Letter
from pluto_bt.blackboard.messages import ActuatorState, BatteryState, LaserScan, Pose, read_only
from pluto_bt.blackboard.poses import pose_at


def pose(t_s: float, x: float = 0.0, theta: float = 0.0) -> Pose:
    return Pose(t_s, (x, 0.0, 0.0, theta, 0.0, 0.0))


def test_a_topic_has_one_type_one_writer_and_counts_its_values() -> None:
    board = Blackboard()
    battery = board.publisher("ATRV2/Battery", "base")
    assert board.newest("ATRV2/Battery") is None
    for volts in (25.0, 24.0):
        battery.put(BatteryState(1.0, volts), 1.5)
    assert board.newest("ATRV2/Battery") == Sample(BatteryState(1.0, 24.0), 2, 1.5)
    with pytest.raises(TopicError, match="is written by base, not by sick"):
        board.publisher("ATRV2/Battery", "sick")
    with pytest.raises(TopicError, match="base has the right to write ATRV2/Battery already"):
        board.publisher("ATRV2/Battery", "base")
    with pytest.raises(TopicError, match="carries BatteryState, not ActuatorState"):
        battery.put(ActuatorState(0.0), 0.0)
    with pytest.raises(TopicError, match=r'did you mean "ATRV2/Battery"\?'):
        board.newest("ATRV2/Batery")


def test_a_snapshot_keeps_what_was_newest_when_it_was_taken() -> None:
    board = Blackboard()
    battery = board.publisher("ATRV2/Battery", "base")
    battery.put(BatteryState(1.0, 25.0), 1.0)
    view = board.snapshot(2.0)
    battery.put(BatteryState(2.0, 20.0), 2.0)
    sample = view.newest("ATRV2/Battery")
    assert sample is not None and sample.value == BatteryState(1.0, 25.0) and sample.seq == 1
    assert view.age_s("ATRV2/Battery") == 1.0
    assert view.age_s("gps/state") == math.inf


def test_age_counts_from_the_stamp_and_stale_after_comes_from_the_table() -> None:
    board = Blackboard()
    board.publisher("ATRV2/Battery", "base").put(BatteryState(1.0, 25.0), 3.0)
    assert not board.is_stale("ATRV2/Battery", 6.0)
    assert board.is_stale("ATRV2/Battery", 6.1)
    assert board.is_stale("gps/state", 0.0), "what was never written is stale"
    assert not board.snapshot(6.0).is_stale("ATRV2/Battery") and board.snapshot(6.1).is_stale("ATRV2/Battery")


def test_a_watcher_is_woken_by_each_write_of_its_topic_only() -> None:
    board = Blackboard()
    woken: list[str] = []
    board.on_change("ATRV2/Battery", lambda: woken.append("battery"))
    board.publisher("car/speed", "speed")
    battery = board.publisher("ATRV2/Battery", "base")
    battery.put(BatteryState(0.0), 0.0)
    battery.put(BatteryState(0.0), 0.0)
    assert woken == ["battery", "battery"], "an equal value is a change too: the sequence number moved"


def test_histories_are_as_long_as_the_table_says() -> None:
    board = Blackboard()
    topic = board.topic("Localization/Dead-Reckoning")
    publisher = board.publisher(topic.name, "local")
    for i in range(topic.history + 10):
        publisher.put(pose(float(i)), float(i))
    kept = board.history(topic.name)
    assert len(kept) == topic.history and kept[-1].value.stamp_s == topic.history + 9


@given(st.floats(0.0, 1.0), st.floats(-10, 10), st.floats(-math.pi, math.pi), st.floats(-3.0, 3.0))
def test_a_pose_between_two_stamps_is_interpolated_along_the_shorter_arc(share: float, x: float, theta: float, turn: float) -> None:
    board = Blackboard()
    publisher = board.publisher("Localization/Dead-Reckoning", "local")
    publisher.put(pose(1.0, x, theta), 1.0)
    publisher.put(pose(2.0, x + 2.0, math.remainder(theta + turn, math.tau)), 2.0)
    found = pose_at(board, "Localization/Dead-Reckoning", 1.0 + share)
    assert found is not None
    assert found.pose[0] == pytest.approx(x + 2.0 * share, abs=1e-9)
    assert math.remainder(found.pose[3] - (theta + share * turn), math.tau) == pytest.approx(0.0, abs=1e-9)


def test_a_pose_outside_the_history_is_not_invented() -> None:
    board = Blackboard()
    publisher = board.publisher("Localization/Dead-Reckoning", "local")
    assert pose_at(board, "Localization/Dead-Reckoning", 1.0) is None
    publisher.put(pose(1.0), 1.0)
    publisher.put(pose(2.0), 2.0)
    assert pose_at(board, "Localization/Dead-Reckoning", 0.9) is None
    assert pose_at(board, "Localization/Dead-Reckoning", 2.1) is None


def test_arrays_on_the_blackboard_cannot_be_changed() -> None:
    scan = LaserScan(0.0, -1.0, 0.5, read_only([1.0, 2.0, 3.0]), 3)
    with pytest.raises(ValueError, match="read-only"):
        scan.ranges_m[0] = 9.0
    assert scan == LaserScan(0.0, -1.0, 0.5, read_only([1.0, 2.0, 3.0]), 3)


def test_many_threads_write_and_every_write_counts() -> None:
    board = Blackboard()
    battery = board.publisher("ATRV2/Battery", "base")
    threads = [threading.Thread(target=lambda: [battery.put(BatteryState(0.0), 0.0) for _ in range(500)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    sample = board.newest("ATRV2/Battery")
    assert sample is not None and sample.seq == 2000


class TestInbox:
    def test_the_newest_command_wins_and_is_taken_once(self) -> None:
        inbox = Inbox("drive")
        for flags in (0, 1):
            assert inbox.post("avoid", ActuatorState(0.0, flags)) == ""
        letter = inbox.take()
        assert letter is not None and letter.command.flags == 1
        assert inbox.take() is None

    def test_a_stop_is_not_overtaken_by_a_command_that_comes_before_it_is_taken(self) -> None:
        inbox = Inbox("drive")
        inbox.post("avoid", ActuatorState(0.0, 1))
        inbox.stop("operator", 2.0)
        inbox.post("avoid", ActuatorState(0.0, 1))
        letter = inbox.take()
        assert letter is not None and letter.is_stop and letter.command == ActuatorState(2.0)

    def test_only_the_owner_may_command_but_everybody_may_stop(self) -> None:
        inbox = Inbox("drive", lambda source: source == "avoid")
        assert inbox.post("shell", ActuatorState(0.0)) == "wrong-state"
        assert inbox.take() is None
        inbox.stop("shell", 0.0)
        letter = inbox.take()
        assert letter is not None and letter.is_stop

    def test_who_asks_while_the_latch_closes_does_not_get_in_behind_the_stop(self) -> None:
        """The command is let in, then the stop comes and is taken: nothing may be left for the link."""
        taken: list[Letter | None] = []

        def stop_and_take() -> None:
            inbox.stop("operator", 1.0)
            taken.append(inbox.take())

        operator = threading.Thread(target=stop_and_take)

        def is_owner(source: str) -> bool:
            operator.start()
            operator.join(0.05)  # as long as it likes, if nothing holds it up
            return True

        inbox = Inbox("drive", is_owner)
        inbox.post("avoid", ActuatorState(0.0, 1))
        operator.join()
        assert taken[0] is not None and taken[0].is_stop and inbox.take() is None

    @pytest.mark.parametrize(
        ("fields", "plain"),
        [
            ({"position": [3, 4], "velocity": (1, 0), "force": [2]}, ActuatorState(0.0, 32, (3.0, 4.0), (1.0, 0.0), (0.0, 0.0), (2.0,))),
            ({"flags": np.int64(32), "position": np.array([3.0, 4.0])}, ActuatorState(0.0, 32, (3.0, 4.0))),
            ({"flags": 32.0, "acceleration": (), "force": ()}, ActuatorState(0.0, 32)),
        ],
    )
    def test_lists_arrays_and_whole_floats_are_taken_for_what_they_say(self, fields: Any, plain: ActuatorState) -> None:
        inbox = Inbox("motion")
        inbox.post("operator", ActuatorState(**({"stamp_s": 0, "flags": 32} | fields)))
        letter = inbox.take()
        assert letter is not None and letter.command == plain
        assert type(letter.command.flags) is int and {type(x) for x in (*letter.command.position, *letter.command.velocity)} == {float}

    @pytest.mark.parametrize(
        ("fields", "flags"),
        [
            ({"position": (3.0,)}, 42), ({"position": ()}, 42), ({"position": None}, 42), ({"velocity": (1.0, 2.0, 3.0)}, 42),
            ({"velocity": ("1", "0")}, 42), ({"velocity": "10"}, 42), ({"velocity": (0.3, None)}, 42), ({"velocity": (10**400, 0)}, 42),
            ({"force": 1.0}, 42), ({"stamp_s": None}, 42), ({"flags": 0.5}, 0), ({"flags": math.nan}, 0), ({"flags": "42"}, 0),
        ],
    )  # fmt: skip
    def test_what_has_not_the_shape_of_a_command_has_no_number_that_a_link_would_take(self, fields: Any, flags: int) -> None:
        inbox = Inbox("motion")
        inbox.post("operator", ActuatorState(**({"stamp_s": 0.0, "flags": 42} | fields)))
        letter = inbox.take()
        assert letter is not None and letter.command.flags == flags
        assert all(map(math.isnan, (*letter.command.position, *letter.command.velocity)))

    def test_what_is_no_command_at_all_is_an_error_of_the_sender(self) -> None:
        with pytest.raises(TypeError, match="expected an ActuatorState, found str"):
            Inbox("motion").post("operator", "go")  # type: ignore[arg-type]

    def test_a_plain_command_travels_as_the_object_it_is(self) -> None:
        inbox, command = Inbox("motion"), ActuatorState(0.0, 32, (3.0, 4.0))
        inbox.post("operator", command)
        letter = inbox.take()
        assert letter is not None and letter.command is command


class TestTables:
    def test_names_are_unique_and_each_row_says_what_it_carries(self) -> None:
        names = [topic.name for topic in TOPICS]
        assert len(set(names)) == len(names)
        assert all(topic.doc and topic.period_s >= 0 and topic.stale_after_s >= 0 and topic.history >= 1 for topic in TOPICS)

    def test_each_writer_is_a_module_and_each_module_of_the_table_exists(self) -> None:
        from pluto_bt.blackboard.topics import LATER_WRITERS
        from pluto_bt.system import MODULES

        modules = {module.name for module in MODULES} | {"gateway", *LATER_WRITERS}
        assert {topic.name: topic.writer for topic in TOPICS if topic.writer not in modules} == {}

    @pytest.mark.parametrize(
        ("flags", "expected"),
        [(0, (0, 0)), (1, (0, 1)), (2, (0, 2)), (3, (0, 3)), (10, (1, 0)), (21, (2, 1)), (32, (3, 2)), (33, (3, 3)),
         (-1, None), (-2, None), (4, None), (9, None), (14, None), (34, None), (40, None), (42, None), (50, None)],
    )  # fmt: skip
    def test_flags_are_taken_apart_as_the_manual_says(self, flags: int, expected: tuple[int, int] | None) -> None:
        assert split_flags(flags) == (None if expected is None else (Avoidance(expected[0]), CommandType(expected[1])))

    def test_codes_have_the_names_of_the_wire(self) -> None:
        assert code_name(LinkStatus.LASER_SLOW_STOP) == "laser-slow-stop"
        assert status_name(3, 11) == "approaching-object"
        assert status_name(0, 99) == "99"
