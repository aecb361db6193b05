"""A robot for the gateway's tests: it remembers what was asked of it, and does what the test tells it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pluto_bt.blackboard import messages as m
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.gateway.port import NO_PORTS, Newest, RefusedError, RunState
from pluto_bt.gateway.replies import Cause, Item, Param, ParamsState
from pluto_bt.gateway.requests import Params
from pluto_bt.gateway.setting import message_from


class FakeRobot:
    """A RobotPort in memory. `did` lists what happened, in order."""

    name = "pluto"

    def __init__(self) -> None:
        self.time_s = 0.0
        self.did: list[tuple[object, ...]] = []
        self.values: dict[str, Newest] = {}
        self.events: list[tuple[int, m.Event]] = []
        self.runs: dict[str, RunState] = {}
        self.latched: str | None = None
        self.mission_now = m.MissionState(0.0)
        self.on_stop: list[object] = []
        self.on_prepare = lambda text: None
        self.rev = 1
        self.items: list[Item] = []
        self.documents: dict[str, str] = {}

    def write(self, topic: str, value: m.Message) -> None:
        old = self.values.get(topic)
        self.values[topic] = Newest(value, old.seq + 1 if old else 1, self.time_s)

    def says(self, text: str, level: str = "info", code: str = "say") -> None:
        self.events.append((len(self.events) + 1, m.Event(self.time_s, level, code, "test", text)))

    # RobotPort ---------------------------------------------------------------------------------------------------
    def now_s(self) -> float:
        return self.time_s

    def step(self, now_s: float) -> None:
        """Nothing is due."""

    def topics(self) -> Sequence[str]:
        return [topic.name for topic in TOPICS]

    def newest(self, topic: str) -> Newest | None:
        return self.values.get(topic)

    def events_after(self, seq: int) -> Sequence[tuple[int, m.Event]]:
        return self.events[seq:]

    def stop(self, source: str) -> None:
        self.did.append(("stop", source))

    def estop(self, source: str, reason: str) -> None:
        self.latched = reason or "estop"
        self.did.append(("estop", source, reason))

    def release_estop(self, source: str) -> None:
        self.latched = None
        self.did.append(("release", source))

    def estop_reason(self) -> str | None:
        return self.latched

    def post_command(self, target: str, command: m.ActuatorState, source: str) -> None:
        if target == "avoidance":
            raise RefusedError("wrong-state", "motion runs; stop the module motion first")
        self.did.append(("command", target, command.flags, command.velocity))

    def run_node(self, node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        if node != "GoTo":
            raise RefusedError("unknown-node", f'unknown node "{node}"; did you mean "GoTo"?')
        run = f"r{len(self.runs) + 1}"
        self.runs[run] = RunState()
        self.did.append(("run", node, dict(ports), deadline_s))
        return run

    def run_state(self, run: str) -> RunState:
        return self.runs[run]

    def cancel(self, run: str, reason: str) -> None:
        self.did.append(("cancel", run, reason))
        self.runs[run] = RunState("cancelled", reason)

    def mission_state(self) -> m.MissionState:
        return self.mission_now

    def mission_names(self) -> Sequence[str]:
        return ("patrol", "trip2")

    def mission(self, op: str, name: str, text: str, source: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        self.did.append(("mission", op, name, text, *([dict(ports)] if ports else [])))

    def prepare_mission(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        self.on_prepare(text)

    def tree_text(self, format: str) -> str:
        return "Sequence\n  GoTo <3;4>"

    def why(self, at_s: float | None) -> tuple[bool, list[Cause]]:
        if at_s is not None and at_s > self.time_s:
            raise RefusedError("out-of-range", f"known are 0.0 s to {self.time_s:.1f} s")
        bumper = Cause("sensor", "bumper", "front panel pressed", 4.0, 0.0, "back off")
        held = [] if self.latched is None else [Cause("operator", "estop", self.latched, 4.5)]
        raw = self.values.get("ATRV2/Drive/Raw")
        moves = raw is not None and isinstance(raw.value, m.ActuatorState) and any(raw.value.velocity)
        return moves, [*held, bumper, Cause("mission", "paused", "mission patrol paused", 1.0)]

    def modules(self) -> m.ModulesState:
        return m.ModulesState(self.time_s, (m.ModuleState("base", "chain", "running", 3, 0, 0, 0.5),))

    def module(self, name: str, op: str, source: str) -> None:
        if name != "slam":
            raise RefusedError("unknown-module", f'unknown module "{name}"')
        self.did.append(("module", name, op))

    def mission_text(self, name: str) -> str:
        return self.documents.get(name, f"<root>{name}</root>")

    def params(self, request: Params, source: str) -> ParamsState:
        if request.op == "set" and request.rev not in (None, self.rev):
            raise RefusedError("conflict", f'expected rev="{self.rev}"')
        if "a.b" in request.values:
            raise RefusedError("unknown-param", "a.b", more=[RefusedError("out-of-range", "c.d")])
        self.did.append(("params", request.op, dict(request.values), request.confirm_s))
        self.rev += request.op == "set"
        return ParamsState(rev=self.rev, confirm_s=request.confirm_s, rows=(Param("avoid.margin_m", "0.1", "a number", "m", ">= 0", "0.08", True),))

    def set_topic(self, topic: str, fields: Mapping[str, str], source: str) -> None:
        if topic != "operator/word":
            raise RefusedError("read-only", f"{topic} is not the gateway's")
        self.write(topic, message_from(m.Flag, fields, self.time_s))

    def catalogue(self) -> Sequence[Item]:
        return self.items
