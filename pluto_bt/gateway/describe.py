"""What exists, for programs that want to know before they ask."""

from __future__ import annotations

from collections.abc import Sequence

from pluto_bt.blackboard.topics import TOPICS, Topic
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Description, Item
from pluto_bt.gateway.requests import ELEMENTS, Describe
from pluto_bt.gateway.subscriptions import matches
from pluto_bt.gateway.values import fields_of


def describe(request: Describe, topics: Sequence[str]) -> Description:
    """The topics of this run and the requests the gateway understands; with `topic`, those it names. Raises: RefusedError."""
    for kind in ("node", "param", "module"):
        if getattr(request, kind) is not None:
            raise RefusedError(f"unknown-{kind}", f'<describe {kind}="…"/> is not answered by this version; it describes topics and requests')
    items = [_topic(topic) for topic in TOPICS if topic.name in topics and (request.topic is None or matches(request.topic, topic.name))]
    if request.topic is None:
        items += [Item({"kind": "request", "name": name}, (), (kind.__doc__ or "").strip()) for name, kind in ELEMENTS.items()]
    elif not items:
        raise RefusedError("unknown-topic", f'unknown topic "{request.topic}"; <describe/> lists all')
    return Description(id=request.id, items=tuple(items))


def _topic(topic: Topic) -> Item:
    times = {"period_s": f"{topic.period_s:g}", "stale_after_s": f"{topic.stale_after_s:g}"}
    return Item({"kind": "topic", "name": topic.name, "type": topic.type.__name__, "writer": topic.writer, **times}, fields_of(topic.type), topic.doc)
