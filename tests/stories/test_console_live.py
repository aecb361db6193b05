"""Stories of a person at a browser: a robot that drives, and a recording of one that drove."""

from __future__ import annotations

import math
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import pytest

from pluto_bt.files import package_root
from pluto_bt.scenario import Play
from tests.gateway.browsers import Screen, chromium

RUN = ["run", "patrol.xml", "--port", "goals=8,3;13.5,3;10.5,8;2,3.5", "--port", "rounds=50", "--realtime", "--speed", "3",
       "--gateway", "127.0.0.1:0", "--web", "127.0.0.1:0"]  # fmt: skip


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as one:
        yield one


@contextmanager
def console_of(browser: Any, *words: str) -> Iterator[Screen]:
    """The page of a `pluto` that runs in a process of its own and tells its address."""
    process = subprocess.Popen([sys.executable, "-m", "pluto_bt", *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        assert process.stdout is not None
        screen = Screen(browser, _url(process.stdout))
        yield screen
        screen.close()
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
    assert process.returncode == (130 if words[0] == "run" else 0)


def _url(stream: IO[str]) -> str:
    for line in stream:
        found = re.search(r"http://127\.0\.0\.1:\d+/", line)
        if found:
            return found[0]
    raise AssertionError("it ended without an address")


def pose(screen: Screen) -> tuple[float, float]:
    return float(screen.text("#pose-x")), float(screen.text("#pose-y"))


def test_a_robot_is_watched_stopped_sent_elsewhere_and_let_go_on(browser: Any) -> None:
    with console_of(browser, *RUN) as screen:
        screen.waits_for("#mission-chip", "running")
        screen.page.wait_for_function("() => parseFloat(document.querySelector('#pose-x').textContent) > 4.0")
        screen.waits_for("#tree", "go", "m to go")
        screen.waits_for("#verdict", "Moving")
        delays_ms = []
        for _ in range(3):
            screen.page.wait_for_function("() => parseFloat(document.querySelector('#speed').textContent) > 0.2")
            screen.click("#stop")
            screen.waits_for("#stop-note", "standing")
            delays_ms.append(int(screen.page.get_attribute("#stop", "data-zero-ms")))
            screen.waits_for("#mission-chip", "paused")
            screen.waits_for("#causes", "console stopped the robot")
            screen.click("#tab-mission")
            screen.click("[data-op=resume]")
            screen.waits_for("#mission-chip", "running")
        assert all(0 <= delay_ms < 10_000 for delay_ms in delays_ms), delays_ms
        x, y = pose(screen)
        goal = (x - 1.5, y) if x > 5.0 else (x + 1.5, y)
        screen.taps(*goal)
        screen.waits_for("#goal-note", "pauses the mission, takes the lease")
        screen.click("#goal-goto")
        screen.waits_for("#toast", "Go to", "succeeded")
        at = pose(screen)
        assert math.dist(at, goal) < 0.8, "0.3 m of tolerance, and the map moves under the finger while the robot drives"
        screen.click("[data-op=resume]")
        screen.waits_for("#mission-chip", "running")
        assert screen.complaints == []


def test_a_recording_is_looked_through_with_a_slider(browser: Any, scenario: Play, tmp_path: Path) -> None:
    yard = (package_root() / "sim" / "worlds" / "yard.xml").read_text(encoding="utf-8")
    fault = '<script><at t="7"><fault device="laser" kind="fatal" for="3"/></at></script></world>'
    (tmp_path / "yard.xml").write_text(yard.replace("</world>", fault), encoding="utf-8")
    run = scenario(str(tmp_path / "yard.xml"), mission="patrol.xml", ports={"goals": "5,3.5;2,3.5"}, record=tmp_path / "a.mcap")
    assert run.result == "SUCCESS"
    with console_of(browser, "replay", str(tmp_path / "a.mcap"), "--web", "127.0.0.1:0") as screen:
        screen.waits_for("#pose-x", "2.0")
        for selector in ("#stop", "#lease-take", "#tab-drive", "#tab-mission", "#goal-sheet"):
            assert screen.page.is_hidden(selector), f"{selector} commands, and nobody hears a command here"
        screen.waits_for("#clock", "0:00.0")
        for t_s in (6.0, 3.0):  # forward, and back
            screen.page.fill("#time", str(t_s))
            screen.waits_for("#clock", f"0:0{t_s:.1f}")
            believed = run.at(t_s).pose
            screen.page.wait_for_function("([x]) => Math.abs(parseFloat(document.querySelector('#pose-x').textContent) - x) < 0.2", arg=[believed[0]])
        screen.waits_for("#tree", "go", "running")
        screen.waits_for("#verdict", "Moving")
        lines = screen.page.evaluate("window.pluto.map.trail.points.map(([x, y, , isNew]) => isNew)")
        assert len(lines) > 2 and not any(lines[1:]), "the way so far is one line"
        screen.page.locator("#map").focus()
        screen.page.keyboard.press("ArrowRight")
        screen.waits_for("#clock", "0:03.1")
        screen.page.keyboard.press("Space")
        screen.page.wait_for_function("() => document.querySelector('#time').value > 3.5")
        went_wrong = [event for event in run.events if event.level != "info"]
        assert screen.page.locator("#marks button").count() == len(went_wrong) > 0
        screen.click("#marks button:first-child")
        screen.waits_for("#causes", "fatal error")
        screen.page.keyboard.press("End")
        screen.waits_for("#mission-chip", "succeeded")
        assert "old" in screen.text("#speed") or screen.text("#speed").startswith("0.00"), "a thinned speed is not that of the end"
        screen.click("#tab-events")
        screen.waits_for("#events", "gyro bias")
        assert screen.complaints == []
