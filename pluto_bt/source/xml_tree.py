"""What `read_xml` returns: elements, attributes and comments, each of which knows its place in the text."""

from __future__ import annotations

import bisect
from collections.abc import Sequence
from dataclasses import dataclass, field

from pluto_bt.source.faults import Place
from pluto_bt.source.text import SourceText
from pluto_bt.source.xml_entities import ENTITY, character


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
        """The place of `value[index]`: entities before it are longer in the source than in the value."""
        text, at = self.source.text, self.value_start
        if text.startswith(self.value, at):
            return self.source.place(at + index)
        left = index
        for entity in ENTITY.finditer(text, at):
            plain, decoded = entity.start() - at, len(character(entity))
            if left < plain + decoded:
                return self.source.place(at + min(left, plain))
            left, at = left - plain - decoded, entity.end()
        return self.source.place(at + left)


@dataclass(slots=True)
class XmlComment:
    """A comment; `child_index` children of its parent stand before it. `is_instruction`: a processing instruction, kept like a comment."""

    text: str
    child_index: int
    source: SourceText = field(repr=False, compare=False)
    start: int = field(repr=False, compare=False)
    is_instruction: bool = False

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


@dataclass(slots=True)
class XmlDocument:
    """A whole file: its root and the comments around it, each in its place. `is_declared`: it begins with an XML declaration."""

    root: XmlElement
    outside: Sequence[XmlComment] = ()
    is_declared: bool = False


class OpenElement:
    """An element whose end tag is not read yet, with the text and the comments found in it so far."""

    __slots__ = ("comments", "element", "length", "pieces", "runs")

    def __init__(self, element: XmlElement) -> None:
        self.element = element
        self.pieces: list[str] = []
        self.runs: list[tuple[int, int]] = []
        self.comments: list[XmlComment] = []
        self.length = 0

    def close(self) -> None:
        """The element is complete."""
        self.element.text = "".join(self.pieces)
        self.element.text_runs, self.element.comments = self.runs, self.comments
