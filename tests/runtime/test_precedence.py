"""What drives the robot goes before what merely computes, and hands that on to nobody."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

import pytest

from pluto_bt.runtime.clock import MonotonicClock
from pluto_bt.runtime.precedence import precedence, take_precedence
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.threads import Threads

from .test_lockstep import Recorder, Told, row

pytestmark = pytest.mark.skipif(not hasattr(os, "sched_setscheduler"), reason="this system has no scheduling policies")


def in_a_thread(ask: Callable[[], Any]) -> Any:
    """Its answer, given by a thread of its own: the one of the tests stays as it is."""
    answers: list[Any] = []
    thread = threading.Thread(target=lambda: answers.append(ask()))
    thread.start()
    thread.join()
    return answers[0]


def policy() -> int:
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK


@pytest.fixture
def permitted() -> None:
    if not in_a_thread(take_precedence):
        pytest.skip("this user may not schedule in real time (ulimit -r)")


@pytest.mark.usefixtures("permitted")
def test_the_threads_of_a_run_go_before_others_and_the_one_that_started_them_does_not() -> None:
    policies: list[int] = []
    stepped = threading.Event()

    def look(now_s: float) -> None:
        policies.append(policy())
        stepped.set()

    part = Part(row("a", 0.01), Recorder("a", [], look), 0, Told())
    part.start(0)
    scheduler = Threads([part], MonotonicClock())
    before = policy()
    scheduler.start()
    assert stepped.wait(10.0)
    scheduler.stop()
    assert policies[0] == os.SCHED_RR and policy() == before != os.SCHED_RR


@pytest.mark.usefixtures("permitted")
def test_a_process_that_such_a_thread_starts_is_an_ordinary_one() -> None:
    def start() -> str:
        assert take_precedence()
        return subprocess.run([sys.executable, "-c", "import os; print(os.sched_getscheduler(0))"], capture_output=True, text=True, check=True).stdout

    assert int(in_a_thread(start)) == os.SCHED_OTHER


@pytest.mark.usefixtures("permitted")
def test_precedence_for_a_while_ends_and_is_not_taken_unless_wanted() -> None:
    def look() -> tuple[int, int, int]:
        with precedence(wanted=False):
            unwanted = policy()
        with precedence():
            within = policy()
        return unwanted, within, policy()

    assert in_a_thread(look) == (os.SCHED_OTHER, os.SCHED_RR, os.SCHED_OTHER)


def test_who_may_not_runs_all_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*unused: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert not take_precedence()
    with precedence() as taken:
        assert not taken
