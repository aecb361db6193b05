"""The one XML reader: keeps line and column of every element, attribute and comment, and is as lenient as the files people have.

BehaviorTree.CPP reads with tinyxml2, so real missions hold raw `<`, `&` and `&&` inside attribute values and line feeds in scripts
(bt_xml.md, section 1). Standard parsers refuse or change those; this scanner keeps them. It reads once from left to right, in time
linear in the length whatever the input. Document types are refused: they are only good for entity bombs.
"""

from __future__ import annotations

import gc
import re
from pathlib import Path

from pluto_bt.source.faults import Faults, Place
from pluto_bt.source.text import MAX_BYTES, SourceText, read_text
from pluto_bt.source.xml_entities import ENTITY, character, decoded
from pluto_bt.source.xml_faults import NAME, XmlReport, XmlSyntaxError
from pluto_bt.source.xml_tree import OpenElement, XmlAttribute, XmlComment, XmlDocument, XmlElement

__all__ = ["MAX_DEPTH", "MAX_ELEMENTS", "XmlAttribute", "XmlComment", "XmlDocument", "XmlElement", "read_document", "read_xml", "read_xml_file"]

MAX_DEPTH = 256
MAX_ELEMENTS = 50_000
ITEMS_PER_ELEMENT = 10  # attributes, entities, comments and pieces of text are limited too
DUPLICATE_COST = 100  # an attribute that is repeated for ever soon ends the reading
_TAG = re.compile(NAME)
_ATTRIBUTE = re.compile(rf"""\s*+(?:({NAME})\s*+=\s*+("[^"]*+"|'[^']*+')|/?>)""")
_END_TAG = re.compile(rf"</\s*+({NAME})\s*+>")
_DECLARATION = re.compile(r"<\?xml\s")
_WORD = re.compile(r"<!\w{0,20}")


def read_xml(
    text: str, file: str, faults: Faults, *, max_depth: int = MAX_DEPTH, max_elements: int = MAX_ELEMENTS, max_bytes: int = MAX_BYTES
) -> XmlElement | None:
    """The root element of `text`, or None and the fault that ended the reading; the arguments are those of `read_document`."""
    document = read_document(text, file, faults, max_depth=max_depth, max_elements=max_elements, max_bytes=max_bytes)
    return document.root if document is not None else None


def read_document(
    text: str, file: str, faults: Faults, *, max_depth: int = MAX_DEPTH, max_elements: int = MAX_ELEMENTS, max_bytes: int = MAX_BYTES
) -> XmlDocument | None:
    """The root element of `text` and what stands around it, or None and the fault that ended the reading.

    Args:
        file: the name to show in faults.
        max_depth: how many elements may stand inside one another.
        max_elements: how many elements there may be; ten times as many attributes, entities, comments and pieces of text.
    """
    if len(text) > max_bytes:
        faults.error(Place(file), "too-large", "the text is too large", expected=f"at most {max_bytes} characters", found=str(len(text)))
        return None
    collecting = gc.isenabled()
    gc.disable()  # a growing tree holds no garbage, and looking for it would take twice as long as reading
    try:
        return _Scanner(SourceText(text.removeprefix("\ufeff"), file), faults, max_depth, max_elements).read()
    except XmlSyntaxError:
        return None
    finally:
        if collecting:
            gc.enable()


def read_xml_file(
    path: str | Path, shown_name: str, faults: Faults, *, max_depth: int = MAX_DEPTH, max_elements: int = MAX_ELEMENTS, max_bytes: int = MAX_BYTES
) -> XmlElement | None:
    """The root element of a file, or None and the fault; `shown_name` is the file's name as the user gave it."""
    text = read_text(path, shown_name, faults, max_bytes=max_bytes)
    if text is None:
        return None
    return read_xml(text, shown_name, faults, max_depth=max_depth, max_elements=max_elements, max_bytes=max_bytes)


class _Scanner:
    """One reading, from left to right; `_open` are the elements around the point that is reached."""

    def __init__(self, source: SourceText, faults: Faults, max_depth: int, max_elements: int) -> None:
        self._source, self._text, self._report = source, source.text, XmlReport(source, faults)
        self._max_depth, self._max_elements = max_depth, max_elements
        self._elements_left, self._items_left = max_elements, ITEMS_PER_ELEMENT * max_elements
        self._root: XmlElement | None = None
        self._open: list[OpenElement] = []
        self._outside: list[XmlComment] = []

    def read(self) -> XmlDocument:
        """The document, or an `XmlSyntaxError` whose fault is noted."""
        nul = self._text.find("\0")
        if nul >= 0:
            raise self._report.stop(nul, "xml-syntax", "this is not a text file", expected="XML text", found="a NUL character")
        at, end = 0, len(self._text)
        while at < end:
            bracket = self._text.find("<", at)
            bracket = end if bracket < 0 else bracket
            if bracket > at:
                self._character_data(at, bracket)
            at = self._markup(bracket) if bracket < end else end
        return XmlDocument(self._finished(), self._outside, _DECLARATION.match(self._text) is not None)

    def _finished(self) -> XmlElement:
        if self._open:
            left = self._open[-1].element
            what = f"<{left.tag}> is never closed"
            raise self._report.stop(left.start, "unclosed-tag", what, expected=f"</{left.tag}>", found="the end of the file")
        if self._root is None:
            what = "there is no root element" if self._text.strip() else "the file is empty"
            raise self._report.stop(0, "no-root", what, expected="an XML document with one root element", found="none")
        return self._root

    def _markup(self, at: int) -> int:
        """Read what begins with the `<` at `at`; the offset after it."""
        following = self._text[at + 1 : at + 2]
        if following == "/":
            return self._end_tag(at)
        if following == "?":
            after = self._after("?>", at, "a processing instruction", skip=2)
            if _DECLARATION.match(self._text, at) is None:
                self._keep(XmlComment(self._text[at + 2 : after - 2], 0, self._source, at, is_instruction=True))
            return after
        if following == "!":
            return self._declaration(at)
        return self._start_tag(at)

    def _declaration(self, at: int) -> int:
        if self._text.startswith("<!--", at):
            after = self._after("-->", at, "a comment", skip=4)
            self._keep(XmlComment(self._text[at + 4 : after - 3], 0, self._source, at))
            return after
        if self._text.startswith("<![CDATA[", at):
            after = self._after("]]>", at, "a CDATA section", skip=9)
            self._add_text(self._text[at + 9 : after - 3], at + 9)
            return after
        word = _WORD.match(self._text, at)
        what = "document types and entity declarations are refused"
        raise self._report.stop(at, "doctype", what, expected="elements only", found=word.group() if word else "<!", mend="delete the declaration")

    def _keep(self, comment: XmlComment) -> None:
        if self._open:
            comment.child_index = len(self._open[-1].element.children)
            self._open[-1].comments.append(comment)
        else:
            self._outside.append(comment)

    def _after(self, closing: str, at: int, what: str, skip: int) -> int:
        """The offset after `closing`, looked for from `skip` characters behind `at`."""
        self._count_items(1, at)
        end = self._text.find(closing, at + skip)
        if end < 0:
            raise self._report.stop(at, "unclosed", f"{what} is never closed", expected=closing, found="the end of the file")
        return end + len(closing)

    def _start_tag(self, at: int) -> int:
        name = _TAG.match(self._text, at + 1)
        if name is None:
            mend = "write a < that is text as &lt;"
            raise self._report.stop(at, "xml-syntax", "no tag begins here", expected="a name after <", found=self._report.found(at), mend=mend)
        element = XmlElement(name.group(), self._source, at, self._open[-1].element if self._open else None, {}, [])
        self._admit(element)
        after = self._attributes(element, name.end())
        if self._text[after - 2] != "/":
            self._open.append(OpenElement(element))
        return after

    def _admit(self, element: XmlElement) -> None:
        self._elements_left -= 1
        if self._elements_left < 0:
            what, most = "the file has too many elements", f"at most {self._max_elements}"
            raise self._report.stop(element.start, "too-many-nodes", what, expected=most, found="more")
        if len(self._open) >= self._max_depth:
            what, most = "elements are nested too deeply", f"at most {self._max_depth} levels"
            raise self._report.stop(element.start, "too-deep", what, expected=most, found="more")
        if element.parent is not None:
            element.parent.children.append(element)
        elif self._root is not None:
            what = f"a second root element <{element.tag}>"
            raise self._report.stop(element.start, "xml-syntax", what, expected=f"nothing after </{self._root.tag}>", found=f"<{element.tag}>")
        else:
            self._root = element

    def _attributes(self, element: XmlElement, at: int) -> int:
        """Read the attributes up to and including `>` or `/>`; the offset after it."""
        attributes, source = element.attributes, self._source
        while found := _ATTRIBUTE.match(self._text, at):
            at = found.end()
            name, quoted = found.groups()
            if name is None:
                return at
            start = found.start(1)
            if name in attributes:
                self._report.duplicate_attribute(element, name, start)
                self._count_items(DUPLICATE_COST, start)
            value = quoted[1:-1]
            self._count_items(1 + value.count("&"), start)
            attributes[name] = XmlAttribute(name, decoded(value) if "&" in value else value, source, start, found.start(2) + 1)
        raise self._report.bad_attribute(element, at)

    def _end_tag(self, at: int) -> int:
        found = _END_TAG.match(self._text, at)
        if found is None:
            raise self._report.stop(at, "xml-syntax", "this end tag is not complete", expected="</name>", found=self._report.found(at))
        name = found.group(1)
        if not self._open:
            raise self._report.stop(at, "mismatched-tag", f"</{name}> closes nothing", expected="no end tag", found=f"</{name}>")
        inner = self._open.pop()
        if inner.element.tag != name:
            raise self._report.mismatched_tag(inner.element, name, at, [outer.element for outer in self._open])
        inner.close()
        return found.end()

    def _character_data(self, start: int, end: int) -> None:
        if not self._open:
            self._refuse_text(start, end)
            return
        at = start
        if self._text.find("&", start, end) >= 0:
            for entity in ENTITY.finditer(self._text, start, end):  # each run between entities keeps its own place
                self._add_text(self._text[at : entity.start()], at)
                self._add_text(character(entity), entity.start())
                at = entity.end()
        self._add_text(self._text[at:end], at)

    def _refuse_text(self, start: int, end: int) -> None:
        """Only blanks may stand outside the root element."""
        first = self._report.after_blanks(start, end)
        if first < end:
            what = f"text {'before' if self._root is None else 'after'} the root element"
            raise self._report.stop(first, "xml-syntax", what, expected="a tag that begins with <", found=self._report.found(first))

    def _add_text(self, piece: str, start: int) -> None:
        if not self._open:
            self._refuse_text(start, start + len(piece))
        elif piece:
            self._count_items(1, start)
            inner = self._open[-1]
            inner.runs.append((inner.length, start))
            inner.pieces.append(piece)
            inner.length += len(piece)

    def _count_items(self, count: int, at: int) -> None:
        self._items_left -= count
        if self._items_left < 0:
            what, most = "the file has too many attributes, entities, comments and pieces of text", ITEMS_PER_ELEMENT * self._max_elements
            raise self._report.stop(at, "too-many-nodes", what, expected=f"at most {most}", found="more")
