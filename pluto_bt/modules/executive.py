"""The executive as a module: ticks the mission and shows tree, mission, events and modules on the blackboard."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence

import msgspec

from pluto_bt.blackboard.messages import Event, MissionState, ModulesState, ModuleState, Pose, TreeState
from pluto_bt.modules.context import Context
from pluto_bt.modules.contract_guardian import ContractGuardian
from pluto_bt.modules.job_runner import JobRunner
from pluto_bt.modules.journal_keeper import JournalKeeper
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.modules.tick_log import TickLog
from pluto_bt.runtime.clock import NS
from pluto_bt.runtime.supervision import Part
from pluto_bt.trees.activity import RUNNING, Activity
from pluto_bt.trees.contracts import Kept
from pluto_bt.trees.executive import Executive as Core

SHOW_MODULES_EVERY = 10
WORDS_EVERY_S, WORDS_A_NODE_S = 0.5, 0.001  # so often the words of the nodes are shown, if somebody may look on; of many nodes less often


class Executive:
    """Owns `mission/state`, `tree`, `events` and `modules`; writes one trace line a tick."""

    def __init__(self, context: Context) -> None:
        board = context.board
        self._clock = context.clock
        self._system = context.system
        self._mission = board.publisher("mission/state", "executive")
        self._tree = board.publisher("tree", "executive")
        self._events = board.publisher("events", "executive")
        self._modules = board.publisher("modules", "executive")
        self._pose = board.reader("Localization/Pose")
        self._waiting: deque[Event] = deque()
        self.on_event: Callable[[Event], None] = lambda event: None
        self.on_ticked: Callable[[list[Activity], list[str]], None] | None = None  # a monitor that looks on
        self.core = Core(context.system.robot, lambda level, code, text: self.say(level, code, "mission", text))
        self._jobs = JobRunner(context, self.core, context.system.robot, context.system.options.load)
        self._shown: MissionState | None = None
        self._shown_statuses = ""
        self._shown_states: list[tuple[int, str]] = []
        self._next_words_s = math.inf
        self._steps = 0
        self._own_clock = context.own_clock
        self.keeper: JournalKeeper | None = None
        self._guardian = ContractGuardian(context, self.core)
        self._log = TickLog(context, self.core, context.black_box) if context.black_box is not None else None

    def start(self, now_s: float) -> None:
        """Nothing to take."""

    def tune(self, robot: RobotFile) -> None:
        """Parameters have changed."""
        self._system.robot.tune(robot)

    def stop(self) -> None:
        """Nobody decides any more: the robot stands."""
        self.core.let_go()

    def say(self, level: str, code: str, source: str, text: str) -> None:
        """Queue a line for operators; any thread."""
        self._waiting.append(Event(self._clock.now_s(), level, code, source, text))

    def step(self, now_s: float) -> None:
        """One turn of the executive, then what changed goes to the blackboard."""
        if self._own_clock is not None:
            self._own_clock.step_to(now_s)
        self._jobs.take_orders()
        ticked = self.core.step(now_s)
        self._jobs.tell(now_s)
        lines = [activity.mission.status_line() for activity in ticked]
        if ticked:
            self._show_trees(ticked, lines, now_s)
            if self.on_ticked is not None:
                self.on_ticked(ticked, lines)
            self._guardian.look(ticked, now_s)
        self._show_turns(now_s)
        if self.keeper is not None:
            self._keep(self.keeper, ticked, lines, now_s)
        if self._log is not None:
            self._log.step(now_s, ticked, lines)
        else:
            self.core.take_done()
        self._show_mission(now_s)
        if self._steps % SHOW_MODULES_EVERY == 0:
            self._modules.put(ModulesState(now_s, tuple(module_state(part, self._clock.now_ns()) for part in self._system.parts)), now_s)
        self._steps += 1
        self.flush(now_s)

    def flush(self, now_s: float) -> None:
        """Publish the events that wait."""
        while self._waiting:
            event = self._waiting.popleft()
            self._events.put(event, now_s)
            self.on_event(event)

    def _keep(self, keeper: JournalKeeper, ticked: list[Activity], lines: list[str], now_s: float) -> None:
        """The journal of the mission; it ends with the mission, or when another one takes its place.

        What an earlier run has left is not touched as long as the mission waits, nor by the end of a run that only waited.
        """
        activity = self.core.mission
        if activity is None or (activity.ticks == 0 and (not activity.is_over or self._system.guard.ended is not None)):
            return
        is_its = activity.mission is keeper.mission
        if is_its and activity in ticked:
            keeper.after_tick(activity.ticks, lines[ticked.index(activity)])
        if not is_its or activity.is_over:
            keeper.end()
            self.keeper = None
        else:
            keeper.look(now_s)

    @property
    def contracts(self) -> list[Kept]:
        """How the contracts of the mission have stood."""
        return self._guardian.kept

    def note_end(self, now_s: float) -> None:
        """The run is over: note how things stand, also if the executive itself hangs."""
        if self._log is not None:
            self._log.step(now_s, [], [], is_end=True)

    def _show_trees(self, ticked: list[Activity], lines: list[str], now_s: float) -> None:
        """A trace line for each tree; the nodes of all of them, the mission's first, when a status has changed or somebody may read the words."""
        for activity, statuses in zip(ticked, lines, strict=True):
            self._record(activity, statuses)
        shown = " ".join(lines)
        if shown != self._shown_statuses or now_s >= self._next_words_s:
            self._shown_statuses = shown
            count = self._put_tree(ticked, now_s)
            is_watched = self._system.options.doors.take_orders
            self._next_words_s = now_s + max(WORDS_EVERY_S, WORDS_A_NODE_S * count) if is_watched else math.inf

    def _show_turns(self, now_s: float) -> None:
        """What is not ticked any more, because it was ended, paused or gave way, is shown as it stands now, not as it ran."""
        shown = self.core.shown
        states = [(activity.number, activity.state) for activity in shown]
        if states != self._shown_states:
            self._shown_states = states
            if any(activity.state != RUNNING for activity in shown):
                self._shown_statuses = ""
                self._put_tree(shown, now_s)

    def _put_tree(self, activities: Sequence[Activity], now_s: float) -> int:
        """Publish the nodes of these trees as one; how many there are."""
        nodes = tuple(node for activity in activities for node in activity.mission.node_states())
        self._tree.put(TreeState(now_s, activities[0].ticks, nodes), now_s)
        return len(nodes)

    def _record(self, ticked: Activity, statuses: str) -> None:
        sample = self._pose()
        pose = sample.value.pose if sample is not None and isinstance(sample.value, Pose) else None
        self._system.trace.line({"t": self._clock.now_ns(), "tick": ticked.ticks, "run": ticked.number, "nodes": statuses, "pose": pose})

    def _show_mission(self, now_s: float) -> None:
        activity = self.core.mission
        if activity is None:
            return
        state = MissionState(0.0, activity.mission.name, activity.number, activity.state, activity.reason, activity.mission.active_leaf())
        if state != self._shown:
            self._shown = state
            self._mission.put(msgspec.structs.replace(state, stamp_s=now_s, ticks=activity.ticks), now_s)


def module_state(part: Part, now_ns: int) -> ModuleState:
    """One row of `modules`."""
    row, age_s = part.module, max(0, now_ns - part.stepped_ns) / NS
    return ModuleState(row.name, row.group, part.state, part.steps, part.failures, part.overruns, part.worst_ns / 1e6, part.error, age_s)
