"""Pairs the items of two lists in their order: equal ones, then those that are most alike."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import SequenceMatcher
from typing import Final, NamedTuple

MOST_PAIRS: Final = 40_000  # of a gap: larger ones are paired by type and name alone


class Weighed(NamedTuple):
    """What counts of an item when it is compared. Items of another `type` are never paired."""

    signature: int
    type: str
    name: str
    ports: frozenset[tuple[str, str]]


Pairs = list[tuple[int, int]]


def paired(old: Sequence[Weighed], new: Sequence[Weighed]) -> tuple[Pairs, list[int], list[int]]:
    """(pairs of indexes, indexes of `old` without partner, indexes of `new` without partner); pairs never cross."""
    pairs: Pairs = []
    matcher = SequenceMatcher(None, [one.signature for one in old], [one.signature for one in new], autojunk=False)
    a, b = 0, 0
    for block in matcher.get_matching_blocks():
        pairs += _gap(old, new, range(a, block.a), range(b, block.b))
        pairs += [(block.a + i, block.b + i) for i in range(block.size)]
        a, b = block.a + block.size, block.b + block.size
    left, right = {i for i, _ in pairs}, {j for _, j in pairs}
    return pairs, [i for i in range(len(old)) if i not in left], [j for j in range(len(new)) if j not in right]


def _gap(old: Sequence[Weighed], new: Sequence[Weighed], rows: range, columns: range) -> Pairs:
    """The best pairs between two equal subtrees, where nothing is equal."""
    if not rows or not columns:
        return []
    if len(rows) * len(columns) > MOST_PAIRS:
        keys = [[(one[i].type, one[i].name) for i in span] for one, span in ((old, rows), (new, columns))]
        blocks = SequenceMatcher(None, keys[0], keys[1], autojunk=False).get_matching_blocks()
        return [(rows[block.a + i], columns[block.b + i]) for block in blocks for i in range(block.size)]
    best = [[0.0] * (len(columns) + 1) for _ in range(len(rows) + 1)]
    for i in range(len(rows) - 1, -1, -1):
        for j in range(len(columns) - 1, -1, -1):
            alike = _likeness(old[rows[i]], new[columns[j]])
            best[i][j] = max(best[i + 1][j], best[i][j + 1], best[i + 1][j + 1] + alike if alike else 0.0)
    return _traced(old, new, rows, columns, best)


def _traced(old: Sequence[Weighed], new: Sequence[Weighed], rows: range, columns: range, best: list[list[float]]) -> Pairs:
    pairs: Pairs = []
    i = j = 0
    while i < len(rows) and j < len(columns):
        alike = _likeness(old[rows[i]], new[columns[j]])
        if alike and best[i][j] == best[i + 1][j + 1] + alike:
            pairs.append((rows[i], columns[j]))
            i, j = i + 1, j + 1
        elif best[i][j] == best[i + 1][j]:
            i += 1
        else:
            j += 1
    return pairs


def _likeness(one: Weighed, other: Weighed) -> float:
    """0 for two types; 1 and more for one type, a like name and like ports."""
    if one.type != other.type:
        return 0.0
    ports = one.ports | other.ports
    shared = len(one.ports & other.ports) / len(ports) if ports else 1.0
    return 1.0 + (1.0 if one.name == other.name else 0.0) + shared
