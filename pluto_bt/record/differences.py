"""Where a tick and its repetition part."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from pluto_bt.record.codec import encode
from pluto_bt.record.entries import STATUS_OF_LETTER, Branch, NodeRow, Posted, Tick, Tree


@dataclass(frozen=True)
class Difference:
    """The tick, what is meant, what was recorded and what came now."""

    step: int
    t_s: float
    what: str
    recorded: str
    now: str

    def __str__(self) -> str:
        return f"tick {self.step} ({self.t_s:.2f} s): {self.what}: recorded {self.recorded}, now {self.now}"


Differs = Callable[[str, object, object], Difference]


def compared(tick: Tick, trees: Mapping[int, Tree], now: Sequence[Branch], posted: Sequence[Posted]) -> Iterator[Difference]:
    """What a tick did differently: statuses, leaves that ended, feedback, entries, ends of trees, commands. `trees`: those of the recording."""

    def differs(what: str, recorded: object, here: object) -> Difference:
        return Difference(tick.step, tick.t_s, what, str(recorded), str(here))

    if len(now) != len(tick.trees):
        yield differs("trees at work", len(tick.trees), len(now))
        return
    for recorded, here in zip(tick.trees, now, strict=True):
        yield from _of_tree(differs, trees[recorded.run].nodes, recorded, here)
    if tick.commands != tuple(posted):
        yield differs("commands", list(tick.commands), list(posted))


def _of_tree(differs: Differs, rows: Sequence[NodeRow], recorded: Branch, here: Branch) -> Iterator[Difference]:
    if len(recorded.nodes) != len(here.nodes):
        yield differs("number of nodes", len(recorded.nodes), len(here.nodes))
        return
    if recorded.nodes != here.nodes:
        i = next(i for i, (a, b) in enumerate(zip(recorded.nodes, here.nodes, strict=True)) if a != b)
        yield differs(f"status of {rows[i].path}", STATUS_OF_LETTER[recorded.nodes[i]], STATUS_OF_LETTER[here.nodes[i]])
    if recorded.finished != here.finished:
        yield differs("leaves that ended", _ends(rows, recorded), _ends(rows, here))
    yield from _entries(differs, "feedback of ", _by_path(rows, recorded), _by_path(rows, here))
    yield from _entries(differs, "entry ", recorded.board, msgspec.json.decode(encode(here.board)))
    if (recorded.state, recorded.reason) != (here.state, here.reason):
        yield differs("the end", f"{recorded.state} {recorded.reason}", f"{here.state} {here.reason}")


def _by_path(rows: Sequence[NodeRow], branch: Branch) -> dict[str, str]:
    return {rows[i].path: text for i, text in branch.feedback.items()}


def _ends(rows: Sequence[NodeRow], branch: Branch) -> str:
    return ", ".join(f"{rows[i].path} {letter}" for i, letter in branch.finished) or "none"


def _entries(differs: Differs, what: str, recorded: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[Difference]:
    for key in {**recorded, **here}:
        if recorded.get(key) != here.get(key):
            yield differs(f"{what}{key}", recorded.get(key, "nothing new"), here.get(key, "nothing new"))
