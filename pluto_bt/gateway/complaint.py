"""What libxml2 complains of, in the words of the protocol."""

from __future__ import annotations

import re

from lxml import etree

_BAD_NAME = 68  # libxml2: a tag that does not begin with a name
_ENTITY_CODES = frozenset({26, 27, 28})  # libxml2: undeclared entity (error, warning), unparsed entity
_CODES = {81: "bad-encoding", 6: "bad-encoding", 32: "bad-encoding", 64: "restricted-xml", 114: "too-deep"}


def complaint(error: etree.XMLSyntaxError, raw: bytes | bytearray) -> tuple[str, str]:
    """The protocol's code and a text for a syntax error in the message that began with `raw`."""
    number = int(getattr(error, "code", 0))
    code = _CODES.get(number, "not-well-formed")
    if number in _ENTITY_CODES or (number == _BAD_NAME and "<!" in _around(error, raw)):
        code = "restricted-xml"
    text = re.sub(r", line \d+, column \d+.*", "", (error.msg or "not well-formed").strip(), flags=re.DOTALL).strip()
    text = re.sub(r" line \d+", "", text)  # libxml2 counts from our private root
    if code == "restricted-xml":
        text += "; no document type, entity (but the five predefined) or processing instruction may stand in a message"
    return code, text


def _around(error: etree.XMLSyntaxError, raw: bytes | bytearray) -> str:
    """The few characters at the place of the error, however much came behind it; libxml2 counts from our private root's line."""
    line, column = error.position
    lines = bytes(raw).split(b"\n", max(0, line - 1))
    text = lines[line - 2].decode("utf-8", "replace") if 0 <= line - 2 < len(lines) else ""
    return text[max(0, column - 3) : column + 1]
