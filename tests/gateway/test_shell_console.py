"""The conversation at a terminal: keys in, screen out, over a robot in memory."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import signal
from collections.abc import Callable

import pytest

pytest.importorskip("prompt_toolkit")

from prompt_toolkit.application.current import create_app_session
from prompt_toolkit.data_structures import Size
from prompt_toolkit.history import InMemoryHistory
from prompt_toolkit.input import PipeInput, create_pipe_input
from prompt_toolkit.output.vt100 import Vt100_Output

from pluto_bt.blackboard import messages as m
from pluto_bt.gateway.port import RunState
from pluto_bt.gateway.shell.console import Console
from pluto_bt.gateway.shell.live import Live
from pluto_bt.gateway.shell.robot import Robot

from .conftest import Running

PATIENCE_S = 60.0


class Screen:
    """What the terminal was sent, and a way to wait for it."""

    encoding = "utf-8"

    console: Console

    def __init__(self) -> None:
        self.text = ""

    def write(self, text: str) -> int:
        self.text += text
        return len(text)

    def flush(self) -> None:
        pass

    def isatty(self) -> bool:
        return True

    async def shows(self, *words: str) -> None:
        """Wait until all words have come, each written as one piece, after the last call."""
        await until(lambda: all(word in plain(self.text) for word in words), lambda: f"{words} not in {plain(self.text)!r}")
        self.text = ""


def plain(text: str) -> str:
    return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text)


async def until(holds: Callable[[], object], told: Callable[[], str] = lambda: "", every_s: float = 0.01) -> None:
    try:
        async with asyncio.timeout(PATIENCE_S):
            while not holds():
                await asyncio.sleep(every_s)
    except TimeoutError:
        raise AssertionError(told()) from None


def talk(running: Running, story: Callable[[PipeInput, Screen], object]) -> None:
    """Play a story at a terminal of its own."""

    async def play() -> None:
        screen = Screen()
        with create_pipe_input() as keys, create_app_session(keys, Vt100_Output(screen, lambda: Size(24, 110), term="xterm", enable_cpr=False)):  # type: ignore[arg-type]
            console = screen.console = Console(Robot(running.address), InMemoryHistory(), may_read_files=False, has_signals=False)
            talking = asyncio.create_task(console.talk())
            try:
                await story(keys, screen)  # type: ignore[misc]
                keys.send_text("\x15\x04\x04")
                assert await asyncio.wait_for(talking, PATIENCE_S) == 0
            finally:
                talking.cancel()
                with contextlib.suppress(asyncio.CancelledError, Exception):
                    await talking

    asyncio.run(play())


@pytest.fixture
def running(lasting: Running) -> Running:
    """Its drive says every step what it does, as a real one."""
    robot = lasting.renew()

    def drive() -> None:
        velocity = next((did[3] for did in reversed(robot.did) if did[0] == "command"), (0.0, 0.0))
        robot.write("drive/status", m.FVectorState(robot.time_s, velocity, (0,)))

    lasting.on_step = drive
    return lasting


def test_commands_and_events_stand_above_the_prompt(running: Running) -> None:
    async def story(keys: PipeInput, screen: Screen) -> None:
        await screen.shows("Ctrl-C stops the robot", "pluto>")
        await until(lambda: bool(screen.console._live.names))  # asked for after the events: it listens
        running.robot.says("mind \x1b[2J the step")
        await screen.shows("test: mind ")
        keys.send_text("status\r")
        await screen.shows("nobody drives")
        keys.send_text("wrist\rstatus\rhelp\r")  # what is typed ahead of a command's end is not lost
        await screen.shows("wrist>", "nobody drives", "point PAN TILT")

    talk(running, story)
    assert running.robot.did == []


def test_the_bottom_line_is_honest(running: Running) -> None:
    """Pose, speed, mission and leaf; unknown where nobody said so, old where it is old, no link where there is none."""
    events: list[str] = []

    async def watch() -> None:
        live = Live(Robot(running.address), lambda line, level: events.append(line))
        assert "NO LINK" in live.line()
        await until(lambda: "m/s" in live.line(), live.line)
        assert "pose unknown" in live.line() and "no mission" in live.line()
        running.robot.write("Localization/Pose", m.Pose(running.robot.time_s, (1.0, -2.5, 0.0, 0.0, 0.0, 0.0)))
        running.robot.write("mission/state", m.MissionState(0.0, "patrol", 1, "paused", "stopped", "go"))
        await until(lambda: "x 1.00 m  y -2.50 m  0°  |" in live.line() and "patrol: paused (stopped) at go" in live.line(), live.line)
        await until(lambda: re.search(r"0°  \d+ s OLD", live.line()) and "m/s  0 °/s  |" in live.line(), live.line)
        assert "patrol.xml" not in live.names.get("mission", ()) and "trip2" in live.names["mission"] and "drive/status" in live.names["topic"]
        pid = running.link.pid
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
        await until(lambda: "NO LINK to 127.0.0.1" in live.line() or bool(events), live.line)
        await until(lambda: "NO LINK" not in live.line() and "m/s" in live.line(), live.line)
        assert any("connection lost" in event for event in events)
        await live.close()

    asyncio.run(watch())


def test_ctrl_c_stops_the_robot_at_the_prompt_and_while_a_command_goes_on(running: Running) -> None:
    async def story(keys: PipeInput, screen: Screen) -> None:
        await screen.shows("pluto>")
        keys.send_text("goto 1")
        keys.send_text("\x03")
        await screen.shows("stopped")
        assert running.robot.did == [("stop", "shell")]
        keys.send_text("goto 3 4\r")
        await until(lambda: ("run", "GoTo", {"goal": "3;4"}, 0.0) in running.robot.did)
        keys.send_text("\x03")
        await until(lambda: running.robot.did.count(("stop", "shell")) >= 2)
        await screen.shows("stopped", "pluto>")
        keys.send_text("status\r")
        await screen.shows("nobody drives")

    talk(running, story)


def test_arrow_keys_drive_and_letting_go_is_zero_velocity(running: Running) -> None:
    def commands() -> list[tuple[object, ...]]:
        return [did[1:] for did in running.robot.did if did[0] == "command"]

    async def story(keys: PipeInput, screen: Screen) -> None:
        await screen.shows("pluto>")
        keys.send_text("drive 0.4\r")
        await screen.shows("arrows drive", "+0.00 m/s")  # the drive has spoken

        def hold() -> bool:
            """As the key repeats, until the limit is asked for."""
            keys.send_text("\x1b[A")
            return ("motion", 30, (0.4, 0.0)) in commands()

        await until(hold, lambda: str(commands()), every_s=0.05)
        await until(lambda: commands()[-1:] == [("motion", 30, (0.0, 0.0))], lambda: str(commands()))
        keys.send_text("\x1b[D")
        await until(lambda: any(did[2][1] > 0.0 for did in commands()))  # type: ignore[index]
        keys.send_text(" ")
        await until(lambda: commands()[-1] == ("motion", 30, (0.0, 0.0)))
        count = len(commands())
        keys.send_text("q")
        await screen.shows("pluto>")
        assert len(commands()) <= count + 1
        keys.send_text("status\r")
        await screen.shows("nobody drives")

    talk(running, story)
    speeds = [did[3][0] for did in running.robot.did if did[0] == "command"]  # type: ignore[index]
    assert speeds[0] == pytest.approx(0.15) and max(speeds) == 0.4, "a little more than what is in force, up to the limit"


def test_run_is_left_to_itself_by_ctrl_d(running: Running) -> None:
    running.robot.runs["x"] = RunState()
    running.robot.mission = lambda *order: running.robot.did.append(order)  # type: ignore[method-assign, func-returns-value]

    async def story(keys: PipeInput, screen: Screen) -> None:
        await screen.shows("pluto>")
        keys.send_text("run trip2\r")
        await until(lambda: any(did[0] == "start" for did in running.robot.did))
        running.robot.write("mission/state", m.MissionState(0.0, "trip2", 1, "running", "", "go"))
        await screen.shows("running")
        keys.send_text("\x04")
        await screen.shows("a mission goes on by itself", "pluto>")

    talk(running, story)
    assert not [did for did in running.robot.did if did[0] in ("stop", "abort")]
