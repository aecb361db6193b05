"""One canonical form for every XML file: two blanks a level, attributes in their order, filled up to a width; comments stay where they stand.

Writing keeps all that reading knows: elements, attributes and their order, values to the character, texts without the blanks around them,
comments, processing instructions, one blank line where there were some. Elements that stand in the midst of a line of text, as `<b>` in a
description, stay there with their text. What is written reads as what was read, and written again is equal.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import Final, NamedTuple

from pluto_bt.source.text import SourceText
from pluto_bt.source.xml_tree import XmlAttribute, XmlComment, XmlDocument, XmlElement

WIDTH: Final = 140
INDENT: Final = "  "
DECLARATION: Final = '<?xml version="1.0" encoding="UTF-8"?>'
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


def written(document: XmlDocument) -> str:
    """The document in canonical form, with a line feed at its end."""
    writer = _Writer(document.root.source)
    if document.is_declared:
        writer.lines.append(DECLARATION)
    items: list[XmlElement | XmlComment | _Text] = sorted([document.root, *document.outside], key=lambda item: item.start)
    writer.add_items(items, 0)
    return "\n".join(writer.lines) + "\n"


class _Text(NamedTuple):
    """A run of character data between tags and comments, without the blanks around it."""

    text: str
    start: int


class _Writer:
    """The lines so far."""

    def __init__(self, source: SourceText) -> None:
        self._source = source.text
        self.lines: list[str] = []

    def add_items(self, items: Sequence[XmlElement | XmlComment | _Text], level: int) -> None:
        """What stands side by side."""
        for i, item in enumerate(items):
            if isinstance(item, XmlComment):
                self._add_comment(item, level, is_first=i == 0)
                continue
            self._add_blank_line(item.start, is_first=i == 0)
            if isinstance(item, _Text):
                self.lines += (INDENT * level + escaped_text(item.text)).split("\n")
            else:
                self._add_element(item, level)

    def _add_element(self, element: XmlElement, level: int) -> None:
        head = _start_tag(element, INDENT * level)
        content = _content_of(element)
        items = _stripped(content)
        if not items:
            self.lines += (head + "/>").split("\n")
        elif _is_running_text(content):
            self.lines += f"{head}>{_as_running_text(content).strip()}</{element.tag}>".split("\n")
        elif len(items) == 1 and isinstance(items[0], _Text):
            self.lines += f"{head}>{escaped_text(items[0].text)}</{element.tag}>".split("\n")
        else:
            self.lines += (head + ">").split("\n")
            self.add_items(items, level + 1)
            self.lines.append(f"{INDENT * level}</{element.tag}>")

    def _add_comment(self, comment: XmlComment, level: int, is_first: bool) -> None:
        """On a line of its own, or behind what it stands behind; its further lines move with its first."""
        is_trailing = bool(self.lines) and self._stands_behind_something(comment.start)
        if not is_trailing:
            self._add_blank_line(comment.start, is_first)
        start = self.lines.pop() + " " if is_trailing else INDENT * level
        was_at = comment.start - (self._source.rfind("\n", 0, comment.start) + 1)
        first, *more = _comment(comment).split("\n")
        self.lines += [start + first, *(_shifted(line, len(start) - was_at) for line in more)]

    def _stands_behind_something(self, start: int) -> bool:
        """True if there is more than blanks before it in its line."""
        at = start
        while at > 0 and self._source[at - 1] in " \t":
            at -= 1
        return at > 0 and self._source[at - 1] != "\n"

    def _add_blank_line(self, start: int, is_first: bool) -> None:
        """One blank line is kept where there were some, but for the first thing inside an element or in the file."""
        at = start
        while at > 0 and self._source[at - 1] in " \t\n":
            at -= 1
        if not is_first and self._source.count("\n", at, start) > 1:
            self.lines.append("")


def _content_of(element: XmlElement) -> list[XmlElement | XmlComment | _Text]:
    """Children, comments and texts, with the blanks around them, in the order of the source."""
    marks: list[XmlElement | XmlComment] = sorted([*element.children, *element.comments], key=lambda item: item.start)
    found: list[XmlElement | XmlComment | _Text] = []
    runs = [*element.text_runs, (len(element.text), len(element.source.text) + 1)]
    pieces: list[str] = []
    first = 0
    at = 0
    for mark in [*marks, None]:
        while at < len(runs) - 1 and (mark is None or runs[at][1] < mark.start):
            first = first if pieces else runs[at][1]
            pieces.append(element.text[runs[at][0] : runs[at + 1][0]])
            at += 1
        if pieces:
            found.append(_Text("".join(pieces), first))
        pieces.clear()
        if mark is not None:
            found.append(mark)
    return found


def _stripped(content: Sequence[XmlElement | XmlComment | _Text]) -> list[XmlElement | XmlComment | _Text]:
    """The same without the blanks around texts, and without texts of blanks alone."""
    items = [_Text(item.text.strip(), item.start) if isinstance(item, _Text) else item for item in content]
    return [item for item in items if not isinstance(item, _Text) or item.text]


def _is_running_text(content: Sequence[XmlElement | XmlComment | _Text]) -> bool:
    """True if a child stands in one line with text beside it, so that a new line between them would say something else."""
    for before, after in pairwise(content):
        text, child = (before, after) if isinstance(before, _Text) else (after, before)
        if isinstance(text, _Text) and isinstance(child, XmlElement) and (bare := text.text.strip()):
            edges = text.text.split(bare)
            if "\n" not in edges[-1 if text is before else 0]:
                return True
    return False


def _as_running_text(content: Sequence[XmlElement | XmlComment | _Text]) -> str:
    """Content as it stands, to the blank."""
    shown = ""
    for item in content:
        if isinstance(item, _Text):
            shown += escaped_text(item.text)
        elif isinstance(item, XmlComment):
            shown += _comment(item)
        else:
            tag, inside = " ".join([item.tag, *(f'{one.name}="{_value(one)}"' for one in item.attributes.values())]), _content_of(item)
            shown += f"<{tag}>{_as_running_text(inside)}</{item.tag}>" if inside else f"<{tag}/>"
    return shown


def _comment(comment: XmlComment) -> str:
    return f"<?{comment.text}?>" if comment.is_instruction else f"<!--{comment.text}-->"


def _start_tag(element: XmlElement, indent: str) -> str:
    """The tag without its end, attributes filled up to the width."""
    line = f"{indent}<{element.tag}"
    further = " " * (len(line) + 1 if len(line) < WIDTH // 2 else len(indent) + 4)
    done: list[str] = []
    is_first = True
    for attribute in element.attributes.values():
        first, *more = f'{attribute.name}="{_value(attribute)}"'.split("\n")
        if not is_first and len(line) + 1 + len(first) > WIDTH:
            done.append(line)
            line = further + first
        else:
            line += " " + first
        is_first = False
        if more:
            done += [line, *more[:-1]]
            line = more[-1]
    return "\n".join([*done, line])


def _value(attribute: XmlAttribute) -> str:
    """The value between double quotes; line feeds and tabs stay as they are written, raw or as numbers."""
    value = attribute.value.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    if "\n" in value or "\t" in value:
        text, start = attribute.source.text, attribute.value_start
        raw = text[start : text.index(text[start - 1], start)]
        for sign in "\n\t":
            value = value if sign in raw else value.replace(sign, f"&#{ord(sign)};")
    return _CONTROL.sub(lambda found: f"&#{ord(found[0])};", value)


def escaped_text(text: str) -> str:
    """Character data."""
    return _CONTROL.sub(lambda found: f"&#{ord(found[0])};", text.replace("&", "&amp;").replace("<", "&lt;").replace("]]>", "]]&gt;"))


def _shifted(line: str, by: int) -> str:
    """The line moved to the right, or to the left as far as blanks allow."""
    if by >= 0:
        return " " * by + line if line.strip() else ""
    blanks = len(line) - len(line.lstrip(" \t"))
    return line[min(-by, blanks) :] if line.strip() else ""
