"""The executive's end of the wire, whatever carries it: requests in, answers and latest values out."""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable
from functools import partial

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.aside import Work
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.desk import Desk
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.port import RobotPort
from pluto_bt.gateway.replies import Error
from pluto_bt.gateway.requests import MissionOp
from pluto_bt.gateway.turns import Turns
from pluto_bt.gateway.wire import Answer, Ask, Batch, Down, Gone, Refused, Scenery, Stamped, Up, Watch, Welcome, pack_value

REQUESTS_A_STEP, ANSWERS_A_STEP, STEP_S = 64, 256, 0.005
"""So much is answered in one step, and for so long; a request that has begun is answered to its end."""
QUEUE, QUEUE_MISSIONS = 16 * 1024, 4
"""So many requests may wait, and no more bytes than so many of the longest missions have: who hung up leaves nothing heavy behind."""
HEARTBEAT_S = 0.25
_EVENTS = "events"


class Exchange:
    """Joins the desk to a carrier. `receive` is thread-safe and does stops at once; `step` does everything else."""

    def __init__(
        self, port: RobotPort, send: Callable[[Down], None], audit: Audit | None = None, aside: Callable[[Work], None] = lambda work: work()
    ) -> None:
        """`send` must be thread-safe and never block. `aside` does work that takes long: at once, or in a thread that does one after the other."""
        self._port = port
        self._send = send
        self._audit = audit or Audit(None)
        self._answers = 0  # in this step
        self._desk = Desk(port, self._answer, self._audit)
        self._inbox: deque[tuple[Up, int]] = deque()  # the one thing that both threads touch
        self._came_bytes = self._taken_bytes = 0  # in the inbox and out of it; each is written by one thread alone
        self._most_bytes = QUEUE_MISSIONS * Limits().mission_bytes
        self._queue = Turns()
        self._aside = aside
        self._prepared: deque[tuple[int, Ask, int]] = deque()
        self._watched: tuple[str, ...] = ()
        self._sent_seq: dict[str, int] = {}
        self._event_seq = 0
        self._batch_s = float("-inf")

    def welcome(self, access: Access, limits: Limits, first_client: int, scenery: Scenery | None = None) -> Welcome:
        """The first frame for a gateway; what it is sent begins anew."""
        self._forget_all()
        self._sent_seq.clear()
        self._most_bytes = QUEUE_MISSIONS * limits.mission_bytes
        seen = self._port.events_after(0)
        self._event_seq = seen[-1][0] if seen else 0
        port = self._port
        known = (port.name, port.now_s(), tuple(port.topics()), access, limits, first_client, tuple(port.catalogue()))
        return Welcome(*known, scenery)

    def receive(self, frame: Up) -> None:
        """A frame of the gateway, in whatever thread it arrives."""
        if isinstance(frame, Refused):
            self._audit.note_refused(frame, self._port.now_s())
            return
        if isinstance(frame, Ask):
            if self._desk.urgent(frame):
                return
            waiting_bytes = self._came_bytes - self._taken_bytes + self._queue.size_bytes
            if len(self._inbox) > QUEUE or waiting_bytes + frame.size_bytes > self._most_bytes:
                text = "too much waits for the executive; a stop is still obeyed"
                reply = Error(id=frame.request.id, code="busy", text=text)
                self._send(Answer(frame.client, "direct", reply))
                if frame.request.acts:
                    self._audit.note(frame, reply, self._port.now_s())
                return
            self._came_bytes += frame.size_bytes
        self._inbox.append((frame, self._desk.stops))

    def step(self, now_s: float, has_room: Callable[[], bool] = lambda: True) -> None:
        """Send what changed, answer some of what came, both as long as the carrier has room; then look after leases and runs."""
        self._port.step(now_s)
        if has_room():
            self._publish(now_s)
        while self._inbox and len(self._queue) < QUEUE:
            item = self._inbox.popleft()
            self._queue.add(item)
            self._taken_bytes += item[0].size_bytes if isinstance(item[0], Ask) else 0
        self._answers, until_s = 0, self._port.now_s() + STEP_S
        self._answer_prepared(now_s)
        for _ in range(REQUESTS_A_STEP):
            if not self._queue.is_ready or not has_room() or self._answers > ANSWERS_A_STEP or self._port.now_s() > until_s:
                break  # answers that nobody takes must not pile up here, nor the rest of the step wait
            self._handle(*self._queue.next(), now_s)
        if self._answers and has_room():
            self._publish(now_s, is_due=True)  # no older than the answers, so that whoever asks next is answered by the gateway itself
        self._desk.step(now_s)
        self._audit.step(now_s)

    def _handle(self, frame: Up, stops: int, now_s: float) -> None:
        if isinstance(frame, Ask) and isinstance(frame.request, MissionOp) and frame.request.op in ("load", "check"):
            self._aside(partial(self._prepare, self._queue.hold(frame), frame, frame.request, stops))
            self._answer_prepared(now_s)
        elif isinstance(frame, Ask):
            self._desk.handle(frame, stops, now_s)
        elif isinstance(frame, Gone):
            self._desk.gone(frame.client)
        elif isinstance(frame, Watch):
            self._watch(frame.topics)

    def _prepare(self, hold: int, ask: Ask, request: MissionOp, stops: int) -> None:
        """Read a document, in whatever thread, if anybody still wants it."""
        if self._queue.is_wanted(hold, ask):
            with contextlib.suppress(Exception):  # it is raised again where the request is answered
                self._port.prepare_mission(request.op, request.name, request.text, request.ports)
        self._prepared.append((hold, ask, stops))

    def _answer_prepared(self, now_s: float) -> None:
        """What has been read is answered, and who asked for it has his turns again."""
        while self._prepared:
            hold, ask, stops = self._prepared.popleft()
            is_wanted = self._queue.is_wanted(hold, ask)
            self._queue.free(hold)
            if is_wanted:  # else the gateway through which he asked is no more, or he himself
                self._desk.handle(ask, stops, now_s)

    def _answer(self, answer: Answer) -> None:
        self._answers += 1
        self._send(answer)

    def gateway_lost(self) -> None:
        """The gateway died."""
        self._forget_all()
        self._desk.gateway_lost()
        self._audit.step(self._port.now_s())

    def end(self) -> None:
        """The robot's software ends, and the gateway with it."""
        self.gateway_lost()
        self._audit.end(self._port.now_s())

    def _forget_all(self) -> None:
        """Nobody waits, nobody watches. Only while nothing is received."""
        self._queue.clear()
        self._inbox.clear()
        self._came_bytes = self._taken_bytes = 0
        self._watched = ()

    def _watch(self, topics: tuple[str, ...]) -> None:
        self._watched = topics
        self._sent_seq = {topic: seq for topic, seq in self._sent_seq.items() if topic in topics}

    def _publish(self, now_s: float, *, is_due: bool = False) -> None:
        values = []
        for topic in self._watched:
            newest = self._port.newest(topic) if topic != _EVENTS else None
            if newest is not None and newest.seq != self._sent_seq.get(topic):
                self._sent_seq[topic] = newest.seq
                values.append(Stamped(topic, newest.seq, newest.written_s, pack_value(newest.value)))
        events = tuple(self._port.events_after(self._event_seq)) if _EVENTS in self._watched else ()
        if events:
            self._event_seq = events[-1][0]
        if values or events or is_due or now_s - self._batch_s >= HEARTBEAT_S:
            self._batch_s = now_s
            self._send(Batch(now_s, tuple(values), events))

