"""An element inside a message."""

from __future__ import annotations

import msgspec


class Child(msgspec.Struct, frozen=True, gc=False):
    """What is in it; `is_leaf`: with text alone inside. Its text is what stands directly inside it, without comments."""

    tag: str
    attrib: dict[str, str]
    text: str
    is_leaf: bool = True
