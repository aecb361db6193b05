"""What `read_xml` returns: elements, attributes and comments, each of which knows its place in the text."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from dataclasses import dataclass, field

from pluto_bt.source.faults import Place
from pluto_bt.source.text import SourceText


@dataclass(slots=True)
class XmlAttribute:
    """One attribute. `value` is decoded; line feeds and tabs in it are kept."""

    name: str
    value: str
    source: SourceText = field(repr=False, compare=False)
    start: int = field(repr=False, compare=False)
    value_start: int = field(repr=False, compare=False)

    @property
    def place(self) -> Place:
        """Where the name begins."""
        return self.source.place(self.start)

    @property
    def value_place(self) -> Place:
        """The first character inside the quotes."""
        return self.source.place(self.value_start)

    def place_at(self, index: int) -> Place:
        """The place of `value[index]`; the first character of the value if entities were decoded in it."""
        exact = self.source.text.startswith(self.value, self.value_start)
        return self.source.place(self.value_start + (index if exact else 0))


@dataclass(slots=True)
class XmlComment:
    """A comment; `child_index` children of its parent stand before it."""

    text: str
    child_index: int
    source: SourceText = field(repr=False, compare=False)
    start: int = field(repr=False, compare=False)

    @property
    def place(self) -> Place:
        """The place of its `<`."""
        return self.source.place(self.start)


@dataclass(slots=True, eq=False)
class XmlElement:
    """One element. `text` is all character data directly inside it, decoded, without its children's.

    `text_runs` says where the text stands: (index in `text`, offset in the source) for each run of it.
    """

    tag: str
    source: SourceText = field(repr=False)
    start: int = field(repr=False)
    parent: XmlElement | None = field(repr=False)
    attributes: dict[str, XmlAttribute]
    children: list[XmlElement]
    comments: Sequence[XmlComment] = ()
    text: str = ""
    text_runs: Sequence[tuple[int, int]] = field(default=(), repr=False)

    def get(self, name: str, default: str = "") -> str:
        """The value of an attribute, or `default`."""
        attribute = self.attributes.get(name)
        return default if attribute is None else attribute.value

    @property
    def place(self) -> Place:
        """The place of its `<`."""
        return self.source.place(self.start)

    @property
    def text_place(self) -> Place:
        """The first character of the text that is not blank; the element's own place if there is none."""
        first = len(self.text) - len(self.text.lstrip())
        return self.place_at(first) if first < len(self.text) else self.place

    def place_at(self, index: int) -> Place:
        """The place of `text[index]`."""
        run = bisect.bisect_right(self.text_runs, index, key=lambda pair: pair[0]) - 1
        if run < 0:
            return self.place
        at, offset = self.text_runs[run]
        return self.source.place(offset + index - at)
