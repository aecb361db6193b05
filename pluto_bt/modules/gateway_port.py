"""The robot as the gateway sees it: the executive's side of `pluto_bt.gateway.port.RobotPort`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

import msgspec

from pluto_bt.blackboard.messages import ActuatorState, Event, MissionState, ModulesState
from pluto_bt.commands.files import SHIPPED, package_root
from pluto_bt.gateway.port import Newest, RefusedError, RunState
from pluto_bt.gateway.replies import Cause
from pluto_bt.modules.context import Context
from pluto_bt.modules.executive import module_state
from pluto_bt.modules.why_watch import WhyWatch
from pluto_bt.runtime.latch import ESTOP, OPERATOR_STOP
from pluto_bt.skills.reasons import STOPPED
from pluto_bt.trees import Mission, MissionError
from pluto_bt.trees.executive import ABORTED, PAUSED, RUNNING, Activity

LINK_OF_TARGET = {"motion": "motion", "avoidance": "avoid", "drive": "drive", "wrist": "wrist"}
ENDS = ("preempted", "timeout")  # reasons that are states of their own on the wire
ERRANDS_KEPT = 64
OPS_OF_STATE = {"pause": RUNNING, "resume": PAUSED}


class Errand(NamedTuple):
    """A run of a single node, and when its time is over."""

    activity: Activity
    ends_s: float


class GatewayPort:
    """Implements `RobotPort` over a `System`."""

    def __init__(self, context: Context) -> None:
        self._system = context.system
        self._loaded: Mission | None = None
        self._errands: dict[str, Errand] = {}
        self._latch = context.latch
        self.why_watch = WhyWatch(context)

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
        self._system.operator_stop(source)

    def estop(self, source: str, reason: str) -> None:
        """As stop, latched until released."""
        self._latch.set(ESTOP, reason or "emergency stop")
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
        self._refuse_if_latched()
        if self._mission_runs():
            raise RefusedError("wrong-state", "a mission runs; pause it first")
        if target != "wrist":
            self._latch.release(OPERATOR_STOP)  # a new command is a deliberate act
        if self._system.inboxes[LINK_OF_TARGET[target]].post(source, command):
            raise RefusedError("wrong-state", f"{target} takes commands only from the link above it while that one's thread runs")

    def run_node(self, node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        """Start one node as an errand."""
        self._refuse_if_latched()
        if self._mission_runs():
            raise RefusedError("wrong-state", "a mission runs; pause it first")
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in ports.items())
        try:
            mission = self._load(f'<root BTCPP_format="4"><BehaviorTree ID="run"><{node}{attributes}/></BehaviorTree></root>')
        except MissionError as error:
            fault = error.faults[0]
            code = "unknown-node" if fault.code == "unknown-node" else "bad-value"
            raise RefusedError(code, "; ".join(filter(None, (fault.message, fault.expected and f"expected {fault.expected}", fault.mend)))) from None
        self._latch.release(OPERATOR_STOP)
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
        outputs = tuple(activity.mission.outputs().items()) if activity.is_over else ()
        return RunState(RUNNING if activity.state == PAUSED else activity.state, activity.reason, activity.text, outputs)

    def cancel(self, run: str, reason: str) -> None:
        """End an errand with zero velocity."""
        errand = self._errands.get(run)
        if errand is not None:
            self._system.executive.core.end_errand(errand.activity, reason)

    def mission_state(self) -> MissionState:
        """The mission, with what has been ordered already: who pauses it may go on at once, not only after the executive's next step."""
        sample, coming = self._system.board.newest("mission/state"), self._system.executive.core.coming_state
        known = sample.value if sample is not None and isinstance(sample.value, MissionState) else MissionState(self.now_s())
        return known if known.state == coming else msgspec.structs.replace(known, state=coming, reason="")

    def mission_names(self) -> Sequence[str]:
        """The shipped missions."""
        return sorted(path.name for path in (package_root() / SHIPPED["mission"][0]).glob("*.xml"))

    def mission(self, op: str, name: str, text: str, source: str) -> None:
        """Load, check, start, pause, resume, abort."""
        core = self._system.executive.core
        if op in ("load", "check"):
            loaded = self._load_named(name, text)
            self._loaded = loaded if op == "load" else self._loaded
        elif op == "start":
            self._refuse_if_latched()
            if self._loaded is None:
                raise RefusedError("wrong-state", 'no mission is loaded; send <mission op="load" name="…"/> first')
            if self._mission_runs():
                raise RefusedError("wrong-state", "a mission runs; abort it first")
            self._latch.release(OPERATOR_STOP)
            core.start(self._loaded)
        elif op == "abort":
            core.abort(STOPPED)
        elif op in OPS_OF_STATE:
            if op == "resume":
                self._refuse_if_latched()
            if self.mission_state().state != OPS_OF_STATE[op]:
                raise RefusedError("wrong-state", f"the mission is {self.mission_state().state}; {op} needs one that is {OPS_OF_STATE[op]}")
            core.pause(OPERATOR_STOP) if op == "pause" else self._system.operator_resume()
        else:
            raise RefusedError("invalid", f'mission op="{op}" is not offered')

    def tree_text(self, format: str) -> str:
        """The tree drawn."""
        from pluto_bt.trees.dump import dump

        active = self._system.executive.core.active
        return "" if active is None else dump(active.mission, format)

    def why(self, at_s: float | None) -> tuple[bool, Sequence[Cause]]:
        """The chain of causes."""
        return self.why_watch.answer(at_s, self.now_s())

    def modules(self) -> ModulesState:
        """Every module of the run."""
        return ModulesState(self.now_s(), tuple(module_state(part) for part in self._system.parts))

    def module(self, name: str, op: str, source: str) -> None:
        """Start or stop a module."""
        try:
            self._system.order_module(name, op == "start")
        except KeyError:
            raise RefusedError("unknown-module", f'no module "{name}"') from None

    def _mission_runs(self) -> bool:
        state: str = self._system.executive.core.coming_state
        return state == RUNNING

    def _refuse_if_latched(self) -> None:
        hold = self._latch.hold(ESTOP)
        if hold is not None:
            raise RefusedError("estopped", f"emergency stop ({hold.text}); release it first")

    def _load(self, text: str) -> Mission:
        mission = self._system.options.load(text)
        mission.attach(self._system.robot)
        return mission

    def _load_named(self, name: str, text: str) -> Mission:
        if not text and name not in self.mission_names():
            raise RefusedError("bad-mission", f'no mission "{name}" is shipped; send it inline')
        try:
            return self._load(text or str(package_root() / SHIPPED["mission"][0] / name))
        except MissionError as error:
            raise RefusedError("bad-mission", str(error)) from None
