"""How a text that is not XML is explained: each function notes what is wrong at an offset and returns the exception that ends the reading."""

from __future__ import annotations

import re

from pluto_bt.source.faults import Faults, did_you_mean
from pluto_bt.source.text import SourceText
from pluto_bt.source.xml_tree import XmlElement

NAME = r"[A-Za-z_:\x80-\U0010FFFF][A-Za-z0-9_:.\-\x80-\U0010FFFF]*+"
_ATTRIBUTE_NAME = re.compile(rf"\s*+({NAME})(\s*+=\s*+)?")
_WORD = re.compile(r"[^\s<>]{1,40}+")
_BLANK = re.compile(r"\s*+")


class XmlSyntaxError(Exception):
    """A fault after which reading on makes no sense; it is already noted."""


class XmlReport:
    """The text that is read and the faults found in it."""

    def __init__(self, source: SourceText, faults: Faults) -> None:
        self.source, self.text, self.faults = source, source.text, faults

    def stop(self, at: int, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> XmlSyntaxError:
        """Note a fault at offset `at`; raising what is returned ends the reading."""
        self.faults.error(self.source.place(at), code, message, expected=expected, found=found, mend=mend)
        return XmlSyntaxError()

    def found(self, at: int) -> str:
        """What stands at `at`."""
        if at >= len(self.text):
            return "the end of the file"
        word = _WORD.match(self.text, at + 1 if self.text[at] in "<>" else at)
        return self.text[at : word.end()] if word else self.text[at].strip() or "a blank"

    def after_blanks(self, at: int, end: int) -> int:
        """The offset of the first character from `at` on that is not blank, `end` if there is none."""
        blanks = _BLANK.match(self.text, at, end)
        return blanks.end() if blanks else at

    def duplicate_attribute(self, element: XmlElement, name: str, at: int) -> None:
        """The one fault after which reading goes on."""
        first = element.attributes[name].place
        what, found = f'attribute "{name}" stands twice in <{element.tag}>', f"the first is in line {first.line}, column {first.column}"
        self.faults.error(self.source.place(at), "duplicate-attribute", what, expected="each attribute once", found=found, mend="delete one")

    def bad_attribute(self, element: XmlElement, at: int) -> XmlSyntaxError:
        """Say what is wrong at `at`, where an attribute or the end of the tag was expected."""
        mend = _forgotten_quote(element)
        name = _ATTRIBUTE_NAME.match(self.text, at)
        if name is None:
            return self._bad_tag_end(element, self.after_blanks(at, len(self.text)), mend)
        word, after = name.group(1), name.end()
        if name.group(2) is None:
            what = f'attribute "{word}" has no value'
            return self.stop(name.start(1), "xml-syntax", what, expected=f'{word}="…"', found=self.found(after), mend=mend)
        quote = self.text[after : after + 1]
        if quote in ("'", '"'):
            what = f'the value of attribute "{word}" is never closed'
            return self.stop(after, "missing-quote", what, expected=f"a closing {quote}", found="the end of the file", mend=mend)
        what = f'the value of attribute "{word}" has no quotes'
        return self.stop(after, "missing-quote", what, expected=f'{word}="…"', found=self.found(after), mend=mend)

    def _bad_tag_end(self, element: XmlElement, at: int, mend: str) -> XmlSyntaxError:
        if at >= len(self.text) or self.text[at] == "<":
            return self.stop(element.start, "unclosed-tag", f"the tag <{element.tag} has no >", expected="> or />", found=self.found(at), mend=mend)
        expected = 'an attribute name="value", > or />'
        return self.stop(at, "xml-syntax", f"this is no attribute of <{element.tag}>", expected=expected, found=self.found(at), mend=mend)

    def mismatched_tag(self, element: XmlElement, name: str, at: int, outer: list[XmlElement]) -> XmlSyntaxError:
        """`</name>` stands at `at` where `element` should be closed; `outer` are the elements around it."""
        opened = element.place
        where = f"line {opened.line}, column {opened.column}"
        mend = did_you_mean(name, [element.tag])
        if any(other.tag == name for other in outer):
            mend = f"close <{element.tag}> of {where} first, or write it as <{element.tag} …/>"
        what = f"</{name}> does not close <{element.tag}>, which was opened in {where}"
        return self.stop(at, "mismatched-tag", what, expected=f"</{element.tag}>", found=f"</{name}>", mend=mend)


def _forgotten_quote(element: XmlElement) -> str:
    """A forgotten quote is closed by the opening one of the next attribute: then the value holds a `=` or a tag."""
    last = next(reversed(element.attributes.values()), None)
    if last is None or not any(sign in last.value for sign in "=<>"):
        return ""
    return f'is the closing quote of attribute "{last.name}" in line {last.place.line} missing?'
