"""What happened in a run, read from its ticks: the changes of nodes, and the leaves that ended, in order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from pluto_bt.record.box import Box
from pluto_bt.record.entries import STATUS_OF_LETTER, NodeRow


class Change(NamedTuple):
    """One thing that happened: `what` is a node's path, an order or a command."""

    number: int
    t_s: float
    what: str
    words: str


class Ended(NamedTuple):
    """A leaf that ended."""

    t_s: float
    path: str
    kind: str
    status: str


def changes(box: Box) -> Iterator[Change]:
    """Orders, and leaves that began or ended, tick by tick. Conditions that answer at once again and again are told when the answer is new."""
    running: set[tuple[int, int]] = set()
    answers: dict[tuple[int, int], str] = {}
    for number in range(len(box)):
        tick = box.tick(number)
        for verb, _, text in tick.orders:
            if verb not in ("start-job", "leaf-fault", "job") and text != "preempted":
                yield Change(number, tick.t_s, verb, text)
        for branch in tick.trees:
            tree = box.trees[branch.run]
            for i, letter in branch.finished:
                word, was_running = STATUS_OF_LETTER[letter], (branch.run, i) in running
                if was_running or answers.get((branch.run, i)) != letter:
                    said = branch.feedback.get(i, "")
                    yield Change(number, tick.t_s, tree.nodes[i].path, f"{word}{': ' + said if said else ''}")
                answers[branch.run, i] = letter
            for i in leaves(tree.nodes):
                place = (branch.run, i)
                if branch.nodes[i : i + 1] == "R" and place not in running:
                    yield Change(number, tick.t_s, tree.nodes[i].path, "RUNNING")
                (running.add if branch.nodes[i : i + 1] == "R" else running.discard)(place)
            if branch.state != "running":
                yield Change(number, tick.t_s, tree.name, ": ".join(word for word in (branch.state, branch.reason) if word))


def ended(box: Box, role: str = "mission") -> list[Ended]:
    """The leaves of a role's trees that ended, in order; one that says the same again and again is told once."""
    found: list[Ended] = []
    for number in range(len(box)):
        tick = box.tick(number)
        for branch in tick.trees:
            tree = box.trees[branch.run]
            for i, letter in branch.finished if tree.role == role else ():
                row = tree.nodes[i]
                one = Ended(tick.t_s, row.path, row.kind, STATUS_OF_LETTER[letter])
                if not found or found[-1][1:] != one[1:]:
                    found.append(one)
    return found


def leaves(rows: tuple[NodeRow, ...]) -> list[int]:
    """The numbers of the nodes without children."""
    return [i for i, row in enumerate(rows) if i + 1 == len(rows) or rows[i + 1].depth <= row.depth]
