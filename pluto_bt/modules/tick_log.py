"""Notes for the black box what each step of the executive did: orders, statuses, feedback, blackboard, commands, the situation.

Only what changed is noted, and every so often all of it, so that any tick can be told without reading the whole file.
"""

from __future__ import annotations

from typing import Any

import msgspec

from pluto_bt.behaviours.robot import Ticket
from pluto_bt.blackboard.messages import Pose
from pluto_bt.modules.context import Context
from pluto_bt.modules.notebook import Notebook
from pluto_bt.modules.situation import SituationWatch
from pluto_bt.record.codec import encode
from pluto_bt.record.entries import KEYFRAME_EVERY, STATUS_OF_LETTER, Branch, NodeRow, Posted, Situation, Tick, Tree
from pluto_bt.runtime.clock import NS
from pluto_bt.trees.activity import Activity
from pluto_bt.trees.executive import Executive
from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.tracked import Tracked

_AS_IS = (bool, int, float, str)
LETTER_OF = {word: letter for letter, word in STATUS_OF_LETTER.items()}


class BranchLog:
    """One tree: what was last told of it."""

    def __init__(self, activity: Activity) -> None:
        self.activity = activity
        self._tracked = activity.mission.nodes()
        self._scopes: list[Scope] = list({id(one.plan.scope): one.plan.scope for one in self._tracked}.values())
        self._feedback: list[str] = [""] * len(self._tracked)
        self._seqs: dict[tuple[int, str], int] = {}
        self._finished: list[tuple[int, str]] = []
        activity.mission.watch(lambda number, word: self._finished.append((number, LETTER_OF[word])))

    def tree(self, role: str) -> Tree:
        """The tree itself."""
        mission = self.activity.mission
        rows = tuple(_row(one) for one in self._tracked)
        return Tree(run=self.activity.number, role=role, name=mission.name, nodes=rows, text=mission.origin.text, file=mission.origin.file)

    def branch(self, statuses: str) -> Branch:
        """What changed in this tick; every so often everything."""
        is_key = self.activity.ticks % KEYFRAME_EVERY == 1
        if is_key:
            self._feedback = [""] * len(self._tracked)
            self._seqs.clear()
        activity = self.activity
        feedback: dict[int, str] = {}
        for i, tracked in enumerate(self._tracked):
            words = tracked.node.feedback_message
            if words != self._feedback[i]:
                self._feedback[i] = feedback[i] = words
        board, gone = self._board()
        finished, self._finished[:] = tuple(self._finished), ()
        end = (activity.state, activity.reason, activity.text)
        return Branch(activity.number, activity.ticks, statuses, finished, feedback, board, gone, *end, is_key)

    def _board(self) -> tuple[dict[str, Any], tuple[str, ...]]:
        changed: dict[str, Any] = {}
        here: set[tuple[int, str]] = set()
        for number, scope in enumerate(self._scopes):
            for key, entry in list(scope.entries.items()):
                if entry.value is EMPTY:
                    continue
                place = (number, key)
                here.add(place)
                if self._seqs.get(place) != entry.seq:
                    self._seqs[place] = entry.seq
                    changed[_label(scope, key)] = plain(entry.value)
        if len(here) == len(self._seqs):
            return changed, ()
        gone = [place for place in self._seqs if place not in here]
        for place in gone:
            del self._seqs[place]
        return changed, tuple(_label(self._scopes[number], key) for number, key in gone)


class TickLog:
    """Writes into the notebook of the black box."""

    def __init__(self, context: Context, core: Executive, notebook: Notebook) -> None:
        self._context, self._core, self._notebook = context, core, notebook
        self._robot = context.system.robot
        self._robot.on_command, core.on_begin = self._on_command, self._began
        self._watch = SituationWatch(context)
        self._situation: Situation | None = None
        self._pose = context.board.reader("Localization/Pose")
        self._branches: dict[int, BranchLog] = {}
        self._commands: list[Posted] = []
        self._whole: dict[int, int] = {}  # row of a topic that is kept whole -> sequence number told last
        self._steps = 0

    def step(self, now_s: float, ticked: list[Activity], lines: list[str], is_end: bool = False) -> None:
        """Note one step of the executive, if anything happened in it; `is_end`: no step, but how things stand when the run is over."""
        orders = tuple((done.verb, done.run, done.text) for done in self._core.take_done())
        situation = self._watch.look(now_s)
        if not ticked and not orders and situation == self._situation:
            return
        is_key = self._steps % KEYFRAME_EVERY == 0
        trees = tuple(self._branches[activity.number].branch(line) for activity, line in zip(ticked, lines, strict=True))
        sample = self._pose()
        pose = sample.value.pose if sample is not None and isinstance(sample.value, Pose) else None
        self._notebook.note(Tick(
            round(now_s * NS), self._steps, orders, trees, tuple(self._commands), self._seqs(is_key),
            None if pose is None else (pose[0], pose[1], pose[3]),
            situation if is_key or situation != self._situation else None, is_key, is_end,
        ))  # fmt: skip
        self._commands.clear()
        self._situation = situation
        self._steps += 1

    def _began(self, activity: Activity) -> None:
        role = "job" if activity is self._core.job else "errand" if activity is self._core.errand else "mission"
        self._branches = {number: kept for number, kept in self._branches.items() if not kept.activity.is_over}
        log = self._branches[activity.number] = BranchLog(activity)
        self._notebook.note(log.tree(role))

    def _seqs(self, is_key: bool) -> dict[str, int]:
        """The sequence numbers that this tick saw, as far as they are news; a topic that is read for the first time is kept from now on."""
        board, snapshot = self._context.board, self._robot.snapshot
        seqs: dict[str, int] = {}
        for index in sorted(self._robot.reads):
            name, seq = board.topics[index].name, snapshot.seq(index)
            if index not in self._whole:
                self._notebook.will_keep(index)
                seen = snapshot.newest(name)  # the board may have a newer one already
                self._notebook.keep(index, (*board.history(name), *(() if seen is None else (seen,))))
            if is_key or self._whole.get(index) != seq:
                self._whole[index] = seqs[name] = seq
        return seqs

    def _on_command(self, to: str, ticket: Ticket) -> None:
        command = ticket.command
        self._commands.append(Posted(to, command.flags, command.position, command.velocity, ticket.refused))


def _row(tracked: Tracked) -> NodeRow:
    plan = tracked.plan
    sort = plan.node_type.kind if plan.node_type is not None else "SubTree"
    ports = {one.name: one.value for one in plan.element.attributes.values() if one.name not in ("name", "ID")}
    return NodeRow(tracked.path, plan.type_name, plan.name, plan.depth, sort, ports)


def _label(scope: Scope, key: str) -> str:
    return f"{scope.name}/{key}" if scope.name else key


def plain(value: Any) -> Any:
    """A value of the blackboard as it is now: it may be changed later."""
    return value if type(value) in _AS_IS else msgspec.Raw(encode(value))
