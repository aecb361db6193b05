"""What the adapters of the chain share: taking letters, telling the accepted command and the status, and how a link stops."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from pluto_bt.blackboard import Publisher
from pluto_bt.blackboard.codes import MotionCommand
from pluto_bt.blackboard.inbox import Letter
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.modules.context import Context

RELEASE = int(MotionCommand.RELEASE)


def newest(context: Context, topic: str) -> Callable[[], Any]:
    """A fast way to ask for the newest value of a topic, None without one."""
    return cast(Callable[[], Any], context.board.value_reader(topic))


class Link:
    """One link of the chain: its inbox, its two topics, and whether its thread runs (in the manual's sense).

    A stopped link shows -10, drops commands, and still passes every stop down. `start` makes it run again, without a command.
    """

    def __init__(self, context: Context, name: str, topic: str) -> None:
        self.name = name
        self.is_running = False
        self._context = context
        self._inbox = context.inboxes[name]
        self._command: Publisher = context.board.publisher(f"{topic}/command", name)
        self._status: Publisher = context.board.publisher(f"{topic}/status", name)

    def start(self) -> None:
        """Run. What was posted before is out of date."""
        letter = self._inbox.take()
        if letter is not None and letter.is_stop:
            self._inbox.stop(letter.source, letter.command.stamp_s)
        self.is_running = True

    def letter(self) -> Letter | None:
        """What was posted since the last step."""
        return self._inbox.take()

    def tell(self, now_s: float, status: FVectorState, accepted: ActuatorState | None = None) -> None:
        """Publish the status, then the command just accepted: who sees the new command finds its status there already."""
        self._status.put(status, now_s)
        if accepted is not None:
            self._command.put(accepted, now_s)

    def release(self) -> None:
        """The command -1: stop this link's own module, as an operator would."""
        self.is_running = False
        self._context.order_module(self.name, False)


def below(context: Context, topic: str) -> tuple[Callable[[], FVectorState | None], Callable[[], ActuatorState | None]]:
    """Readers of the lower link's status and accepted command."""
    return newest(context, f"{topic}/status"), newest(context, f"{topic}/command")
