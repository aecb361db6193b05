"""`why` of a black box: the view of a recorded moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pluto_bt.trees.why import Answer, NodeAtWork, View, explain

if TYPE_CHECKING:
    from pluto_bt.record.box import Box, Now, TreeNow


def why_at(box: Box, t_s: float | None = None) -> Answer:
    """The answer at a time of the run; without one, at its end: when the mission ended, or the last moment there is."""
    number = _last(box) if t_s is None else box.number_at(t_s)
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
    """The running leaves, depth first."""
    rows = list(tree.rows())
    found = []
    for i, (row, status, feedback, since_ns) in enumerate(rows):
        is_leaf = i + 1 == len(rows) or rows[i + 1][0].depth <= row.depth
        if is_leaf and status == "RUNNING":
            found.append(NodeAtWork(row.path, row.kind, status, feedback, since_ns / 1e9))
    return found


def _last(box: Box) -> int:
    """The tick at which the mission ended, else the last one."""
    for number in reversed(range(len(box))):
        if any(branch.state != "running" for branch in box.tick(number).trees) and not _goes_on(box, number):
            return number
    return len(box) - 1


def _goes_on(box: Box, number: int) -> bool:
    """True if trees were ticked later, so that it was not the end."""
    return any(box.tick(later).trees for later in range(number + 1, len(box)))
