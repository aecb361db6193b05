"""The executive's end of the wire, whatever carries it: requests in, answers and latest values out."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from pluto_bt.gateway.access import Access
from pluto_bt.gateway.audit import Audit
from pluto_bt.gateway.desk import Desk
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.port import RobotPort
from pluto_bt.gateway.replies import Error
from pluto_bt.gateway.requests import Get, Log, ShowModules, ShowTree, Why
from pluto_bt.gateway.wire import Answer, Ask, Batch, Down, Gone, Scenery, Stamped, Up, Watch, Welcome, pack_value

REQUESTS_A_STEP = 64
QUEUE = 16 * 1024
HEARTBEAT_S = 0.25
_EVENTS = "events"


class Exchange:
    """Joins the desk to a carrier. `receive` is thread-safe and does stops at once; `step` does everything else."""

    def __init__(self, port: RobotPort, send: Callable[[Down], None], audit: Audit | None = None) -> None:
        """`send` must be thread-safe and never block."""
        self._port = port
        self._send = send
        self._audit = audit or Audit(None)
        self._desk = Desk(port, send, self._audit)
        self._inbox: deque[tuple[Up, int]] = deque()  # the one thing that both threads touch
        self._queue: deque[tuple[Up, int]] = deque()
        self._watched: tuple[str, ...] = ()
        self._sent_seq: dict[str, int] = {}
        self._event_seq = 0
        self._batch_s = float("-inf")

    def welcome(self, access: Access, limits: Limits, first_client: int, scenery: Scenery | None = None) -> Welcome:
        """The first frame for a gateway; what it is sent begins anew."""
        self._queue.clear()
        self._inbox.clear()
        self._watched = ()
        self._sent_seq.clear()
        seen = self._port.events_after(0)
        self._event_seq = seen[-1][0] if seen else 0
        port = self._port
        known = (port.name, port.now_s(), tuple(port.topics()), access, limits, first_client, tuple(port.catalogue()))
        return Welcome(*known, scenery)

    def receive(self, frame: Up) -> None:
        """A frame of the gateway, in whatever thread it arrives."""
        if isinstance(frame, Ask):
            if self._desk.urgent(frame):
                return
            if len(self._inbox) > QUEUE:
                text = "the executive does not answer; a stop is still obeyed"
                self._send(Answer(frame.client, "direct", Error(id=frame.request.id, code="busy", text=text)))
                return
        self._inbox.append((frame, self._desk.stops))

    def step(self, now_s: float, has_room: Callable[[], bool] = lambda: True) -> None:
        """Send what changed, answer some of what came, both as long as the carrier has room; then look after leases and runs."""
        self._port.step(now_s)
        if has_room():
            self._publish(now_s)
        self._take_in()
        for _ in range(min(len(self._queue), REQUESTS_A_STEP)):
            if not has_room():  # answers that nobody takes must not pile up here
                break
            frame, stops = self._queue.popleft()
            if isinstance(frame, Ask):
                self._desk.handle(frame, stops, now_s)
            elif isinstance(frame, Gone):
                self._desk.gone(frame.client)
            elif isinstance(frame, Watch):
                self._watch(frame.topics)
        self._desk.step(now_s)
        self._audit.step()

    def _take_in(self) -> None:
        """Line up what the carrier's thread brought, without the inquiries of clients who are gone: nobody hears the answers."""
        gone = set()
        for _ in range(min(len(self._inbox), QUEUE - len(self._queue))):
            item = self._inbox.popleft()
            self._queue.append(item)
            if isinstance(item[0], Gone):
                gone.add(item[0].client)
        if gone:
            self._queue = deque(item for item in self._queue if not _is_inquiry_of(gone, item[0]))

    def gateway_lost(self) -> None:
        """The gateway died."""
        self._queue.clear()
        self._inbox.clear()
        self._watched = ()
        self._desk.gateway_lost()
        self._audit.step()

    def _watch(self, topics: tuple[str, ...]) -> None:
        self._watched = topics
        self._sent_seq = {topic: seq for topic, seq in self._sent_seq.items() if topic in topics}

    def _publish(self, now_s: float) -> None:
        values = []
        for topic in self._watched:
            newest = self._port.newest(topic) if topic != _EVENTS else None
            if newest is not None and newest.seq != self._sent_seq.get(topic):
                self._sent_seq[topic] = newest.seq
                values.append(Stamped(topic, newest.seq, newest.written_s, pack_value(newest.value)))
        events = tuple(self._port.events_after(self._event_seq)) if _EVENTS in self._watched else ()
        if events:
            self._event_seq = events[-1][0]
        if values or events or now_s - self._batch_s >= HEARTBEAT_S:
            self._batch_s = now_s
            self._send(Batch(now_s, tuple(values), events))


def _is_inquiry_of(clients: set[int], frame: Up) -> bool:
    return isinstance(frame, Ask) and frame.client in clients and isinstance(frame.request, Get | ShowTree | ShowModules | Log | Why)
