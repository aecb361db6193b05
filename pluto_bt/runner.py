"""From checked inputs to a result: makes the system, runs the mission, sums up. Used by `pluto run`, the pytest plugin and the benchmarks."""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from pluto_bt.behaviours.jobs import JobLeaf
from pluto_bt.behaviours.look_around import LookAround
from pluto_bt.behaviours.path_driver import PathDriver
from pluto_bt.behaviours.paths import FindPath
from pluto_bt.behaviours.plan_path import Planning
from pluto_bt.behaviours.sweep_wrist import SweepWrist
from pluto_bt.behaviours.wall_follow import WallFollow
from pluto_bt.blackboard.messages import Event, Pose
from pluto_bt.box_files import record_request
from pluto_bt.doors import CLOSED, Doors
from pluto_bt.inputs.reading import Inputs
from pluto_bt.loop import Loop, rehearse
from pluto_bt.maps.kernel import telling_of_compilation
from pluto_bt.modules.journal_keeper import JournalKeeper
from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.result import RunResult
from pluto_bt.resume import ResumeRequest, Resumption, decide
from pluto_bt.run_options import Options
from pluto_bt.runtime.clock import NS, MissionClock, MonotonicClock, StepClock, VirtualClock, calendar_ns
from pluto_bt.system import System
from pluto_bt.trees import Mission, load_mission
from pluto_bt.trees.activity import ABORTED, SUCCEEDED
from pluto_bt.trees.checks import load_checked
from pluto_bt.trees.journal import Journal

USES_THE_MAP = (LookAround, SweepWrist, FindPath, Planning, PathDriver)


class Runner:
    """One run. After `run`, `result`, `system` and `mission` can be looked at."""

    def __init__(self, inputs: Inputs, mission: Mission, clock: VirtualClock | MonotonicClock, options: Options) -> None:
        self.inputs = inputs
        self.mission = mission
        with_jobs = options.doors.take_orders or any(isinstance(tracked.node, (JobLeaf, *USES_THE_MAP)) for tracked in mission.nodes())
        with_walls = options.doors.take_orders or any(isinstance(tracked.node, WallFollow) for tracked in mission.nodes())
        quiet = replace(options, trace_path=None, doors=CLOSED, record=None, own_clock=None, on_event=lambda event: None)
        with telling_of_compilation(options.on_compiling):
            rehearse(System(quiet, VirtualClock()), with_jobs, with_walls)
        if isinstance(clock, MonotonicClock):
            clock.restart()
        self.system = System(options, clock)
        self.loop = Loop(self.system)
        self.result = RunResult(result="STOPPED")

    @contextmanager
    def interruptible(self) -> Iterator[None]:
        """While inside, Ctrl-C, SIGTERM and a closed terminal stop the robot and end the run."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        old = [signal.signal(number, lambda *unused: self.loop.interrupt()) for number in numbers]
        try:
            yield
        finally:
            for number, handler in zip(numbers, old, strict=True):
                signal.signal(number, handler)

    def run(self) -> RunResult:
        """Run to the end and sum up."""
        try:
            self.loop.run(self.mission)
            self.result = self._sum_up()
            self._end_journal()
        finally:
            if self.system.recorder is not None:
                self.system.recorder.finish(self.result.as_json())
        return self.result

    def keep_journal(self, resumption: Resumption) -> None:
        """Write a journal, and begin as was decided. Raises: OSError if it cannot be written."""
        system = self.system
        read = system.board.reader("Localization/Pose")

        def where() -> tuple[tuple[float, float, float] | None, tuple[float, float, float] | None]:
            sample = read()
            believed = sample.value.pose if sample is not None and isinstance(sample.value, Pose) else None
            return None if believed is None else (believed[0], believed[1], believed[3]), system.simulator.pose

        journal = Journal(resumption.path, resumption.past, waits=bool(resumption.held))
        system.executive.keeper = JournalKeeper(self.mission, journal, resumption.past, where)
        self.loop.held, self.loop.told = resumption.held, resumption.told

    def _end_journal(self) -> None:
        """A run that came to its end leaves nothing to resume; one that only waited for an operator leaves what it found."""
        keeper, activity = self.system.executive.keeper, self.system.executive.core.mission
        if keeper is not None and not (self.loop.held and (activity is None or activity.ticks == 0)):
            keeper.end()

    def _sum_up(self) -> RunResult:
        system, simulator = self.system, self.system.simulator
        result, reason, text = self._outcome()
        sample = system.board.newest("Localization/Pose")
        believed = sample.value if sample is not None and isinstance(sample.value, Pose) else None
        contacts = [_contact(contact, "collision") for contact in simulator.collisions]
        contacts += [_contact(contact, "hit-by") for contact in simulator.hit_by]
        clearance_m = simulator.min_clearance_m
        activity = system.executive.core.mission
        mission = self.mission if activity is None else activity.mission  # another one, if somebody has loaded that meanwhile
        name = self.inputs.mission_path.name if mission is self.mission else Path(mission.origin.file or mission.name).name
        return RunResult(
            result=result, reason=reason, text=text, sim_time_s=system.clock.now_ns() / NS, wall_time_s=self.loop.wall_time_s,
            ticks=0 if activity is None else activity.ticks, distance_m=simulator.distance_m, collisions=len(simulator.collisions),
            hit_by=len(simulator.hit_by), min_clearance_m=clearance_m if clearance_m < float("inf") else None, final_pose=simulator.pose,
            estimated_pose=None if believed is None else (believed.pose[0], believed.pose[1], math.remainder(believed.pose[3], math.tau)),
            trace_sha256=system.trace.sha256(), leaves=_leaves(mission), blackboard=dict(mission.blackboard.items()), contacts=contacts,
            seed=self.inputs.seed, mission=name, world=self.inputs.world.name, platform=self.inputs.robot.name,
            faults=[fault.as_json() for fault in self.inputs.warnings], contracts=[kept.as_json() for kept in system.executive.contracts],
        )  # fmt: skip

    def _outcome(self) -> tuple[str, str, str]:
        """(result, reason, sentence)."""
        system, activity = self.system, self.system.executive.core.mission
        if activity is not None and activity.error is not None and activity.state != ABORTED:  # else it was over before a leaf raised
            return "STOPPED", "leaf-error", activity.text
        if system.guard.ended is not None:
            return system.guard.ended
        if activity is None or activity.state == ABORTED:
            return "STOPPED", "stopped", "" if activity is None else activity.reason
        return ("SUCCESS" if activity.state == SUCCEEDED else "FAILURE"), activity.reason, activity.text

    def goals(self) -> Sequence[tuple[float, float]]:
        """The goals that the mission drove to, for the picture."""
        robot = self.system.robot
        return tuple(dict.fromkeys(robot.goals))


def make_runner(
    inputs: Inputs,
    *,
    realtime: bool = False,
    speed: float = 1.0,
    max_time_s: float | None = None,
    trace_path: str | Path | None = None,
    record: str | Path | None = None,
    resume: ResumeRequest | None = None,
    doors: Doors = CLOSED,
    nodes: Sequence[type] = (),
    on_event: Callable[[Event], None] = lambda event: None,
    on_progress: Callable[[System], None] = lambda system: None,
    on_compiling: Callable[[], None] = lambda: None,
) -> Runner:
    """Load the mission, which `read_inputs` has checked, then make the robot around it.

    With `resume` a journal is kept, and looked at first.

    Raises: InputError if a leaf cannot be made, or a door not be opened.
    """
    clock: VirtualClock | MonotonicClock = MonotonicClock(speed) if realtime else VirtualClock()
    own_clock = StepClock() if realtime else None
    topics = TopicGlobals()
    load, load_to_order = _loaders(nodes, own_clock or clock, topics)
    mission = load(inputs.mission_path, tree=inputs.tree, ports=inputs.ports, file=str(inputs.mission_path))
    resumption = None if resume is None else decide(resume, inputs, mission, calendar_ns())
    if resumption is not None:
        inputs = replace(inputs, start=resumption.start or inputs.start)
    options = Options(
        world=inputs.world, robot=inputs.robot, params_path=inputs.params, map=inputs.map, start=inputs.start, seed=inputs.seed,
        max_time_s=max_time_s, trace_path=Path(trace_path) if trace_path else None, doors=doors.opened(realtime=realtime),
        load=load, load_checked=load_to_order,
        on_event=on_event, on_progress=on_progress, on_compiling=on_compiling,
        record=None if record is None else record_request(Path(record), inputs, mission, realtime, resumption), own_clock=own_clock,
    )  # fmt: skip
    runner = Runner(inputs, mission, clock, options)
    topics.view = lambda: runner.system.robot.snapshot
    runner.mission.attach(runner.system.robot)
    if resumption is not None:
        runner.keep_journal(resumption)
    return runner


def _loaders(nodes: Sequence[type], clock: MissionClock, topics: TopicGlobals) -> tuple[Callable[..., Mission], Callable[..., Mission]]:
    """How the missions of a run are loaded: those that were checked before, and those that somebody orders, which are checked first."""

    def load(text: str | Path, **more: Any) -> Mission:
        return load_mission(text, nodes, clock, topics=topics, **more)

    def load_to_order(text: str, ports: Mapping[str, str]) -> Mission:
        return load_checked(text, ports, nodes, clock, topics=topics)

    return load, load_to_order


def _leaves(mission: Mission) -> dict[str, str]:
    """The last status of each leaf, by path."""
    paths = {tracked.path for tracked in mission.nodes() if not tracked.node.children}
    return {path: status for path, status in mission.statuses().items() if path in paths}


def _contact(contact: Any, kind: str) -> dict[str, Any]:
    return {"kind": kind, "t_s": contact.t_s, "x_m": contact.x_m, "y_m": contact.y_m, "with_id": contact.with_id, "speed_mps": contact.speed_mps}
