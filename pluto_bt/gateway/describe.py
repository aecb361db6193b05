"""What exists, for programs that want to know before they ask."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from pluto_bt.blackboard.topics import TOPICS, Topic
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Description, Item
from pluto_bt.gateway.requests import ELEMENTS, Describe
from pluto_bt.gateway.subscriptions import matches
from pluto_bt.gateway.values import fields_of
from pluto_bt.gateway.xml_text import element, escape
from pluto_bt.source import did_you_mean

KINDS = ("topic", "node", "param", "module")


class Described(NamedTuple):
    """One thing that exists, and the element that says so: made once, for to make all of them takes as long as a hundred other answers."""

    kind: str
    name: str
    line: str


def described(topics: Sequence[str], catalogue: Sequence[Item]) -> tuple[Described, ...]:
    """All there is.

    Args:
        topics: names of the topics of this run.
        catalogue: the executive's items: nodes, parameters, modules, goals of the map.
    """
    items = [_topic(topic) for topic in TOPICS if topic.name in topics]
    items += [Item({"kind": "request", "name": name}, (), " ".join((kind.__doc__ or "").split())) for name, kind in ELEMENTS.items()]
    return tuple(Described(item.attributes["kind"], item.attributes["name"], _line(item)) for item in (*items, *catalogue))


def describe(request: Describe, known: Sequence[Described]) -> Description:
    """All that is known, or what one of the four attributes names (it may end in `*`). Raises: RefusedError."""
    asked = {kind: getattr(request, kind) for kind in KINDS if getattr(request, kind) is not None}
    if len(asked) > 1:
        raise RefusedError("invalid", f"<describe>: expected at most one of {', '.join(KINDS)}, found {', '.join(asked)}")
    chosen = known
    for kind, pattern in asked.items():
        of_kind = [one for one in known if one.kind == kind]
        chosen = [one for one in of_kind if matches(pattern, one.name)]
        if not chosen:
            hint = did_you_mean(pattern, [one.name for one in of_kind])
            raise RefusedError(f"unknown-{kind}", f'unknown {kind} "{pattern}"; {hint or "<describe/> lists all"}')
    return Description(id=request.id, items=tuple(one.line for one in chosen))


def _line(item: Item) -> str:
    fields = "".join(element("field", dict(field)) for field in item.fields)
    return element("item", dict(item.attributes), fields + element("doc", {}, escape(item.doc)))


def _topic(topic: Topic) -> Item:
    rates = {"period_s": f"{topic.period_s:g}", "stale_after_s": f"{topic.stale_after_s:g}"}
    return Item({"kind": "topic", "name": topic.name, "type": topic.type.__name__, "writer": topic.writer, **rates}, fields_of(topic.type), topic.doc)
