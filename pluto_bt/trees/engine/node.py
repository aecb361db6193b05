"""The base of every node of ours: a py_trees behaviour that is ticked by one method call, `step()`.

The life of a node (BehaviorTree.CPP 4.10, `TreeNode`):
    step()   does one tick, stores the status, returns it; SKIPPED is returned, never stored
    halt()   interrupts a RUNNING node: its children first, then itself; afterwards it is IDLE
A parent resets its children when it finishes: halts those that are RUNNING, first to last, and makes all of them IDLE.
`last` remembers what the node told its parent last, because a reset wipes `status`.
"""

from __future__ import annotations

import itertools
import uuid
from abc import abstractmethod
from collections.abc import Callable, Iterator
from typing import Any, ClassVar, Final, NoReturn

from py_trees.behaviour import Behaviour
from py_trees.common import BlackBoxLevel, Status
from py_trees.logging import Logger

from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.status import IDLE, RUNNING, SKIPPED, Result, Skip
from pluto_bt.trees.errors import StepError
from pluto_bt.trees.ports import PortModel, PortProblem

_LOGGER: Final = Logger("pluto_bt")
_COUNT: Final = itertools.count(1)


class Node(Behaviour):
    """A node of ours. It is built without py_trees' `__init__`, which makes a random id, a logger and a generator for each."""

    KIND: ClassVar[str] = "Action"
    PORTS: ClassVar[dict[str, PortModel]] = {}
    PORTS_ALONE: ClassVar[bool] = False  # of a leaf: its answer depends on its input ports alone
    PASSES_ON: ClassVar[bool] = False  # its answer depends on those of its children alone, and on its place among them if it
    KEEPS_PLACE: ClassVar[bool] = False  # goes on where it was in the last tick

    def __init__(self, name: str = "") -> None:
        self.name = name or type(self).__name__
        self.number = next(_COUNT)  # a mission numbers its nodes anew, so that they are the same in every run
        self.status: Status = IDLE
        self.last: Result = IDLE
        self.children: list[Any] = []
        self.parent: Behaviour | None = None
        self.feedback_message = ""
        self.blackboards = []
        self.blackbox_level = BlackBoxLevel.NOT_A_BLACKBOX
        self.logger = _LOGGER
        self.context = Context()
        self.readers: dict[str, Callable[[], Any]] = {}
        self.writers: dict[str, Callable[[Any], None]] = {}

    @abstractmethod
    def step(self) -> Result:
        """One tick. Subclasses do all their work here."""

    def halt(self) -> None:
        """Interrupt a RUNNING node; here, of one that has nothing to let go."""
        self.status = IDLE

    def skip(self) -> Skip:
        """Tell the parent SKIPPED; the stored status stays what it was."""
        self.last = SKIPPED
        self.context.skipped.append(self)
        return SKIPPED

    def read(self, port: str) -> Any:
        """The value of an input port. Raises StepError if there is none or it does not fit."""
        reader = self.readers.get(port)
        if reader is None:
            self.fail(f"port {port!r} is missing")
        try:
            return reader()
        except PortProblem as problem:
            self.fail(str(problem))

    def write(self, port: str, value: Any) -> None:
        """Write an output port; one that the mission does not connect is passed over."""
        writer = self.writers.get(port)
        if writer is not None:
            try:
                writer(value)
            except PortProblem as problem:
                self.fail(str(problem))

    def fail(self, reason: str) -> NoReturn:
        """End the tick with an error of this node."""
        raise StepError(self, reason)

    # -- py_trees' side: display, visitors and trees work on our nodes

    def update(self) -> Status:
        """py_trees' hook; ours is `step`."""
        result = self.step()
        return result if isinstance(result, Status) else IDLE

    def tick(self) -> Iterator[Behaviour]:
        """Step, then yield the nodes that were visited, children before parents, as py_trees does."""
        visited: list[Behaviour] = []
        may_remember, self.context.may_remember = self.context.may_remember, False  # who looks on wants to see each node
        recorded = [(node, node.__dict__.get("step")) for node in self.iterate()]
        for node, _ in recorded:
            node.__dict__["step"] = _recording(node, getattr(node, "step"), visited)  # noqa: B009  a leaf gets `step` when it is bound
        try:
            self.step()
        finally:
            self.context.may_remember = may_remember
            for node, own in recorded:
                if own is None:
                    del node.__dict__["step"]
                else:
                    node.__dict__["step"] = own
        yield from visited

    def stop(self, new_status: Status) -> None:
        """py_trees' interruption: halt if RUNNING, then take the status."""
        if self.status is RUNNING:
            self.halt()
        self.status = new_status

    @property
    def id(self) -> uuid.UUID:  # type: ignore[override]  # py_trees assigns a random one
        """The number of the node as py_trees wants it."""
        return uuid.UUID(int=self.number)

    @property
    def iterator(self) -> Iterator[Behaviour]:  # type: ignore[override]  # py_trees assigns it, we never do
        """py_trees keeps a generator here."""
        return self.tick()

    @property
    def qualified_name(self) -> str:  # type: ignore[override]  # as above
        """`Type/name`, as py_trees shows it."""
        return f"{type(self).__name__}/{self.name}"


def _recording(node: Behaviour, step: Callable[[], Result], visited: list[Behaviour]) -> Callable[[], Result]:
    def recorded() -> Result:
        result = step()
        visited.append(node)
        return result

    return recorded


def reset(child: Any) -> None:
    """Halt `child` if it is RUNNING and make it IDLE (`haltChild` of BehaviorTree.CPP)."""
    status = child.status
    if status is IDLE:
        return
    if status is RUNNING:
        child.halt()
        if child.last is not SKIPPED:  # a node that was skipped in the middle of its work stores RUNNING still
            child.last = RUNNING
    else:
        child.last = status
    child.status = IDLE


def start(node: Node) -> None:
    """What most nodes do first in a step: they are RUNNING from here on."""
    if node.status is not RUNNING:
        node.status = RUNNING
        node.last = IDLE


class ControlNode(Node):
    """A node with one child or more."""

    KIND = "Control"
    CHILDREN: ClassVar[tuple[int, int | None]] = (1, None)  # fewest and most, as found while ticking

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name)
        for child in children or ():
            self.add_child(child)

    def add_child(self, child: Behaviour) -> None:
        """Append a child."""
        self.children.append(child)
        child.parent = self

    def halt(self) -> None:
        """Halt the running children and forget the place."""
        self.forget()
        self.reset_children()
        self.status = IDLE

    def forget(self) -> None:
        """Drop what the node remembers between ticks."""

    def reset_children(self) -> None:
        """Halt the running ones, first to last, and make all IDLE."""
        for child in self.children:
            status = child.status
            if status is RUNNING:
                reset(child)
            elif status is not IDLE:  # as `reset` does; written out, as this is where a tick spends its time
                child.last = status
                child.status = IDLE


class DecoratorNode(Node):
    """A node with exactly one child."""

    KIND = "Decorator"

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name)
        self.child: Any = None
        if child is not None:
            self.add_child(child)

    def add_child(self, child: Behaviour) -> None:
        """Take the one child."""
        if self.child is not None:
            raise ValueError(f"decorator {self.name!r} has a child already")
        self.child = child
        self.children.append(child)
        child.parent = self

    def end_as(self, answer: Result, port: str) -> Result:
        """End without the child, with the status that a port names."""
        if answer is SKIPPED:
            return self.skip()
        if answer is IDLE:
            self.fail(f"{port} is IDLE, which no node may answer")
        self.status = answer
        return answer

    def pass_on(self) -> Result:
        """Step the child and answer as it does; a child that has ended is then IDLE again."""
        result: Result = self.child.step()
        if result is SKIPPED:
            return self.skip()
        if result is not RUNNING:
            reset(self.child)
        self.status = result
        return result

    def halt(self) -> None:
        """Halt the child if it runs."""
        self.forget()
        reset(self.child)
        self.status = IDLE

    def forget(self) -> None:
        """Drop what the node remembers between ticks."""
