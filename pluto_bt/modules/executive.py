"""The executive as a module: ticks the mission and shows tree, mission, events and modules on the blackboard."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from pluto_bt.blackboard.messages import Event, MissionState, ModulesState, ModuleState, NodeState, TreeState
from pluto_bt.modules.context import Context
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.trace import Trace
from pluto_bt.trees.executive import Executive as Core
from pluto_bt.trees.mission import Mission

SHOW_MODULES_EVERY = 10


class Executive:
    """Owns `mission/state`, `tree`, `events` and `modules`; writes one trace line a tick."""

    def __init__(self, context: Context) -> None:
        board = context.board
        self._clock = context.clock
        self._trace: Trace = context.extras["trace"]
        self._parts: Callable[[], tuple[Part, ...]] = context.extras["parts"]
        self._mission = board.publisher("mission/state", "executive")
        self._tree = board.publisher("tree", "executive")
        self._events = board.publisher("events", "executive")
        self._modules = board.publisher("modules", "executive")
        self._pose = board.reader("Localization/Pose")
        self._waiting: deque[Event] = deque()
        self.on_event: Callable[[Event], None] = lambda event: None
        self.core = Core(context.extras["robot"], lambda level, code, text: self.say(level, code, "mission", text))
        self._shown: tuple[object, ...] = ()
        self._shown_statuses = ""
        self._steps = 0

    def start(self, now_s: float) -> None:
        """Nothing to take."""

    def stop(self) -> None:
        """Nothing to let go."""

    def say(self, level: str, code: str, source: str, text: str) -> None:
        """Queue a line for operators; any thread."""
        self._waiting.append(Event(self._clock.now_s(), level, code, source, text))

    def step(self, now_s: float) -> None:
        """One turn of the executive, then what changed goes to the blackboard."""
        ticked = self.core.step(now_s)
        mission = self.core.mission
        statuses = "" if mission is None else mission.status_line()
        if ticked:
            self._record(now_s, statuses)
        if statuses != self._shown_statuses and mission is not None:
            self._shown_statuses = statuses
            self._show_tree(mission, now_s)
        self._show_mission(now_s)
        if self._steps % SHOW_MODULES_EVERY == 0:
            self._modules.put(ModulesState(now_s, tuple(module_state(part) for part in self._parts())), now_s)
        self._steps += 1
        self.flush(now_s)

    def flush(self, now_s: float) -> None:
        """Publish the events that wait."""
        while self._waiting:
            event = self._waiting.popleft()
            self._events.put(event, now_s)
            self.on_event(event)

    def _record(self, now_s: float, statuses: str) -> None:
        sample = self._pose()
        pose = None if sample is None else sample.value.pose  # type: ignore[attr-defined]  # the topic carries poses
        self._trace.line({"t": self._clock.now_ns(), "tick": self.core.ticks, "run": self.core.run, "nodes": statuses, "pose": pose})

    def _show_tree(self, mission: Mission, now_s: float) -> None:
        self._tree.put(TreeState(now_s, self.core.ticks, tuple(node_states(mission))), now_s)

    def _show_mission(self, now_s: float) -> None:
        core, mission = self.core, self.core.mission
        step = "" if mission is None else mission.active_leaf()
        shown = (core.state, core.reason, step, core.run)
        if shown != self._shown:
            self._shown = shown
            self._mission.put(MissionState(now_s, "" if mission is None else mission.name, core.run, core.state, core.reason, step, core.ticks), now_s)


def node_states(mission: Mission) -> list[NodeState]:
    """The nodes of a mission as the blackboard shows them."""
    return [NodeState(node.path, node.kind, node.name, node.depth, node.status, node.feedback, node.since_s) for node in mission.node_states()]


def module_state(part: Part) -> ModuleState:
    """One row of `modules`."""
    row = part.module
    return ModuleState(row.name, row.group, part.state, part.steps, part.failures, part.overruns, part.worst_ns / 1e6, part.error)
