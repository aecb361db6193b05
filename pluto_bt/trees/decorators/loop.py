"""LoopInt, LoopBool, LoopDouble, LoopString: the child once for each element of a queue."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import Any, ClassVar

from pluto_bt.trees.engine.node import DecoratorNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import MissingValue
from pluto_bt.trees.values import BOOL, DOUBLE, INT, STATUS, STRING, Kind, PortProblem, queue_of, split_list


class Loop(DecoratorNode):
    """Pops one element per run of the child into `value`; RUNNING after each, so the tick after the last answers `if_empty`.

    A queue that another node put on the blackboard is shared: elements that are popped are gone for all. A list or a text there, or a
    literal, begins anew with each activation.
    """

    ITEM: ClassVar[Kind]

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.working = False
        self.queue: deque[Any] = deque()

    def step(self) -> Result:
        if self.status is IDLE:
            self.working = False
            self.queue = self._queue(fresh=True)
        if not self.working:
            self.queue = self._queue(fresh=False)
            if not self.queue:
                return self.end_as(self.read("if_empty"), "if_empty")
            self.write("value", self.queue.popleft())
        if self.status is not RUNNING:
            self.status = RUNNING
            self.last = IDLE
        result: Result = self.child.step()
        self.working = result is RUNNING
        if result is FAILURE:
            reset(self.child)
            self.status = FAILURE
            return FAILURE
        if result is SUCCESS:
            reset(self.child)
        return RUNNING

    def _queue(self, fresh: bool) -> deque[Any]:
        """The queue to pop from: the shared one, or a copy that lasts for this activation."""
        reader = self.readers.get("queue")
        if reader is None:
            self.fail("port 'queue' is missing")
        try:
            value = reader()
        except MissingValue:
            return deque()
        if getattr(reader, "literal", False) or not isinstance(value, deque):
            return self._copy(value) if fresh else self.queue
        return value

    def _copy(self, value: Any) -> deque[Any]:
        try:
            if isinstance(value, str):
                return deque(split_list(self.ITEM, value))
            if isinstance(value, Iterable):
                return deque(self.ITEM.convert(item) for item in value)
            raise ValueError(f"it holds no list but a {type(value).__name__}")
        except (ValueError, PortProblem) as error:
            self.fail(f"port 'queue': {error}")

    def forget(self) -> None:
        self.working = False


def _loop(name: str, item: Kind) -> type[Loop]:
    ports = {
        "queue": PortModel("queue", "inout", queue_of(item), at_load=True, description="elements with ';' between, or {key} of a queue"),
        "if_empty": PortModel("if_empty", kind=STATUS, default="SUCCESS", description="the answer when the queue is empty"),
        "value": PortModel("value", "out", item, required=False, description="takes each element in turn"),
    }
    return type(name, (Loop,), {"ITEM": item, "PORTS": ports, "__module__": __name__, "__doc__": Loop.__doc__})


LoopInt, LoopBool = _loop("LoopInt", INT), _loop("LoopBool", BOOL)
LoopDouble, LoopString = _loop("LoopDouble", DOUBLE), _loop("LoopString", STRING)
