"""The schedulers and supervision: order, exact due times, wake-ups, back-off, critical parts, hung parts."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.blackboard.inbox import Inbox
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.runtime.clock import NS, MonotonicClock, VirtualClock
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.table import Module, in_start_order
from pluto_bt.runtime.threads import Threads
from pluto_bt.runtime.trace import Trace
from pluto_bt.runtime.watchdog import Hung, Watchdog
from pluto_bt.source import PlutoError


class Recorder:
    """A component that writes down when it was stepped, and does what the test asks."""

    def __init__(self, name: str, log: list[tuple[str, float]], act: Callable[[float], None] = lambda now_s: None) -> None:
        self.name, self.log, self.act = name, log, act

    def start(self, now_s: float) -> None:
        self.log.append((f"{self.name} starts", now_s))

    def step(self, now_s: float) -> None:
        self.log.append((self.name, now_s))
        self.act(now_s)

    def stop(self) -> None:
        self.log.append((f"{self.name} stops", -1.0))


class Told:
    """A listener that remembers what it was told."""

    def __init__(self) -> None:
        self.failed: list[tuple[str, bool]] = []
        self.restarted: list[str] = []

    def part_failed(self, part: Part, error: BaseException, is_final: bool) -> None:
        self.failed.append((part.module.name, is_final))

    def part_restarted(self, part: Part) -> None:
        self.restarted.append(part.module.name)


def row(name: str, period_s: float, *, critical: bool = False, group: str = "chain") -> Module:
    return Module(name, "x:Y", period_s, group, critical=critical)


def lockstep(*parts: tuple[Module, Recorder], told: Told | None = None) -> tuple[Lockstep, VirtualClock]:
    clock = VirtualClock()
    made = [Part(module, component, number, told or Told()) for number, (module, component) in enumerate(parts)]
    for part in made:
        part.start(0)
    scheduler = Lockstep(made, clock)
    scheduler.start()
    return scheduler, clock


def test_equal_due_times_run_in_table_order() -> None:
    log: list[tuple[str, float]] = []
    scheduler, _ = lockstep((row("slow", 0.1), Recorder("slow", log)), (row("fast", 0.05), Recorder("fast", log)))
    log.clear()
    scheduler.run_until(NS // 10)
    assert log == [("slow", 0.0), ("fast", 0.0), ("fast", 0.05), ("slow", 0.1), ("fast", 0.1)]


@given(st.integers(1, 400), st.integers(1, 3000))
def test_due_times_are_exact_multiples_of_the_period(period_ms: int, steps: int) -> None:
    log: list[tuple[str, float]] = []
    scheduler, clock = lockstep((row("a", period_ms / 1000), Recorder("a", log)))
    log.clear()
    scheduler.run_until(steps * period_ms * 1_000_000)
    assert len(log) == steps + 1
    assert clock.now_ns() == steps * period_ms * 1_000_000, "nothing drifts"


def test_a_woken_part_runs_at_once_in_table_order_and_once() -> None:
    log: list[tuple[str, float]] = []
    wakers: list[Callable[[], None]] = []

    def wake_both(now_s: float) -> None:
        for wake in wakers * 2:
            wake()

    scheduler, _ = lockstep(
        (row("up", 0.0), Recorder("up", log)), (row("waker", 0.1), Recorder("waker", log, wake_both)), (row("down", 0.0), Recorder("down", log))
    )
    wakers += [scheduler.waker(2), scheduler.waker(0)]
    log.clear()
    scheduler.run_until(0)
    assert log == [("waker", 0.0), ("up", 0.0), ("down", 0.0)]


def test_two_parts_that_wake_each_other_do_not_hold_the_clock() -> None:
    log: list[tuple[str, float]] = []
    wakers: dict[str, Callable[[], None]] = {}
    scheduler, clock = lockstep(
        (row("a", 0.1), Recorder("a", log, lambda now_s: wakers["b"]())), (row("b", 0.0), Recorder("b", log, lambda now_s: wakers["a"]()))
    )
    wakers.update(a=scheduler.waker(0), b=scheduler.waker(1))
    scheduler.run_until(NS)
    assert clock.now_ns() == NS


def test_a_stop_is_not_held_up_by_parts_that_wake_each_other() -> None:
    log: list[tuple[str, float]] = []
    wakers: dict[str, Callable[[], None]] = {}
    inbox = Inbox("c")
    turns = iter(range(1000))

    def order(now_s: float) -> None:
        wakers["b"]()
        turn = next(turns)
        if turn == 9:  # by then the wakes of this moment are used up
            inbox.post("a", ActuatorState(now_s))
            inbox.stop("a", now_s)

    answering = Recorder("b", log, lambda now_s: wakers["a"]())
    scheduler, _ = lockstep((row("a", 0.1), Recorder("a", log, order)), (row("b", 0.0), answering), (row("c", 0.0), Recorder("c", log)))
    log.clear()
    wakers.update(a=scheduler.waker(0), b=scheduler.waker(1))
    inbox.on_post(scheduler.waker(2), scheduler.waker(2, for_stop=True))
    scheduler.run_until(NS)
    stopped_s = [t for name, t in log if name == "a"][10]
    assert [t for name, t in log if name == "c"] == [stopped_s], "the command is left for the next period, the stop is not"


def test_keep_going_is_asked_before_the_clock_moves() -> None:
    log: list[tuple[str, float]] = []
    scheduler, clock = lockstep((row("a", 0.1), Recorder("a", log)), (row("b", 0.1), Recorder("b", log)))
    log.clear()
    scheduler.run_until(NS, lambda: len(log) < 3)
    assert log == [("a", 0.0), ("b", 0.0), ("a", 0.1), ("b", 0.1)], "all parts of one time run"
    assert clock.now_s() == 0.1


class TestSupervision:
    def test_a_part_that_raises_is_restarted_with_growing_back_off(self) -> None:
        log: list[tuple[str, float]] = []
        told = Told()

        def fail_at_first(now_s: float) -> None:
            if now_s < 0.5:
                raise ValueError("boom")

        scheduler, _ = lockstep((row("a", 0.05), Recorder("a", log, fail_at_first)), told=told)
        log.clear()
        scheduler.run_until(NS)
        steps = [round(t, 2) for name, t in log if name == "a"]
        assert steps[:4] == [0.0, 0.1, 0.3, 0.7], "0.1, 0.2, 0.4 s of back-off, then it works"
        assert told.failed == [("a", False)] * 3 and told.restarted == ["a"] * 3
        part = scheduler.parts[0]
        assert part.failures == 3 and part.error == "ValueError: boom" and part.state == "running"

    def test_a_critical_part_gives_up_after_three_restarts(self) -> None:
        told = Told()

        def fail(now_s: float) -> None:
            raise ValueError("boom")

        scheduler, _ = lockstep((row("a", 0.05, critical=True), Recorder("a", [], fail)), told=told)
        scheduler.run_until(3 * NS)
        assert told.failed == [("a", False), ("a", False), ("a", False), ("a", True)]
        assert scheduler.parts[0].state == "failed"

    def test_other_parts_go_on(self) -> None:
        log: list[tuple[str, float]] = []

        def fail(now_s: float) -> None:
            raise ValueError("boom")

        scheduler, _ = lockstep((row("bad", 0.1), Recorder("bad", [], fail)), (row("good", 0.1), Recorder("good", log)))
        log.clear()
        scheduler.run_until(NS)
        assert len(log) == 11

    def test_an_ordered_stop_and_start_happen_in_the_parts_own_turn(self) -> None:
        log: list[tuple[str, float]] = []
        scheduler, _ = lockstep((row("a", 0.1), Recorder("a", log)))
        part = scheduler.parts[0]
        part.order(False)
        assert part.is_running
        scheduler.run_until(0)
        assert part.state == "stopped" and log[-1] == ("a stops", -1.0)
        part.order(True)
        part.order(True)
        scheduler.run_until(NS // 10)
        assert part.state == "running" and [name for name, _ in log].count("a starts") == 2

    def test_a_part_that_cannot_obey_is_told_and_the_others_go_on(self) -> None:
        log: list[tuple[str, float]] = []
        told = Told()
        bad = Recorder("bad", [])
        scheduler, _ = lockstep((row("bad", 0.1), bad), (row("good", 0.1), Recorder("good", log)), told=told)
        part = scheduler.parts[0]

        def refuse(now_s: float = 0.0) -> None:
            raise OSError("the port is taken")

        bad.stop = refuse  # type: ignore[method-assign]
        part.order(False)
        scheduler.run_until(NS // 10)
        assert told.failed == [("bad", False)] and part.state == "stopped"
        own_start, bad.start = bad.start, refuse  # type: ignore[method-assign]
        part.order(True)
        scheduler.run_until(NS)
        assert len(told.failed) == 2 and part.state == "stopped" and part.error == "OSError: the port is taken"
        assert [name for name, _ in log].count("good") == 11
        bad.start = own_start  # type: ignore[method-assign]
        part.order(True)
        scheduler.run_until(2 * NS)
        assert part.state == "running" and part.error == "" and not told.restarted

    def test_a_slow_part_is_not_started_again_when_it_is_quick_again(self) -> None:
        log: list[tuple[str, float]] = []
        told = Told()
        scheduler, _ = lockstep((row("a", 0.1), Recorder("a", log)), told=told)
        part = scheduler.parts[0]
        part.slow_ns = NS // 2
        scheduler.run_until(NS)
        part.slow_ns = 0
        assert part.state == "running"
        scheduler.run_until(2 * NS)
        assert not told.restarted and [name for name, _ in log].count("a starts") == 1

    def test_a_hung_thread_is_named_by_the_watchdog(self) -> None:
        turns = 0
        with pytest.raises(Hung), Watchdog(lambda: turns, 0.2):
            while True:
                try:
                    threading.Event().wait(60.0)
                except Exception:  # what a careless leaf does; the watchdog gets through all the same
                    continue


def test_threads_run_the_same_table() -> None:
    log: list[tuple[str, float]] = []
    enough = threading.Event()

    def count(now_s: float) -> None:
        if len(log) > 20:
            enough.set()

    clock = MonotonicClock()
    parts = [Part(row("a", 0.01), Recorder("a", log, count), 0, Told()), Part(row("b", 0.0, group="io"), Recorder("b", log), 1, Told())]
    for part in parts:
        part.start(0)
    scheduler = Threads(parts, clock)
    scheduler.start()
    scheduler.waker(1)()
    assert enough.wait(10.0)
    scheduler.stop()
    assert ("b", pytest.approx(0.0, abs=5.0)) in log


def test_start_order_follows_needs_and_circles_are_named() -> None:
    a, b, c = (Module(name, "x:Y", 0.1, "io", needs=needs) for name, needs in (("a", ("c",)), ("b", ()), ("c", ("b", "gone"))))
    assert [module.name for module in in_start_order([a, b, c])] == ["b", "c", "a"]
    with pytest.raises(PlutoError, match="a -> d -> a"):
        in_start_order([Module("a", "x:Y", 0.1, "io", needs=("d",)), Module("d", "x:Y", 0.1, "io", needs=("a",))])


class TestClock:
    def test_timers_fire_inside_advance_in_order_of_time_then_of_creation(self) -> None:
        clock = VirtualClock()
        fired: list[tuple[str, float]] = []
        for name, at_s in (("late", 2.0), ("first", 1.0), ("second", 1.0)):
            clock.call_at(at_s, lambda name=name: fired.append((name, clock.now_s())))  # type: ignore[misc]
        clock.call_at(1.5, lambda: fired.append(("never", 0.0))).cancel()
        clock.advance(3.0)
        assert fired == [("first", 1.0), ("second", 1.0), ("late", 2.0)] and clock.now_s() == 3.0

    def test_time_does_not_run_backwards(self) -> None:
        with pytest.raises(ValueError, match="backwards"):
            VirtualClock().advance(-1.0)


def test_the_hash_of_a_trace_depends_on_every_line() -> None:
    hashes = []
    for last in (1.0, 1.0, 1.0000000000000002):
        trace = Trace()
        trace.line({"t": 0, "tick": 1})
        trace.line({"t": 1, "x": last})
        hashes.append(trace.sha256())
    assert hashes[0] == hashes[1] != hashes[2]
