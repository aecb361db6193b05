"""The blackboard as leaves and callers see it: a mapping from key to value, with the robot beside it."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from typing import Any

from pluto_bt.trees.scopes import EMPTY, Scope, Topics
from pluto_bt.trees.values import PortProblem


class BoardView(MutableMapping[str, Any]):
    """One scope. Reading an entry without value is a KeyError; an assignment counts as a write even if the value is equal.

    Attributes:
        robot: what motion leaves command; None without a robot. Shared by all scopes of the mission.
        topics: the robot's topics, read-only; None without any.
    """

    def __init__(self, scope: Scope) -> None:
        self._scope = scope

    @property
    def robot(self) -> Any:
        """What motion leaves command, or None."""
        return self._scope.board.robot

    @robot.setter
    def robot(self, robot: Any) -> None:
        self._scope.board.robot = robot

    @property
    def topics(self) -> Topics | None:
        """The robot's topics, or None."""
        return self._scope.board.topics

    def __getitem__(self, key: str) -> Any:
        entry = self._scope.find(key)
        if entry is None or (value := entry.value) is EMPTY:
            raise KeyError(key)
        return value

    def __setitem__(self, key: str, value: Any) -> None:
        try:
            self._scope.write(key, value)
        except PortProblem as problem:
            raise ValueError(str(problem)) from None

    def __delitem__(self, key: str) -> None:
        if key not in self:
            raise KeyError(key)
        self._scope.unset(key)

    def __iter__(self) -> Iterator[str]:
        return (key for key in list(self._scope.entries) if self._scope.entries[key].value is not EMPTY)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return f"BoardView({dict(self)!r})"

    def writes(self, key: str) -> int:
        """How often the entry has been written; 0 if there is none."""
        entry = self._scope.find(key)
        return 0 if entry is None else entry.seq
