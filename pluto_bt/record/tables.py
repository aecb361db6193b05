"""Topics of a black box as tables: a row a sample, a column a number."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import msgspec
import numpy as np

from pluto_bt.blackboard import Sample
from pluto_bt.blackboard.messages import Message


def table(samples: Sequence[Sample]) -> Iterator[list[Any]]:
    """A head, then a row a sample; a sample that lacks a column of another one has "" there."""
    rows = [{"written_s": sample.written_s, "seq": sample.seq, **cells_of(sample.value)} for sample in samples]
    head = list(dict.fromkeys(name for row in rows for name in row))
    yield head
    for row in rows:
        yield [row.get(name, "") for name in head]


def cells_of(value: Message) -> dict[str, Any]:
    """The fields of a message by name; numbers in a row become `name[0]`, `name[1]` …, rows of a table one text of JSON."""
    cells: dict[str, Any] = {}
    for name in value.__struct_fields__:
        field = getattr(value, name)
        if isinstance(field, np.ndarray):
            field = field.tolist()
        if isinstance(field, list | tuple) and not any(isinstance(item, msgspec.Struct) for item in field):
            cells |= {f"{name}[{i}]": item for i, item in enumerate(field)}
        else:
            cells[name] = field if isinstance(field, int | float | str) else msgspec.json.encode(field).decode()
    return cells


def of_topics(found: dict[str, list[Sample]]) -> Iterable[tuple[str, Sample]]:
    """All samples with their topics, in the order in which they were written."""
    return sorted(((topic, sample) for topic, samples in found.items() for sample in samples), key=lambda one: one[1].written_s)
