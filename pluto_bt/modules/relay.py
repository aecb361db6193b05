"""What the small sensor adapters share: read the device, turn each good record into its message, publish; say once when readings are bad."""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite
from typing import Generic, TypeVar

from drivers.records import Record
from pluto_bt.blackboard.messages import Message
from pluto_bt.modules.context import Context

R = TypeVar("R", bound=Record)


class Relay(Generic[R]):
    """One device, one kind of record, one topic. A record whose `check` is not finite is dropped, so that its topic grows stale."""

    def __init__(
        self, context: Context, module: str, topic: str, kind: type[R], check: Callable[[R], float], message: Callable[[R], Message]
    ) -> None:
        self._device = context.devices[module]
        self._say = context.say
        self._module = module
        self._publisher = context.board.publisher(topic, module)
        self._kind, self._check, self._message = kind, check, message
        self._is_sane = True

    def start(self, now_s: float) -> None:
        """Nothing to get ready."""

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """Publish each record that has arrived."""
        for record in self.read():
            self._publisher.put(self._message(record), now_s)

    def read(self) -> list[R]:
        """The good records since the last call."""
        arrived = self._device.read()
        if not arrived:
            return []
        records: list[R] = []
        for record in arrived:
            if isinstance(record, self._kind):
                is_sane = isfinite(self._check(record))
                if is_sane:
                    records.append(record)
                elif self._is_sane:
                    self._say("error", f"bad-{self._module}", self._module, f"{self._module} delivers what is not a number: dropped")
                self._is_sane = is_sane
        return records
