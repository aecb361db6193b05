"""The formatter: whatever can be read keeps its meaning, and a second time nothing changes."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given

from pluto_bt.source import Faults
from pluto_bt.source.xml_reader import XmlComment, XmlDocument, XmlElement, read_document
from pluto_bt.source.xml_writer import written
from tests.fuzz.effort import effort
from tests.fuzz.xml_trees import documents


def read(text: str) -> XmlDocument | None:
    return read_document(text, "", faults) if not (faults := Faults()) else None


def meaning(document: XmlDocument) -> Any:
    """All that must survive: tags, attributes in order, texts and comments in their order, blanks at the edges of texts left out."""
    return [_comment(one) for one in document.outside], _element(document.root)


def _comment(comment: XmlComment) -> Any:
    return comment.is_instruction, [line.strip() for line in comment.text.split("\n")]


def _element(element: XmlElement) -> Any:
    attributes = [(one.name, one.value) for one in element.attributes.values()]
    comments = [(one.child_index, _comment(one)) for one in element.comments]
    return element.tag, attributes, comments, "".join(element.text.split()), [_element(child) for child in element.children]


def holds(text: str) -> None:
    """A text that can be read is written with the same meaning, and what is written is canonical."""
    document = read(text)
    if document is None:
        return
    once = written(document)
    again = read(once)
    assert again is not None
    assert meaning(again) == meaning(document)
    assert written(again) == once


@given(documents())
@effort(400)
def test_formatting_keeps_the_meaning_and_is_stable(text: str) -> None:
    holds(text)


FOUND = [
    "<a>\n<!--x--> <b/>\n</a>",
    "<a><!--x\n  y--></a>",
    "<a>t<!--x-->u</a><!-- after -->",
    "<a>\n\n\n<b/>\n\n\n<!--c-->\n\n</a>",
    "<a x='&#13;&#10;\n\t&#9;&#1;'/>",
    "<a><![CDATA[]]]]><![CDATA[>]]></a>",
    "<a>x &lt; y ]]&gt; z</a>",
    "<?xml version='1.0'?><!--a\nb--><a/>",
    "<a><b/><!-- behind\n   more --> text <?pi x?></a>",
    "<a><?xml-like x?></a>",
]


@pytest.mark.parametrize("text", FOUND)
def test_cases_that_needed_thought(text: str) -> None:
    assert read(text) is not None
    holds(text)
