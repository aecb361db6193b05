"""What libxml2 complains of, in the words of the protocol."""

from __future__ import annotations

import re

from lxml import etree

_HARMLESS = re.compile(rb"<!--.*?-->|<!\[CDATA\[.*?\]\]>", re.DOTALL)
_NO_TAG = re.compile(rb"<[^A-Za-z_:/?\x80-\xff]")
_BAD_NAME = 68  # libxml2: a tag that does not begin with a name
_ENTITY_CODES = frozenset({26, 27, 28})  # libxml2: undeclared entity (error, warning), unparsed entity
_CODES = {81: "bad-encoding", 6: "bad-encoding", 32: "bad-encoding", 64: "restricted-xml", 114: "too-deep"}


def complaint(error: etree.XMLSyntaxError, raw: bytes | bytearray) -> tuple[str, str]:
    """The protocol's code and a text for a syntax error in the message that began with `raw`."""
    number = int(getattr(error, "code", 0))
    code = _CODES.get(number, "not-well-formed")
    bad_tag = _NO_TAG.search(_HARMLESS.sub(b"", raw)) if number == _BAD_NAME else None
    if number in _ENTITY_CODES or (bad_tag is not None and bad_tag[0] == b"<!"):
        code = "restricted-xml"
    text = re.sub(r", line \d+, column \d+.*", "", (error.msg or "not well-formed").strip(), flags=re.DOTALL).strip()
    text = re.sub(r" line \d+", "", text)  # libxml2 counts from our private root
    if code == "restricted-xml":
        text += "; no document type, entity (but the five predefined) or processing instruction may stand in a message"
    return code, text
