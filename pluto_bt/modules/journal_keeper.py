"""Keeps the journal of a mission while it runs: what each tick left behind, and the keys of side effects before they happen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pluto_bt.runtime.clock import calendar_ns
from pluto_bt.trees import Mission, memory
from pluto_bt.trees.engine.status import RUNNING, SUCCESS, Result
from pluto_bt.trees.journal import Journal, Line, Past, Pose, key_of
from pluto_bt.trees.memory import State

AT_EVERY_S = 1.0
CONDITION = "Condition"


class JournalKeeper:
    """One mission and its journal.

    Args:
        past: what an earlier run has left; the mission remembers it already.
        where: (believed, true) pose of the robot now; None = not known.
    """

    def __init__(self, mission: Mission, journal: Journal, past: Past, where: Callable[[], tuple[Pose | None, Pose | None]]) -> None:
        self.mission, self._journal, self._where = mission, journal, where
        self._state: State = past.state if past.state["nodes"] else {"nodes": {}, "board": {}}
        self._begun, self._keys = dict(past.begun), past.keys
        self._finished: list[tuple[str, str]] = []
        self._has_ended, self._line = False, ""
        self._told_s = 0.0
        tracked = mission.nodes()
        self._paths = [one.path for one in tracked]
        self._is_step = [not one.node.children and (one.plan.node_type is None or one.plan.node_type.kind != CONDITION) for one in tracked]
        for one in tracked:
            if getattr(type(one.node), "SIDE_EFFECT", False):
                one.node.step = self._once(one.node, one.path, one.node.step)
        mission.watch(self._ended)

    def after_tick(self, ticks: int, line: str) -> None:
        """Write what has changed; sure to be on the disk before the next tick if a step has finished.

        `line`: the statuses of the tick. Where no leaf has ended and no status is new, nothing is remembered that matters.
        """
        if line == self._line and not self._has_ended:
            return
        self._line, self._has_ended = line, False
        now = memory.take(self.mission)
        change = memory.changed(self._state, now)
        if change or self._finished:
            self._state = now
            pose, truth = self._where()
            told = Line("step", calendar_ns(), {}, ticks, tuple(self._finished), change, dict(self._begun), (), pose, truth)
            self._journal.write(told, is_sure=bool(self._finished))
            self._finished.clear()

    def look(self, now_s: float) -> None:
        """Once a second, also while the mission waits: where the robot is."""
        if now_s - self._told_s >= AT_EVERY_S:
            self._told_s = now_s
            pose, truth = self._where()
            self._journal.write(Line("at", calendar_ns(), pose=pose, truth=truth), is_sure=False)

    def end(self) -> None:
        """The run came to its end in good order."""
        self._journal.write(Line("end", calendar_ns()), is_sure=True)
        self._journal.close()

    def _ended(self, number: int, word: str) -> None:
        self._has_ended = True
        if self._is_step[number]:
            self._finished.append((self._paths[number], word))

    def _once(self, node: Any, path: str, step: Callable[[], Result]) -> Callable[[], Result]:
        """The step of a node with side effects: its key is on the disk before it begins, and one that stood there before the crash is done."""

        def act() -> Result:
            if node.status is not RUNNING:
                count = self._begun[path] = self._begun.get(path, 0) + 1
                key = key_of(path, count)
                if key in self._keys:
                    node.feedback_message = "done before the restart"
                    node.status = SUCCESS
                    return SUCCESS
                self._journal.write(Line("act", calendar_ns(), keys=(key,)), is_sure=True)
            return step()

        return act
