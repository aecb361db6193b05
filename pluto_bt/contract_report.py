"""Contracts checked over a recorded run: those of its mission, or of any other file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

from pluto_bt.blackboard import TOPICS, Blackboard, Sample
from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.record.box import Box
from pluto_bt.trees.contracts import Contract, ContractWatch, Kept
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.scopes import Board

TOPIC_NAME = re.compile(r"@([A-Za-z_][\w/-]*)")


def check_box(box: Box, contracts: list[Contract]) -> list[Kept]:
    """How each contract stood in the run, tick by tick; a topic that was only thinned is seen as it was recorded."""
    replayed = _Replayed(box, contracts)
    watch = ContractWatch(contracts, replayed.board.root, plugin_enums())
    for now_s in replayed.ticks():
        watch.look(now_s)
    return watch.kept


class _Replayed:
    """The blackboard and the topics of a box, brought to one tick after the other."""

    def __init__(self, box: Box, contracts: Iterable[Contract]) -> None:
        self._box = box
        self._topic_board = Blackboard(TOPICS)
        self._topics = TopicGlobals(lambda: self._topic_board.snapshot(0.0))
        self.board = Board(self._topics)
        names = {found for one in contracts for found in TOPIC_NAME.findall(f"{one.always} {one.when}")}
        self._samples = self._recorded(sorted(names))

    def _recorded(self, names: list[str]) -> list[tuple[str, Sample]]:
        """The samples of the topics that the names mean, in the order of their writing."""
        topics = dict.fromkeys(topic for name in names if (topic := self._topics.topic_of(name)) is not None)
        found = [(name, sample) for name, samples in self._box.samples(topics).items() for sample in samples]
        return sorted(found, key=lambda one: (one[1].written_s, one[1].seq))

    def ticks(self) -> Iterator[float]:
        """The times (s) at which the mission was ticked; the board is as it was then."""
        mission_runs = {run for run, tree in self._box.trees.items() if tree.role == "mission"}
        at = 0
        for number in range(len(self._box)):
            tick = self._box.tick(number)
            while at < len(self._samples) and self._samples[at][1].written_s <= tick.t_s:
                self._topic_board.put_back(*self._samples[at])
                at += 1
            for branch in tick.trees:
                if branch.run in mission_runs:
                    self._write(branch.board, branch.gone)
                    yield tick.t_s

    def _write(self, changed: dict[str, Any], gone: Iterable[str]) -> None:
        for key, value in changed.items():
            if "/" not in key:  # entries of SubTrees are not the mission's
                entry = self.board.root.declare(key, None)
                entry.put(value)
        for key in gone:
            self.board.root.unset(key)
