"""What exists, for programs that want to know before they ask."""

from __future__ import annotations

from collections.abc import Sequence

from pluto_bt.blackboard.topics import TOPICS, Topic
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Description, Item
from pluto_bt.gateway.requests import ELEMENTS, Describe
from pluto_bt.gateway.subscriptions import matches
from pluto_bt.gateway.values import fields_of
from pluto_bt.source import did_you_mean

KINDS = ("topic", "node", "param", "module")


def describe(request: Describe, topics: Sequence[str], catalogue: Sequence[Item]) -> Description:
    """All there is, or what one of the four attributes names (it may end in `*`).

    Args:
        topics: names of the topics of this run.
        catalogue: the executive's items: nodes, parameters, modules, goals of the map.
    Raises: RefusedError.
    """
    asked = {kind: getattr(request, kind) for kind in KINDS if getattr(request, kind) is not None}
    if len(asked) > 1:
        raise RefusedError("invalid", f"<describe>: expected at most one of {', '.join(KINDS)}, found {', '.join(asked)}")
    items = [_topic(topic) for topic in TOPICS if topic.name in topics]
    items += [Item({"kind": "request", "name": name}, (), " ".join((kind.__doc__ or "").split())) for name, kind in ELEMENTS.items()]
    items += catalogue
    for kind, pattern in asked.items():
        of_kind = [item for item in items if item.attributes["kind"] == kind]
        items = [item for item in of_kind if matches(pattern, item.attributes["name"])]
        if not items:
            hint = did_you_mean(pattern, [item.attributes["name"] for item in of_kind])
            raise RefusedError(f"unknown-{kind}", f'unknown {kind} "{pattern}"; {hint or "<describe/> lists all"}')
    return Description(id=request.id, items=tuple(items))


def _topic(topic: Topic) -> Item:
    rates = {"period_s": f"{topic.period_s:g}", "stale_after_s": f"{topic.stale_after_s:g}"}
    return Item({"kind": "topic", "name": topic.name, "type": topic.type.__name__, "writer": topic.writer, **rates}, fields_of(topic.type), topic.doc)
