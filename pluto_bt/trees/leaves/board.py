"""SetBlackboard, UnsetBlackboard, WasEntryUpdated."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.trees.decorators.updated import UpdateWatch
from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.status import FAILURE, SUCCESS, Result
from pluto_bt.trees.ports import PortModel, PortProblem
from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.values import STRING


class SetBlackboard(Node):
    """A literal `value` is stored as text (parsed if the entry has a kind); `{key}` copies that entry with its kind.

    `output_key` is the name without braces; with braces it is an entry that holds the name.
    """

    PORTS: ClassVar = {
        "value": PortModel("value", description="text, or {key} to copy from"),
        "output_key": PortModel("output_key", "inout", description="the name of the entry to write"),
    }

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.scope: Scope | None = None  # these two are set by the loader
        self.source_key: str | None = None

    def step(self) -> Result:
        key = str(self.read("output_key"))
        try:
            self.status = self._write(key)
        except PortProblem as problem:
            self.fail(str(problem))
        return self.status

    def _write(self, key: str) -> Status:
        if self.scope is None:
            self.fail("port 'value' is missing")
        if self.source_key is None:
            self.scope.copy(key, str(self.read("value")), STRING)
            return SUCCESS
        source = self.scope.find(self.source_key)
        if source is None:
            self.fail(f"entry {self.source_key!r} does not exist")
        value = source.value
        if value is EMPTY:
            self.scope.declare(key, source.kind)
            return FAILURE
        kind = source.kind if source.kind is not None or not isinstance(value, str) else STRING
        self.scope.copy(key, value, kind)
        return SUCCESS


class UnsetBlackboard(Node):
    """Removes the local entry; SUCCESS even if there is none."""

    PORTS: ClassVar = {"key": PortModel("key", kind=STRING, description="the name of the entry")}

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.scope: Scope | None = None  # set by the loader

    def step(self) -> Result:
        key = self.read("key")
        if self.scope is not None:
            self.scope.unset(key)
        self.status = SUCCESS
        return SUCCESS


class WasEntryUpdated(Node):
    """SUCCESS if the entry was written since the last look, else FAILURE."""

    PORTS: ClassVar = {"entry": PortModel("entry", at_load=True, description="the entry to watch")}

    def __init__(self, name: str = "") -> None:
        super().__init__(name)
        self.watch: UpdateWatch | None = None  # set by the loader

    def step(self) -> Result:
        self.status = SUCCESS if self.watch is not None and self.watch.is_updated() else FAILURE
        return self.status
