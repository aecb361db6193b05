"""Runs the real trees of a black box again on the inputs it recorded, tick by tick, and tells the first tick that differs.

What runs is what ran: the same executive, the same link to the robot, the same leaves. Only the blackboard is filled from the
recording, and what the trees command goes nowhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib import resources
from itertools import islice
from pathlib import Path
from typing import Any

import msgspec

from pluto_bt.behaviours.robot import Ticket
from pluto_bt.blackboard import TOPICS, Blackboard, Inbox
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.inputs.reading import Inputs, Request, read_inputs
from pluto_bt.modules.context import Context
from pluto_bt.modules.job_runner import JobRunner
from pluto_bt.modules.robot_link import RobotLink
from pluto_bt.modules.tick_log import BranchLog
from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.record.box import Box, open_box
from pluto_bt.record.differences import Difference, compared
from pluto_bt.record.entries import Posted, Tick
from pluto_bt.record.feed import Feed, PlaybackError
from pluto_bt.record.story import ended
from pluto_bt.runtime.clock import StepClock, VirtualClock
from pluto_bt.skills.jobs import Job
from pluto_bt.source import Faults, PlutoError
from pluto_bt.trees import Mission, load_mission, memory
from pluto_bt.trees.activity import Activity
from pluto_bt.trees.executive import Executive


class _Inbox(Inbox):
    """Takes commands and does nothing; refuses what was refused."""

    def __init__(self, name: str, playback: Playback) -> None:
        super().__init__(name)
        self._playback = playback

    def post(self, source: str, command: ActuatorState) -> str:
        return self._playback.refusal()


class Playback:
    """One repetition of a run.

    Attributes:
        ticks: how many ticks of the recording were executed again; a file that was cut short may end before its inputs do.
    """

    def __init__(self, box: Box, files: Path, nodes: Sequence[type] = (), mission: Path | None = None) -> None:
        """`files`: the folder of the run's unpacked files; `mission`: another mission to run instead of the recorded one.

        Raises: InputError for files that cannot be read any more; PlaybackError if the beginning of the run was dropped."""
        if not box.is_from_start:
            raise PlaybackError("the first ticks were dropped for want of room (record.limit_mb), so the run cannot be repeated")
        self._box = box
        self._main = mission or files / box.run.mission
        self.inputs = _inputs(box, files, self._main, nodes)
        self._nodes = tuple(nodes)
        self.ticks = 0
        self._clock: VirtualClock | StepClock = VirtualClock() if box.run.mode == "lockstep" else StepClock()
        self._board = Blackboard(TOPICS)
        self._topics = TopicGlobals(lambda: self._robot.snapshot)
        inboxes = {name: _Inbox(name, self) for name in ("motion", "job", "wrist", "arm", "alarms")}
        context = Context(
            board=self._board, clock=self._clock, platform=self.inputs.robot, inboxes=inboxes, devices={},
            map=self.inputs.map or self.inputs.world, say=lambda *words: None, is_running=lambda name: True,
        )  # fmt: skip
        self._jobs_box = context.jobs
        self._robot = RobotLink(context)
        self._robot.on_command = self._note
        self._core = Executive(self._robot, lambda *words: None)
        self._core.on_begin = self._began
        self._jobs = JobRunner(replace(context, board=Blackboard(TOPICS)), self._core, self._robot, self._load)
        self._logs: dict[int, BranchLog] = {}
        self._posted: list[Posted] = []
        self._expected: tuple[Posted, ...] = ()
        self._feed = Feed(box, self._board)
        self._started = 0

    def run(self) -> Iterator[Difference]:
        """Every difference, tick by tick; the first one is the one that counts."""
        for number in range(len(self._box)):
            tick = self._box.tick(number)
            if not tick.is_end:
                yield from self._step(tick)
            if self._feed.is_at_its_end:
                return
            self.ticks += 1

    def refusal(self) -> str:
        """What the robot answered to this command when it was recorded."""
        at = len(self._posted)
        return self._expected[at].refused if at < len(self._expected) else ""

    def _step(self, tick: Tick) -> Iterator[Difference]:
        now_s = tick.t_ns / 1e9
        self._posted, self._expected = [], tick.commands  # also what a timer does between two ticks
        if isinstance(self._clock, VirtualClock):
            self._clock.jump_to(tick.t_ns)
        else:
            self._clock.step_to(now_s)
        if not self._feed.up_to(tick):
            return
        for verb, run, text in tick.orders:
            self._order(verb, run, text)
        self._jobs.take_orders()
        ticked = self._core.step(now_s)
        self._jobs.tell(now_s)
        self._core.take_done()
        now = [self._logs[activity.number].branch(activity.mission.status_line()) for activity in ticked]
        yield from compared(tick, self._box.trees, now, self._posted)

    def _began(self, activity: Activity) -> None:
        self._logs[activity.number] = BranchLog(activity)

    # ---------------------------------------------------------------- orders

    def _order(self, verb: str, run: int, text: str) -> None:
        core = self._core
        if verb in ("start", "start-held"):
            core.start(self._mission(run), text)
        elif verb == "start-errand":
            core.start_errand(self._mission(run))
        elif verb == "end-errand" and core.errand is not None:
            core.end_errand(core.errand, text)
        elif verb == "pause":
            core.pause(text)
        elif verb == "resume":
            core.resume()
        elif verb == "abort" and text != "preempted":  # that one belongs to a start
            core.abort(text)
        elif verb == "job":
            self._jobs_box.put(msgspec.json.decode(text, type=Job | None))
        elif verb == "leaf-fault":
            self._leaf_fault(*text.split(" ", 1))

    def _leaf_fault(self, kind: str, name: str) -> None:
        def step() -> Any:
            raise PlutoError(f'the world script lets leaf "{name}" {"raise" if kind == "raise" else "return None"}')

        def change() -> None:
            for activity in (self._core.active, self._core.job):
                if activity is not None:
                    activity.mission.replace_step(name, step if kind else None)

        self._core.order(change)

    def _mission(self, run: int) -> Mission:
        """The mission, or the errand of that number; what came from a file comes from the files in the box."""
        tree = self._box.trees[run]
        self._started += 1
        if tree.text:
            mission = self._load(tree.text)
        elif self._started == 1:
            given: dict[str, Any] = {"tree": self._box.run.tree, "ports": self._box.run.ports}
            mission = self._load(self._main, **given)
            if self._box.run.resumed:
                memory.give_back(mission, self._box.run.resumed)
        else:
            shipped = resources.files("missions") / Path(tree.file).name  # the gateway starts shipped missions by name
            mission = self._load(str(shipped))
        mission.attach(self._robot)
        return mission

    def _load(self, text: str | Path, **more: Any) -> Mission:
        return load_mission(text, self._nodes, self._clock, topics=self._topics, **more)

    def _note(self, to: str, ticket: Ticket) -> None:
        command = ticket.command
        self._posted.append(Posted(to, command.flags, command.position, command.velocity, ticket.refused))


def _inputs(box: Box, files: Path, mission: Path, nodes: Sequence[type]) -> Inputs:
    """What the run was made of, read from the unpacked files."""
    run = box.run
    x_m, y_m, theta_rad = run.start
    request = Request(
        mission=str(mission), world=str(files / run.world), map=str(files / run.map) if run.map else None,
        start=f"{x_m!r},{y_m!r},{math.degrees(theta_rad)!r}", platform=str(files / "platform.toml"), tree=run.tree,
        port=[f"{name}={value}" for name, value in run.ports.items()], seed=str(run.seed), set=run.settings, plugin=run.plugins,
    )  # fmt: skip
    return read_inputs(request, files, nodes)


def differences(box: Box, nodes: Sequence[type] = (), mission: Path | None = None, most: int = 100) -> tuple[list[Difference], int]:
    """The first differences between a run and its repetition, and how many ticks were executed. Raises: InputError, PlaybackError."""
    with box.unpacked() as files:
        playback = Playback(box, files, nodes, mission)
        return list(islice(playback.run(), most)), playback.ticks


def replay_file(path: str | Path, nodes: Sequence[type] = (), mission: str | Path | None = None) -> list[Difference]:
    """The differences between the run in a black box and its repetition; none if all ticks are identical.

    Args:
        nodes: leaves of the user's own.
        mission: another mission file to run on the recorded inputs, such as the newer version of the one that was recorded.
    Raises: InputError for a file that is no black box; PlaybackError for one that does not hold all inputs.
    """
    return differences(_opened(path), nodes, None if mission is None else Path(mission))[0]


def story_of(path: str | Path) -> list[tuple[str, str]]:
    """The leaves of the mission that ended, in order: (path, status). Raises: InputError."""
    return [(one.path, one.status) for one in ended(_opened(path))]


def _opened(path: str | Path) -> Box:
    faults = Faults()
    box = open_box(Path(path), str(path), faults)
    faults.raise_errors()
    assert box is not None  # else there was a fault
    return box


__all__ = ["Difference", "Playback", "PlaybackError", "differences", "replay_file", "story_of"]
