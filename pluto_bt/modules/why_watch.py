"""`why` of a run that goes on: looks at the situation all the time, so that it knows since when things are as they are, and for a while back."""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from pluto_bt.blackboard.messages import MissionState, NodeState, TreeState
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Cause
from pluto_bt.modules.context import Context
from pluto_bt.modules.situation import SituationWatch
from pluto_bt.record.trail import Trail
from pluto_bt.runtime.clock import NS
from pluto_bt.trees.activity import ABORTED, FAILED, PAUSED
from pluto_bt.trees.why import NodeAtWork, View, explain, innermost

PERIOD_S = 0.1
KEPT = 3000  # changes of the past that can be asked for with `at`; the black box knows them all


class Past(NamedTuple):
    """A view from when it was true."""

    since_s: float
    view: View


class WhyWatch:
    """One watch. It is stepped and asked by the same thread."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._watch = SituationWatch(context)
        self._trail = Trail()
        self._past: deque[Past] = deque(maxlen=KEPT)
        self._looked_s = -PERIOD_S
        self._seen: tuple[object, ...] = ()

    def step(self, now_s: float) -> None:
        """Look, if it is time."""
        if now_s - self._looked_s < PERIOD_S and self._past:
            return
        self._looked_s = now_s
        self._look(now_s)

    def _look(self, now_s: float) -> None:
        situation = self._watch.look(now_s)
        self._trail.take(situation, round(now_s * NS))
        tree, mission = self._context.board.newest("tree"), self._context.board.newest("mission/state")
        seen = (situation, None if tree is None else tree.seq, None if mission is None else mission.seq)
        if seen != self._seen:
            self._seen = seen
            nodes = tree.value.nodes if tree is not None and isinstance(tree.value, TreeState) else ()
            state = mission.value if mission is not None and isinstance(mission.value, MissionState) else None
            self._past.append(Past(now_s, self._view(now_s, copy.deepcopy(self._trail), _at_work(nodes), state)))

    def _view(self, now_s: float, trail: Trail, nodes: Sequence[NodeAtWork], state: MissionState | None) -> View:
        core = self._context.system.executive.core
        activity = core.mission
        text = "" if activity is None else activity.text
        is_over = state is not None and state.state in (FAILED, ABORTED)
        ended = (state.state, state.reason, text) if is_over and state is not None else ("", "", "")
        paused = state.reason if state is not None and state.state == PAUSED and core.active is activity else ""
        return View(now_s, trail, nodes, "" if state is None else state.name, ended, paused)

    def answer(self, at_s: float | None, now_s: float) -> tuple[bool, Sequence[Cause]]:
        """The chain of causes at a second of the run, now without one. Raises: RefusedError for a time that is not known."""
        self._look(now_s)
        if at_s is not None and (at_s > now_s or at_s < self._past[0].since_s):
            text = f"known are {self._past[0].since_s:.1f} s to {now_s:.1f} s of the run; a black box (--record) knows all"
            raise RefusedError("out-of-range", text)
        past = next(past for past in reversed(self._past) if at_s is None or past.since_s <= at_s)
        view = copy.copy(past.view)
        view.now_s = now_s if at_s is None else at_s
        found = explain(view)
        return found.is_moving, [Cause(*cause) for cause in found.causes]


def _at_work(nodes: Sequence[NodeState]) -> list[NodeAtWork]:
    """The nodes at work."""
    rows = (nodes[i] for i in innermost([(row.depth, row.status == "RUNNING") for row in nodes]))
    return [NodeAtWork(row.path, row.kind, row.status, row.feedback, row.since_s) for row in rows]
