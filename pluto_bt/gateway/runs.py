"""The one node that a client runs: watched until it is over, its owner told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from pluto_bt.gateway.outcomes import Outcome
from pluto_bt.gateway.port import RobotPort, RunState
from pluto_bt.gateway.replies import RUN_FINAL, AnyReply, Progress, Result
from pluto_bt.gateway.requests import Run
from pluto_bt.gateway.wire import Key

PROGRESS_S = 0.2
NOTHING_SHOWN = RunState(state="")
Tell = Callable[[Key, AnyReply], None]
"""(key of the client, reply)."""


@dataclass(slots=True)
class Active:
    """A run that is not over. `key` is its owner's session or connection."""

    run: str
    key: Key
    id: str
    outcome: Outcome
    shown: RunState = NOTHING_SHOWN
    next_s: float = 0.0


class Runs:
    """At most one run at a time: a new one preempts the old one."""

    def __init__(self, port: RobotPort, tell: Tell) -> None:
        self._port = port
        self._tell = tell
        self._active: Active | None = None

    @property
    def active(self) -> Active | None:
        """The run that is not over, if any."""
        return self._active

    def start(self, key: Key, request: Run, outcome: Outcome, source: str) -> str:
        """Begin a run; the robot preempts the one before, unless he refuses the new one. Raises: RefusedError."""
        run = self._port.run_node(request.node, request.ports, request.deadline_s, source)
        if self._active is not None:
            self._over(self._active, RunState("preempted", "preempted", f"{source} began another run"))
        self._active = Active(run, key, request.id, outcome)
        return run

    def poll(self, now_s: float) -> None:
        """Tell the owner what is new: the end at once, progress at most every `PROGRESS_S`."""
        active = self._active
        if active is None:
            return
        state = self._port.run_state(active.run)
        if state.state in RUN_FINAL:
            self._over(active, state)
        elif state != active.shown and now_s >= active.next_s:
            active.shown, active.next_s = state, now_s + PROGRESS_S
            self._say(active, Progress(id=active.id, run=active.run, state=state.state, text=state.text))

    def finish(self, state: str, reason: str, text: str) -> None:
        """End the run from our side: `cancelled` or `preempted`. One that is over by itself keeps its own result."""
        active = self._active
        if active is None:
            return
        last = self._port.run_state(active.run)
        if last.state in RUN_FINAL:
            self._over(active, last)
            return
        self._port.cancel(active.run, reason)
        self._over(active, RunState(state, reason, text, last.outputs))

    def _over(self, active: Active, state: RunState) -> None:
        self._active = None
        self._say(active, Result(id=active.id, run=active.run, state=state.state, reason=state.reason, text=state.text, outputs=state.outputs))

    def _say(self, active: Active, reply: AnyReply) -> None:
        active.outcome.add(reply)
        self._tell(active.key, reply)
