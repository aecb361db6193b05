"""A gateway without a robot behind it, in a process of its own: one topic is written, and nothing moves. For the gateway's benchmarks.

`python -m pluto_bt.bench.silent_robot HZ CLIENTS` prints the port and the number of the gateway's process, and serves until its input ends.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Mapping, Sequence
from typing import NoReturn

from pluto_bt.blackboard.messages import ActuatorState, Event, Flag, MissionState, ModulesState
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.link import GatewayLink
from pluto_bt.gateway.listen import Address
from pluto_bt.gateway.port import NO_PORTS, Newest, RefusedError, RunState
from pluto_bt.gateway.replies import Cause, Item, ParamsState
from pluto_bt.gateway.requests import Params
from pluto_bt.runtime.clock import NS, wait, wall_ns

TOPIC = "operator/word"
LINE_BYTES = 300
MARK = "T="


class SilentRobot:
    """Implements `RobotPort`; all that it can do is to show a word, and to hear stops."""

    name = "silent"

    def __init__(self) -> None:
        self._begun_ns = wall_ns()
        self._seq = 0
        self._newest: Newest | None = None
        self.stops = 0

    def write(self) -> None:
        """A new word: the moment it is written, padded so that its line has some 300 bytes."""
        self._seq += 1
        text = f"{MARK}{wall_ns():019d}".ljust(LINE_BYTES - 110, ".")
        self._newest = Newest(Flag(self.now_s(), text), self._seq, self.now_s())

    def now_s(self) -> float:
        """Seconds since the start."""
        return (wall_ns() - self._begun_ns) / NS

    def step(self, now_s: float) -> None:
        """Nothing is due."""

    def topics(self) -> Sequence[str]:
        """The one topic."""
        return (TOPIC,)

    def newest(self, topic: str) -> Newest | None:
        """The word."""
        return self._newest

    def events_after(self, seq: int) -> Sequence[tuple[int, Event]]:
        """None."""
        return ()

    def stop(self, source: str) -> None:
        """Counted."""
        self.stops += 1

    def estop(self, source: str, reason: str) -> None:
        """Counted."""
        self.stops += 1

    def release_estop(self, source: str) -> None:
        """Nothing is latched."""

    def estop_reason(self) -> str | None:
        """Never."""
        return None

    def post_command(self, target: str, command: ActuatorState, source: str) -> None:
        """Refused."""
        self._refuse()

    def run_node(self, node: str, ports: Mapping[str, str], deadline_s: float, source: str) -> str:
        """Refused."""
        self._refuse()

    def run_state(self, run: str) -> RunState:
        """There is none."""
        return RunState("cancelled")

    def cancel(self, run: str, reason: str) -> None:
        """There is none."""

    def mission_state(self) -> MissionState:
        """Idle."""
        return MissionState(self.now_s())

    def mission_names(self) -> Sequence[str]:
        """None."""
        return ()

    def mission(self, op: str, name: str, text: str, source: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Refused."""
        self._refuse()

    def prepare_mission(self, op: str, name: str, text: str, ports: Mapping[str, str] = NO_PORTS) -> None:
        """Nothing to read."""

    def mission_text(self, name: str) -> str:
        """Refused."""
        self._refuse()

    def tree_text(self, format: str) -> str:
        """No tree."""
        return ""

    def why(self, at_s: float | None) -> tuple[bool, Sequence[Cause]]:
        """It never moves."""
        return False, ()

    def modules(self) -> ModulesState:
        """None."""
        return ModulesState(self.now_s())

    def module(self, name: str, op: str, source: str) -> None:
        """Refused."""
        self._refuse()

    def params(self, request: Params, source: str) -> ParamsState:
        """None."""
        return ParamsState(rev=1)

    def set_topic(self, topic: str, fields: Mapping[str, str], source: str) -> None:
        """Refused."""
        self._refuse()

    def catalogue(self) -> Sequence[Item]:
        """Nothing."""
        return ()

    def _refuse(self) -> NoReturn:
        raise RefusedError("wrong-state", "there is no robot here")


def main() -> None:
    """Serve until the input ends."""
    hz, clients = float(sys.argv[1]), int(sys.argv[2])
    robot = SilentRobot()
    link = GatewayLink(robot, Address("127.0.0.1", 0), limits=Limits(clients=clients, messages_per_s=1e9, outstanding=1 << 20))
    link.start(robot.now_s())
    assert link.address is not None
    print(link.address.port, link.pid, flush=True)
    over = threading.Event()

    def until_the_end() -> None:
        sys.stdin.read()
        over.set()

    threading.Thread(target=until_the_end, daemon=True).start()
    due_ns = wall_ns()
    while not over.is_set():
        due_ns = max(due_ns + round(NS / hz), wall_ns())
        wait(over, (due_ns - wall_ns()) / NS)
        robot.write()
        link.step(robot.now_s())
    link.stop()


if __name__ == "__main__":
    main()
