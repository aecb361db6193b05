"""What clients of the gateway may do with missions: load, check, start, pause, resume, abort, and run a single node as one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import msgspec

from pluto_bt.blackboard.messages import MissionState
from pluto_bt.files import SHIPPED, package_root
from pluto_bt.gateway.port import NO_PORTS, RefusedError
from pluto_bt.modules.context import Context
from pluto_bt.runtime.latch import ESTOP, OPERATOR_STOP
from pluto_bt.skills.reasons import STOPPED
from pluto_bt.source import did_you_mean
from pluto_bt.trees import Mission, MissionError
from pluto_bt.trees.activity import PAUSED, RUNNING

FAULTS_TOLD = 50
OPS_OF_STATE = {"pause": RUNNING, "resume": PAUSED}
_INCLUDE = re.compile(r"<\s*include\b")
_NODE = re.compile(r"[A-Za-z_][A-Za-z0-9_.-]*")
Words = tuple[str, str, str, tuple[tuple[str, str], ...]]
"""Of a request: op, name, text, inputs."""
GIVE = 'give it by <p name="NAME">VALUE</p> before the document; in the shell by run MISSION NAME=VALUE'
PREPARED = 64
"""Missions that were read and wait to be fetched."""


class GatewayMissions:
    """The missions of one robot, as clients see them."""

    def __init__(self, context: Context) -> None:
        self._system, self._board, self._latch = context.system, context.board, context.latch
        self._loaded: Mission | None = None
        self._prepared: dict[Words, Mission | RefusedError] = {}

    def state(self) -> MissionState:
        """The mission, with what has been ordered already: who pauses it may go on at once, not only after the executive's next step."""
        sample, coming = self._board.newest("mission/state"), self._system.executive.core.coming_state
        known = sample.value if sample is not None and isinstance(sample.value, MissionState) else MissionState(self._system.clock.now_s())
        return known if known.state == coming else msgspec.structs.replace(known, state=coming, reason="")

    def names(self) -> Sequence[str]:
        """The shipped missions."""
        return sorted(path.name for path in (package_root() / SHIPPED["mission"][0]).glob("*.xml"))

    def text(self, name: str) -> str:
        """The document of a shipped mission, or of the one at work. Raises: RefusedError."""
        if name:
            return self._path(name).read_text(encoding="utf-8")
        activity = self._system.executive.core.mission
        if activity is None:
            raise RefusedError("no-value", 'no mission is at work; name one of those that <mission op="list"/> tells')
        from pluto_bt.trees.dump import dump

        return dump(activity.mission, "xml")

    def act(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Load, check, start, pause, resume, abort. Raises: RefusedError; a bad load leaves all as it was."""
        core = self._system.executive.core
        if op in ("load", "check"):
            loaded = self._read(op, name, text, ports)
            self._loaded = loaded if op == "load" else self._loaded
        elif op == "start":
            self.require_idle("abort it first")
            if self._loaded is None:
                raise RefusedError("wrong-state", 'no mission is loaded; send <mission op="load" name="…"/> first')
            self._latch.release(OPERATOR_STOP)
            core.start(self._loaded)
        elif op == "abort":
            core.abort(STOPPED)
        elif op in OPS_OF_STATE:
            if op == "resume":
                self._refuse_if_latched()
            if op == "pause" and self.state().state == PAUSED:
                core.pause(OPERATOR_STOP)  # it stands already; but now it does not go on by itself
                return
            if self.state().state != OPS_OF_STATE[op]:
                raise RefusedError("wrong-state", f"the mission is {self.state().state}; {op} needs one that is {OPS_OF_STATE[op]}")
            core.pause(OPERATOR_STOP) if op == "pause" else self._system.operator_resume()
        else:
            raise RefusedError("invalid", f'mission op="{op}" is not offered')

    def prepare(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Read a document in whatever thread; the next `act` with the same words takes what came of it."""
        try:
            read: Mission | RefusedError = self._named(name, text, ports)
        except RefusedError as refusal:
            read = refusal
        self._prepared[op, name, text, tuple(ports.items())] = read
        for words in list(self._prepared)[:-PREPARED]:  # whoever asked for these never fetched them
            self._prepared.pop(words, None)

    def _read(self, op: str, name: str, text: str, ports: Mapping[str, str]) -> Mission | None:
        """The mission, None if it was only to be checked. Raises: RefusedError."""
        prepared = self._prepared.pop((op, name, text, tuple(ports.items())), None)
        if prepared is None:
            return self._named(name, text, ports)
        if isinstance(prepared, RefusedError):
            raise prepared
        return prepared if op == "load" else None

    def single(self, node: str, ports: Mapping[str, str]) -> Mission:
        """A mission of this one node or library tree. Raises: RefusedError."""
        if not _NODE.fullmatch(node):
            raise RefusedError("unknown-node", f'unknown node "{node[:40]}"; expected the name of a node')
        attributes = "".join(f" {name}={quoteattr(value)}" for name, value in ports.items())
        try:
            return self._load(f'<root BTCPP_format="4"><BehaviorTree ID="run"><{node}{attributes}/></BehaviorTree></root>')
        except MissionError as error:
            raise _refusal(error, {"unknown-node": "unknown-node"}, "bad-value", with_place=False) from None

    def require_idle(self, cure: str) -> None:
        """Raises: RefusedError if the robot is latched, or a mission runs."""
        self._refuse_if_latched()
        if self._system.executive.core.coming_state == RUNNING:
            raise RefusedError("wrong-state", f"a mission runs; {cure}")

    def _refuse_if_latched(self) -> None:
        hold = self._latch.hold(ESTOP)
        if hold is not None:
            raise RefusedError("estopped", f"emergency stop ({hold.text}); release it first")

    def _load(self, text: str, ports: Mapping[str, str] = NO_PORTS) -> Mission:
        mission = self._system.options.load_checked(text, ports)
        mission.attach(self._system.robot)
        return mission

    def _named(self, name: str, text: str, ports: Mapping[str, str]) -> Mission:
        """The mission that came inline, else the shipped one of that name. A client names no other file."""
        if text and not text.lstrip().startswith("<"):
            raise RefusedError("bad-mission", f"expected a document <root>…</root>, found {text.strip()[:40]!r}")
        if _INCLUDE.search(text):
            raise RefusedError("bad-mission", "a mission sent inline includes no files: expected one whole document, found <include>")
        try:
            return self._load(text.lstrip() or str(self._path(name)), ports)
        except MissionError as error:
            raise _refusal(error, {}, "bad-mission", with_place=True) from None

    def _path(self, name: str) -> Path:
        """The file of a shipped mission."""
        known = self.names()
        if name not in known:
            hint = did_you_mean(name, known)
            raise RefusedError("bad-mission", f'no mission "{name}" is shipped; {hint + ", or " if hint else ""}send it inline')
        return package_root() / SHIPPED["mission"][0] / name


def _refusal(error: MissionError, codes: Mapping[str, str], otherwise: str, *, with_place: bool) -> RefusedError:
    """All faults of a document, each with its line and column in it (line 1 = that of `<root>`)."""
    refusals = []
    for fault in error.faults:
        mend = GIVE if fault.code == "missing-input" else fault.mend
        words = (fault.message, fault.expected and f"expected {fault.expected}", fault.found and f"found {fault.found}", mend)
        place = (fault.line, fault.column) if with_place else (0, 0)
        refusals.append(RefusedError(codes.get(fault.code, otherwise), "; ".join(filter(None, words)), *place))
    first, *more = refusals[:FAULTS_TOLD]
    return RefusedError(first.code, first.text, first.line, first.column, more)
