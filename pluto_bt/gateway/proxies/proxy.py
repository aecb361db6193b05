"""What every proxy does: find the module or start it, read its topics as messages, start and stop its thread."""

from __future__ import annotations

from collections.abc import Iterable
from types import TracebackType
from typing import ClassVar, Self, TypeVar

from pluto_bt.blackboard.messages import Message
from pluto_bt.blackboard.topics import LATER_WRITERS
from pluto_bt.gateway.client import Client, Element
from pluto_bt.gateway.errors import BadRequestError, NoAnswerError, WrongStateError
from pluto_bt.gateway.read_values import message_of

M = TypeVar("M", bound=Message)


class Proxy:
    """Methods in place of messages. A proxy starts the module it needs if it is not running, as the manual says.

    Whatever moves the robot needs the lease: call it inside `with proxy.client.driving():`, while no mission runs.
    """

    MODULE: ClassVar[str]

    def __init__(self, client: Client | None = None) -> None:
        """Without a client, one of its own to the gateway on this machine. Raises: GatewayError, also if this robot has no such module."""
        self._is_own = client is None
        self.client = Client(name=type(self).__name__) if client is None else client
        try:
            if not self.is_running:
                self.start_activity()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the client, if it is our own."""
        if self._is_own:
            self.client.close()

    @property
    def is_running(self) -> bool:
        """The module's thread runs."""
        return self._states()[self.MODULE] == "running"

    def start_activity(self) -> None:
        """Start the module's thread, after all that it needs; back when it runs. Starting twice is harmless."""
        self.client.request("module", name=self.MODULE, op="start")
        self._wait_for("running", [self.MODULE])

    def stop_activity(self) -> None:
        """Stop the module's thread; back when it stands. The module stays listed."""
        self.client.request("module", name=self.MODULE, op="stop")
        self._wait_for("stopped", [self.MODULE])

    def _newest(self, topic: str, kind: type[M]) -> M:
        """The newest value. Raises: GatewayError, `no-value` before the first."""
        message = message_of(kind, self.client.request("get", topic=topic))
        assert isinstance(message, kind)
        return message

    def _states(self) -> dict[str, str]:
        """Module → state. Raises: BadRequestError if ours is not among them."""
        rows: Iterable[Element] = self.client.request("modules").findall("module")
        states = {row.get("name", ""): row.get("state", "") for row in rows}
        if self.MODULE not in states:
            later = "it is not there yet and comes with a later version" if self.MODULE in LATER_WRITERS else f"it has {', '.join(states)}"
            raise BadRequestError("unknown-module", f'this robot has no module "{self.MODULE}": {later}')
        return states

    def _wait_for(self, state: str, modules: Iterable[str]) -> None:
        """Ask until all the modules that this robot has are in that state; each answer takes the gateway a step."""
        until_s = self.client.now_s() + self.client.timeout_s
        while True:
            states = self._states()
            others = {name: states[name] for name in modules if name in states and states[name] != state}
            if not others:
                return
            shown = ", ".join(f"{name} is {found}" for name, found in others.items())
            if "failed" in others.values():
                raise WrongStateError("wrong-state", f"expected {state}, found that {shown}")
            if self.client.now_s() >= until_s:
                raise NoAnswerError("no-answer", f"{shown} after {self.client.timeout_s:g} s, expected {state}")
