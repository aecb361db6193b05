"""What expat complains of, in the words of the protocol."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.parsers import expat

_INVALID_TOKEN, _MISMATCH = 4, 7
_CODES = {11: "restricted-xml", 17: "restricted-xml", 30: "restricted-xml"}  # an undefined entity, an XML declaration in the middle
_WORD = re.compile(rb"[^\s<>/&;\"']*")
_SHOWN_BYTES = 40


def complaint(number: int, raw: bytes | bytearray, at: int, open_tags: Sequence[str]) -> tuple[str, str]:
    """The protocol's code and a text for expat's error `number` at byte `at` of the message `raw`, inside the elements `open_tags`."""
    code, word = _CODES.get(number, "not-well-formed"), _word(raw, at)
    if number == _MISMATCH and open_tags:
        return code, f"expected </{open_tags[-1][:_SHOWN_BYTES]}>, found </{word}>"
    if number == _INVALID_TOKEN:  # one character is shown: what follows it may not have come yet
        if not _is_utf8(raw, at):
            return "bad-encoding", f"expected UTF-8, found the byte 0x{raw[at]:02x}"
        code = "restricted-xml" if raw[max(0, at - 2) : at] == b"<!" else code
        word = raw[at : at + 4].decode("utf-8", "ignore")[:1]
    text = f"{expat.ErrorString(number)}, found {word!r}"
    if code == "restricted-xml":
        text += "; no document type, entity (but the five predefined) or processing instruction may stand in a message"
    return code, text


def _word(raw: bytes | bytearray, at: int) -> str:
    """What stands at the place of the error, shortened."""
    found = _WORD.match(raw, at + (raw[at : at + 1] in (b"<", b"&")))
    return bytes(found[0][:_SHOWN_BYTES]).decode("utf-8", "replace") if found else ""


def _is_utf8(raw: bytes | bytearray, at: int) -> bool:
    """True if a character begins at the byte `at`."""
    try:
        raw[at : at + 4].decode()
    except UnicodeDecodeError as error:
        return error.start > 0
    return True
