"""Fills a blackboard with the samples of a black box, as far as a tick saw them."""

from __future__ import annotations

from pluto_bt.blackboard import Blackboard
from pluto_bt.record.box import Box
from pluto_bt.record.entries import Tick
from pluto_bt.source import PlutoError


class PlaybackError(PlutoError):
    """A recording that cannot be played: something of it is missing."""


class Feed:
    """One playing of a box. `is_at_its_end`: the recording was cut short, and holds no more inputs."""

    def __init__(self, box: Box, board: Blackboard) -> None:
        names: dict[str, None] = {}
        for number in range(len(box)):
            names.update(dict.fromkeys(box.tick(number).seqs))
        self._samples = box.samples(names)
        self._next = dict.fromkeys(names, 0)
        self._board = board
        self.is_at_its_end = False

    def up_to(self, tick: Tick) -> bool:
        """Write what came before this tick. False at the end. Raises: PlaybackError if a sample that the tick saw was dropped."""
        for name, seq in tick.seqs.items():
            samples, at = self._samples[name], self._next[name]
            while at < len(samples) and samples[at].seq <= seq:
                self._board.put_back(name, samples[at])
                at += 1
            self._next[name] = at
            if seq and at == len(samples) and (at == 0 or samples[-1].seq < seq):
                self.is_at_its_end = True
                return False
            if seq and samples[at - 1].seq != seq:
                raise PlaybackError(f"tick {tick.step} ({tick.t_s:.2f} s) saw a sample of {name} that the file does not hold (any more)")
        return True
