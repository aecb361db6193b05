"""What the gateway asks of the robot. The executive gives it an object of this shape; the gateway knows nothing else of him."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Literal, NamedTuple, Protocol

import msgspec

from pluto_bt.blackboard.messages import ActuatorState, Event, Message, MissionState, ModulesState
from pluto_bt.gateway.replies import Cause, Item, ParamsState
from pluto_bt.gateway.requests import Params
from pluto_bt.source import PlutoError

MOST_TEXT = 2000
NO_PORTS: Mapping[str, str] = MappingProxyType({})
OnLoss = Literal["stop", "pause", "continue"]


class RefusedError(PlutoError):
    """A request that is understood and not granted. `code` is one of the codes of PROTOCOL.md that are not fatal.

    `line` and `column` are those of a document that came with the request, 0 without one; `more` holds its further faults. A text that quotes
    a word of kilobytes is cut short: what a client sends must not come back to fill our buffers.
    """

    def __init__(self, code: str, text: str, line: int = 0, column: int = 0, more: Sequence[RefusedError] = ()) -> None:
        super().__init__(text)
        self.code = code
        self.text = text if len(text) <= MOST_TEXT else text[: MOST_TEXT - 1] + "…"
        self.line = line
        self.column = column
        self.more = tuple(more)


class Newest(NamedTuple):
    """A topic's newest value, its sequence number, and the run's time at which it was written."""

    value: Message
    seq: int
    written_s: float


class RunState(msgspec.Struct, frozen=True):
    """How a run stands: `running`, or one of succeeded, failed, cancelled, preempted, timeout with the reason and the output ports."""

    state: str = "running"
    reason: str = ""
    text: str = ""
    outputs: tuple[tuple[str, str], ...] = ()


class RobotPort(Protocol):
    """The robot as the gateway sees it.

    `stop` and `estop` are called from the link's own thread, at any moment: they must be thread-safe and return at once. `prepare_mission` may
    be called from a thread of its own. All other methods are called inside `GatewayLink.step`. `source` names the client for logs. Methods
    that can say no raise `RefusedError`.
    """

    @property
    def name(self) -> str:
        """The robot's name."""

    def now_s(self) -> float:
        """Seconds of the run's clock."""

    def step(self, now_s: float) -> None:
        """Called each time before requests are answered: what time alone does."""

    def topics(self) -> Sequence[str]:
        """Names of the topics that this run has."""

    def newest(self, topic: str) -> Newest | None:
        """The newest value of a topic, None before the first."""

    def events_after(self, seq: int) -> Sequence[tuple[int, Event]]:
        """Events with a sequence number above `seq`, oldest first."""

    def stop(self, source: str) -> None:
        """Zero velocity at once; a running mission pauses. Thread-safe."""

    def estop(self, source: str, reason: str) -> None:
        """As stop, latched until released. Thread-safe."""

    def release_estop(self, source: str) -> None:
        """Unlatch; nothing moves by that."""

    def estop_reason(self) -> str | None:
        """Why the robot is latched, None if it is not."""

    def post_command(self, target: str, command: ActuatorState, source: str) -> None:
        """Give a command to a link of the chain (`motion`, `avoidance`, `drive`) or to the `wrist`. Raises: RefusedError."""

    def run_node(self, node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        """Start one node or library tree; the run's id. Deadline 0 = none. A run that goes on is preempted by it. Raises: RefusedError."""

    def run_state(self, run: str) -> RunState:
        """How a run that `run_node` started stands."""

    def cancel(self, run: str, reason: str) -> None:
        """End a run with zero velocity; harmless if it is over."""

    def mission_state(self) -> MissionState:
        """The mission; state `idle` if there is none. A run of `run_node` is no mission."""

    def mission_names(self) -> Sequence[str]:
        """Missions that can be loaded by name."""

    def mission(self, op: str, name: str, text: str, source: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Do `load`, `check` (both with these inputs), `start`, `pause`, `resume` or `abort`. Raises: RefusedError with every fault of a document."""

    def prepare_mission(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Read the document of a `load` or `check`, which takes long, so that `mission` with the same words is quick. Thread-safe; never raises."""

    def mission_text(self, name: str) -> str:
        """The document of the mission of that name, of the one at work if it is "". Raises: RefusedError."""

    def tree_text(self, format: str) -> str:
        """The tree drawn as `ascii` or `dot`; "" if there is none."""

    def why(self, at_s: float | None) -> tuple[bool, Sequence[Cause]]:
        """Whether the robot moves, and the chain of causes, the first cause first. Raises: RefusedError for a time that is not known (any more)."""

    def modules(self) -> ModulesState:
        """Every module of the run."""

    def module(self, name: str, op: str, source: str) -> None:
        """Start or stop a module. Raises: RefusedError."""

    def params(self, request: Params, source: str) -> ParamsState:
        """Get, set, take back or save parameters. Raises: RefusedError with everything that is wrong."""

    def set_topic(self, topic: str, fields: Mapping[str, str], source: str) -> None:
        """Write a topic that belongs to the gateway. Raises: RefusedError."""

    def catalogue(self) -> Sequence[Item]:
        """What there is besides topics: items of the kinds `node`, `param`, `module` and `goal`; the same through the whole run."""
