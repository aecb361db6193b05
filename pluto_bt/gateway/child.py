"""An element inside a message."""

from __future__ import annotations

from typing import Any

import msgspec


class Child(msgspec.Struct, frozen=True, gc=False):
    """What is in it; `is_leaf`: with text alone inside."""

    tag: str
    attrib: dict[str, str]
    text: str
    is_leaf: bool = True


def text_of(element: Any) -> str:
    """The text directly inside an element of lxml, not in its children; comments are left out."""
    return (element.text or "") + "".join(child.tail or "" for child in element)


def child_of(element: Any) -> Child:
    """An element of lxml as ours."""
    return Child(element.tag, dict(element.attrib), text_of(element), not any(isinstance(one.tag, str) for one in element))
