"""The robot as the gateway sees it: the executive's side of `pluto_bt.gateway.port.RobotPort`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from pluto_bt.blackboard.messages import ActuatorState, Event, MissionState, ModulesState
from pluto_bt.gateway.port import NO_PORTS, Newest, RefusedError, RunState
from pluto_bt.gateway.replies import Cause, Item, ParamsState
from pluto_bt.gateway.requests import Params
from pluto_bt.gateway.setting import message_from
from pluto_bt.maps.numbers import MAX_METRES
from pluto_bt.modules.catalogue import catalogue
from pluto_bt.modules.context import Context
from pluto_bt.modules.executive import module_state
from pluto_bt.modules.gateway_missions import GatewayMissions
from pluto_bt.modules.tuning import Tuning
from pluto_bt.modules.why_watch import WhyWatch
from pluto_bt.runtime.latch import ESTOP, OPERATOR_STOP
from pluto_bt.source import did_you_mean
from pluto_bt.trees.activity import ABORTED, RUNNING, Activity

LINK_OF_TARGET = {"motion": "motion", "avoidance": "avoid", "drive": "drive", "wrist": "wrist"}
ENDS = ("preempted", "timeout")  # reasons that are states of their own on the wire
ERRANDS_KEPT = 64


class Errand(NamedTuple):
    """A run of a single node, and when its time is over."""

    activity: Activity
    ends_s: float


class GatewayPort:
    """Implements `RobotPort` over a `System`."""

    def __init__(self, context: Context) -> None:
        self._system = context.system
        self._missions = GatewayMissions(context)
        self._errands: dict[str, Errand] = {}
        self._latch = context.latch
        self.why_watch = WhyWatch(context)
        self._tuning = Tuning(context.system.options.robot, context.system.tune, context.system.options.params_path)
        board = context.board
        self._publishers = {topic.name: board.publisher(topic.name, "gateway") for topic in board.topics if topic.writer == "gateway"}
        self._is_interactive = False

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._system.options.world.robot.name

    def now_s(self) -> float:
        """Seconds of the run's clock."""
        return self._system.clock.now_s()

    def topics(self) -> Sequence[str]:
        """Names of all topics."""
        return [topic.name for topic in self._system.board.topics]

    def newest(self, topic: str) -> Newest | None:
        """The newest value of a topic."""
        sample = self._system.board.newest(topic)
        return None if sample is None else Newest(sample.value, sample.seq, sample.written_s)

    def events_after(self, seq: int) -> Sequence[tuple[int, Event]]:
        """Events with a sequence number above `seq`, oldest first."""
        return [(s.seq, s.value) for s in self._system.board.history("events") if s.seq > seq and isinstance(s.value, Event)]

    def stop(self, source: str) -> None:
        """Zero velocity at once; a running mission pauses."""
        self._touch(stop=source)
        was_free = self._latch.hold(OPERATOR_STOP) is None  # who stops it again and again is told once
        self._system.operator_stop(source)
        if was_free:
            self._system.say("warning", OPERATOR_STOP, source, f"{source} stopped the robot")

    def estop(self, source: str, reason: str) -> None:
        """As stop, latched until released."""
        self._latch.set(ESTOP, reason or "emergency stop")
        self._touch(estop=reason)
        self._system.operator_stop(source, ESTOP)
        self._system.say("error", ESTOP, source, f"emergency stop: {reason or 'no reason given'}")

    def release_estop(self, source: str) -> None:
        """Unlatch; nothing moves by that."""
        if self._latch.release(ESTOP):
            self._system.say("info", "estop-released", source, "emergency stop released; nothing moves until it is commanded")

    def estop_reason(self) -> str | None:
        """Why the robot is latched, None if it is not."""
        hold = self._latch.hold(ESTOP)
        return None if hold is None else hold.text

    def post_command(self, target: str, command: ActuatorState, source: str) -> None:
        """Give a command to a link of the chain or to the wrist."""
        _require_sane(command)
        self._missions.require_idle("pause it first")
        if target != "wrist":
            self._latch.release(OPERATOR_STOP)  # a new command is a deliberate act
        self._touch(command=target)
        if self._system.inboxes[LINK_OF_TARGET[target]].post(source, command):
            raise RefusedError("wrong-state", self._why_refused(target))

    def _why_refused(self, target: str) -> str:
        """Why a link does not take a command, and what would help."""
        running = self._system.running_above(LINK_OF_TARGET[target])
        if not running:
            return f"{target} takes no commands now; <why/> tells what holds the robot"
        return f"{target} takes commands only from the link above it while that runs; first {', then '.join(f'stop {link}' for link in running)}"

    def run_node(self, node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        """Start one node as an errand."""
        self._missions.require_idle("pause it first")
        mission = self._missions.single(node, ports)
        self._latch.release(OPERATOR_STOP)
        self._touch(run=node)
        activity = self._system.executive.core.start_errand(mission)
        while len(self._errands) >= ERRANDS_KEPT:
            del self._errands[next(iter(self._errands))]
        self._errands[str(activity.number)] = Errand(activity, self.now_s() + deadline_s if deadline_s > 0 else math.inf)
        return str(activity.number)

    def run_state(self, run: str) -> RunState:
        """How an errand stands; one whose deadline is over is ended here."""
        errand = self._errands.get(run)
        if errand is None:
            return RunState("cancelled", "forgotten", f"only the last {ERRANDS_KEPT} runs are remembered")
        activity = errand.activity
        if not activity.is_over and self.now_s() >= errand.ends_s:
            self._system.executive.core.end_errand(activity, "timeout")
            return RunState("timeout", "timeout", "the deadline is over")
        if activity.state == ABORTED:
            return RunState(activity.reason if activity.reason in ENDS else "cancelled", activity.reason)
        if not activity.is_over:
            return RunState(RUNNING, "", str(activity.mission.root.feedback_message))
        return RunState(activity.state, activity.reason, activity.text, tuple(activity.mission.outputs().items()))

    def cancel(self, run: str, reason: str) -> None:
        """End an errand with zero velocity."""
        errand = self._errands.get(run)
        if errand is not None:
            self._system.executive.core.end_errand(errand.activity, reason)

    def mission_state(self) -> MissionState:
        """The mission, with what has been ordered already."""
        return self._missions.state()

    def mission_names(self) -> Sequence[str]:
        """The shipped missions."""
        return self._missions.names()

    def mission_text(self, name: str) -> str:
        """The document of a shipped mission, or of the one at work."""
        return self._missions.text(name)

    def mission(self, op: str, name: str, text: str, source: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Load, check, start, pause, resume, abort."""
        if op not in ("load", "check"):
            self._touch(mission=op)
        self._missions.act(op, name, text, ports)

    def prepare_mission(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Read a document beside the work of the link."""
        self._missions.prepare(op, name, text, ports)

    def tree_text(self, format: str) -> str:
        """The tree drawn."""
        from pluto_bt.trees.dump import dump

        shown = self._system.executive.core.shown
        return dump(shown[0].mission, format) if shown else ""

    def why(self, at_s: float | None) -> tuple[bool, Sequence[Cause]]:
        """The chain of causes."""
        return self.why_watch.answer(at_s, self.now_s())

    def modules(self) -> ModulesState:
        """Every module of the run."""
        return ModulesState(self.now_s(), tuple(module_state(part, self._system.clock.now_ns()) for part in self._system.parts))

    def module(self, name: str, op: str, source: str) -> None:
        """Start or stop a module."""
        names = [part.module.name for part in self._system.parts]
        if name not in names:
            raise RefusedError("unknown-module", f'no module "{name}"; {did_you_mean(name, names) or "one of: " + ", ".join(names)}')
        self._touch(module=name, op=op)
        self._system.order_module(name, op == "start")

    def params(self, request: Params, source: str) -> ParamsState:
        """Look at parameters, or change them."""
        state, changed = self._tuning.answer(request, self.now_s())
        self._tell_change(changed, source)
        return state

    def step(self, now_s: float) -> None:
        """Watch the situation; a change of parameters that nobody confirmed goes back."""
        self.why_watch.step(now_s)
        self._tell_change(self._tuning.step(now_s), "nobody confirmed: gateway")

    def set_topic(self, topic: str, fields: Mapping[str, str], source: str) -> None:
        """Write one of the gateway's own topics."""
        known = {row.name: row for row in self._system.board.topics}
        if topic not in known:
            raise RefusedError("unknown-topic", f'unknown topic "{topic}"; {did_you_mean(topic, known) or "<describe/> lists all"}')
        if topic not in self._publishers:
            raise RefusedError("read-only", f"{topic} is written by {known[topic].writer}; clients may set {', '.join(self._publishers)}")
        value = message_from(known[topic].type, fields, self.now_s())
        self._touch(set=topic)
        self._publishers[topic].put(value, self.now_s())

    def catalogue(self) -> Sequence[Item]:
        """Nodes, parameters, modules and goals."""
        return catalogue(self._system.parts, self._system.context.map)

    def _tell_change(self, changed: Mapping[str, str], source: str) -> None:
        if changed:
            self._touch(params=dict(changed))
            self._system.say("info", "params-changed", source, ", ".join(f"{name} = {value}" for name, value in changed.items()))

    def _touch(self, **what: object) -> None:
        """Somebody interferes: the trace says so, for such a run cannot be repeated by its seed alone."""
        entry = {"t": self._system.clock.now_ns(), "gateway": what}
        if not self._is_interactive:
            self._is_interactive = True
            entry["interactive"] = True
        self._system.trace.line(entry)


def _require_sane(command: ActuatorState) -> None:
    """No number of a command, whatever its flags make of it, is larger than any place. Raises: RefusedError."""
    for field in ("position", "velocity", "acceleration", "force"):
        beyond = [number for number in getattr(command, field) if not abs(number) <= MAX_METRES]
        if beyond:
            raise RefusedError("out-of-range", f"<{field}>: expected numbers of at most {MAX_METRES:g}, found {beyond[0]:g}")
