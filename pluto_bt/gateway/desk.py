"""The executive's side of the gateway: lease, stop, runs and outcomes live here, so that a killed gateway loses none of them.

`urgent` is for the link's thread; everything else belongs to the thread that steps the link.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

from pluto_bt.gateway import inquiries, replies, requests
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.callers import Callers
from pluto_bt.gateway.helm import Helm
from pluto_bt.gateway.outcomes import Outcomes
from pluto_bt.gateway.port import RefusedError, RobotPort
from pluto_bt.gateway.replies import AnyReply, Error, Ok, with_id
from pluto_bt.gateway.requests import actuator
from pluto_bt.gateway.runs import Runs
from pluto_bt.gateway.wire import Answer, Ask, Key, source_of

_MOVES = {"start", "resume"}


class Desk:
    """Answers requests, one at a time, and watches what they began."""

    def __init__(self, port: RobotPort, send: Callable[[Answer], None], audit: Audit) -> None:
        """`send` must be thread-safe and never block."""
        self._port = port
        self._send = send
        self._audit = audit
        self._helm = Helm(port, self._end_run)
        self._outcomes = Outcomes()
        self._runs = Runs(port, self._tell)
        self._callers = Callers()
        self._stopped: deque[str] = deque()
        self.stops = 0  # counts stops, so that a request which a stop overtook is known

    # the link's thread -------------------------------------------------------------------------------------------
    def urgent(self, ask: Ask) -> bool:
        """Do a stop at once; False if the request is none."""
        request = ask.request
        if not isinstance(request, requests.Stop | requests.Estop):
            return False
        self.stops += 1
        reply: AnyReply = Ok(id=request.id)
        try:
            if isinstance(request, requests.Estop):
                self._port.estop(source_of(ask), request.reason)
            else:
                self._port.stop(source_of(ask))
        except Exception as error:  # the one who stops must hear that it did not work, and the link must live on
            reply = Error(id=request.id, code="internal", text=f"the robot's stop raised {type(error).__name__}: {error}")
        self._stopped.append(source_of(ask))
        self._send(Answer(ask.client, "stop", reply))
        self._audit.note(ask, reply, self._port.now_s())
        return True

    # the stepping thread -----------------------------------------------------------------------------------------
    def step(self, now_s: float) -> None:
        """Notice stops, leases that ran out, and how the run goes on."""
        self._notice(now_s)
        self._runs.poll(now_s)

    def handle(self, ask: Ask, stops: int, now_s: float) -> None:
        """Answer one request; `stops` is the count of stops when it came."""
        key, left = self._callers.meet(ask)
        self._helm.gone(left)
        self._notice(now_s)
        try:
            reply, later = self._answer(ask, key, stops, now_s)
        except RefusedError as refusal:
            reply, later = _error(refusal), [with_id(_error(more), ask.request.id) for more in refusal.more]
        except Exception as error:  # a fault of the robot's side must not take the link down
            reply, later = Error(code="internal", text=f"{type(error).__name__}: {error}"), []
        self._send(Answer(ask.client, "direct", with_id(reply, ask.request.id)))
        if ask.request.acts:
            self._audit.note(ask, reply, now_s)
        for follow in later:
            self._tell(key, follow)

    def _notice(self, now_s: float) -> None:
        """What happened since: a stop ends the run that it met (not one that is asked for after it), a lease ran out."""
        while self._stopped:
            self._runs.finish("cancelled", "stopped", f"{self._stopped.popleft()} stopped the robot")
        self._helm.expire(now_s)

    def gone(self, client: int) -> None:
        """A client is no more: his lease ends, unless his session has a newer connection."""
        self._helm.gone(self._callers.gone(client))

    def gateway_lost(self) -> None:
        """The gateway died: who has a named session may come back within his ttl, the others cannot."""
        for key in self._callers.all_gone():
            self._helm.gone(key)

    # answers -----------------------------------------------------------------------------------------------------
    def _answer(self, ask: Ask, key: Key, stops: int, now_s: float) -> tuple[AnyReply, Sequence[AnyReply]]:
        """The direct reply and what follows it at once. Raises: RefusedError."""
        request = ask.request
        match request:
            case requests.Command() | requests.Run():
                return self._act(ask, request, key, stops, now_s)
            case requests.Lease():
                return self._helm.answer(request, key, ask.name or ask.session or f"#{ask.client}", now_s), []
            case requests.MissionOp():
                return self._mission(ask, request, key, stops), []
            case requests.Log():
                return Ok(), inquiries.log(self._port, request)
        return self._simple(ask, key, now_s), []

    def _simple(self, ask: Ask, key: Key, now_s: float) -> AnyReply:
        request, port = ask.request, self._port
        match request:
            case requests.Get():
                return inquiries.newest(port, request.topic)
            case requests.ShowTree():
                return inquiries.tree(port, request.format)
            case requests.Why():
                return inquiries.why(port, request)
            case requests.ShowModules():
                return replies.Modules(state=port.modules())
            case requests.ModuleOp():
                port.module(request.name, request.op, source_of(ask))
            case requests.Params():
                return port.params(request, source_of(ask))
            case requests.SetTopic():
                port.set_topic(request.topic, request.fields, source_of(ask))
            case requests.Release():
                self._helm.require(key, now_s)
                port.release_estop(source_of(ask))
            case requests.Cancel():
                self._cancel(request.run, key, now_s, source_of(ask))
            case _:
                raise RefusedError("invalid", f"the executive does not answer {type(request).__name__}")
        return Ok()

    def _act(
        self, ask: Ask, request: requests.Command | requests.Run, key: Key, stops: int, now_s: float
    ) -> tuple[AnyReply, Sequence[AnyReply]]:
        """A command or a run: once for each id of a session, for the holder of the lease, if nothing forbids it."""
        known = self._outcomes.find(ask.key, request)
        if known is not None:
            return known.direct, known.later
        self._helm.require(key, now_s)
        self._require_movable(stops)
        state = self._port.mission_state().state
        if state in ("running", "stopping"):
            raise RefusedError("wrong-state", f'a mission is {state}; pause it first: <mission op="pause"/>')
        reply: AnyReply
        outcome = self._outcomes.begin(ask.key, request)
        try:
            if isinstance(request, requests.Run):
                reply = replies.Ack(id=request.id, run=self._runs.start(key, request, outcome, source_of(ask)))
            else:
                self._port.post_command(request.target, actuator(request, now_s), source_of(ask))
                reply = Ok(id=request.id)
        except BaseException:
            self._outcomes.forget(ask.key, request)  # nothing was done: the same id may be tried again
            raise
        outcome.add(reply)
        self._stop_again(stops, ask)
        return reply, []

    def _require_movable(self, stops: int) -> None:
        reason = self._port.estop_reason()
        if reason is not None:
            raise RefusedError("estopped", f'the robot is latched ({reason}); the holder of the lease sends <release what="estop"/>')
        if stops != self.stops:
            raise RefusedError("wrong-state", "a stop overtook this request; send it again if it is still meant")

    def _stop_again(self, stops: int, ask: Ask) -> None:
        """A stop that came while we acted may have been undone by what we did: say it again."""
        if stops != self.stops:
            self._port.stop(source_of(ask))

    def _end_run(self, key: Key, state: str, why: str) -> None:
        """The run of this key, if one goes on, ends with its lease."""
        if self._runs.active is not None and self._runs.active.key == key:
            self._runs.finish(state, state, why)

    def _cancel(self, run: str, key: Key, now_s: float, source: str) -> None:
        active = self._runs.active
        if active is None or active.run != run:
            raise RefusedError("wrong-state", f'run "{run}" is not going on; ' + (f'"{active.run}" is' if active else "none is"))
        if active.key != key:
            self._helm.require(key, now_s)
        self._runs.finish("cancelled", "cancelled", f"{source} cancelled the run")

    def _mission(self, ask: Ask, request: requests.MissionOp, key: Key, stops: int) -> AnyReply:
        port = self._port
        if request.op in _MOVES:
            self._require_movable(stops)
            self._helm.require_free_for(key)
        told = inquiries.mission(port, request)
        if told is not None:
            return told
        port.mission(request.op, request.name, request.text, source_of(ask), request.ports)
        if request.op in _MOVES:
            self._stop_again(stops, ask)
        return Ok()

    def _tell(self, key: Key, reply: AnyReply) -> None:
        client = self._callers.client_of(key)
        if client is not None:
            self._send(Answer(client, "later", reply))


def _error(refusal: RefusedError) -> Error:
    return Error(code=refusal.code, text=refusal.text, line=refusal.line, column=refusal.column)
