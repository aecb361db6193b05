"""`why` of a black box: the view of a recorded moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pluto_bt.trees.why import Answer, NodeAtWork, View, explain, innermost

if TYPE_CHECKING:
    from pluto_bt.record.box import Box, Now, TreeNow


def why_at(box: Box, t_s: float | None = None) -> Answer:
    """The answer at a time of the run; without or past it, at its end: when the mission ended, or the last moment there is."""
    last = _last(box)
    number = last if t_s is None else min(box.number_at(t_s), last)  # when the mission is over all links are told to stop: no cause of anything
    return Answer(False) if number < 0 else explain(view_of(box.now(number)))


def end_s(box: Box) -> float | None:
    """When the run was over; None if the recording breaks off before."""
    return box.tick(_last(box)).t_s if box.file.is_whole else None


def view_of(now: Now) -> View:
    """What `why` looks at."""
    trees = now.at_work()
    mission = now.mission
    over = mission is not None and mission.state != "running"
    ended = (mission.state, mission.reason, mission.text) if over and mission is not None and mission.state != "succeeded" else ("", "", "")
    nodes = [node for tree in trees for node in _at_work(tree)]
    paused = "" if any(tree.tree.role == "errand" for tree in trees) else now.paused
    return View(now.tick.t_s, now.trail, nodes, mission.tree.name if mission is not None else "", ended, paused)


def _at_work(tree: TreeNow) -> list[NodeAtWork]:
    """The nodes at work, depth first."""
    rows = list(tree.rows())
    at_work = innermost([(row.depth, status == "RUNNING") for row, status, _, _ in rows])
    return [NodeAtWork(row.path, row.kind, status, feedback, since_ns / 1e9) for row, status, feedback, since_ns in (rows[i] for i in at_work)]


def _last(box: Box) -> int:
    """The tick at which the mission ended, if nothing was ticked later; else the last one."""
    for number in reversed(range(len(box))):
        branches = box.tick(number).trees
        if branches:
            is_end = any(branch.state != "running" and box.trees[branch.run].role == "mission" for branch in branches)
            return number if is_end else len(box) - 1
    return len(box) - 1
