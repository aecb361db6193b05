"""The first bytes of what stands between messages: does a message begin, is it the XML declaration, or a stranger?"""

from __future__ import annotations

import re
from typing import Literal

_NAME_START = re.compile(rb"[A-Za-z_:\x80-\xff]")
_DECLARATION = re.compile(
    rb"""<\?xml\s+version\s*=\s*["']1\.[0-9]["'](?:\s+encoding\s*=\s*["']([A-Za-z][A-Za-z0-9._-]*)["'])?(?:\s+standalone\s*=\s*["'](?:yes|no)["'])?\s*\?>"""
)
_DECLARATION_BYTES = 256


class OpeningError(Exception):
    """These bytes open nothing. `code` is one of the fatal codes."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


def opening(head: bytes, *, is_first: bool) -> Literal["message", "declaration", ""]:
    """What `head` opens; "" if more bytes are needed to tell.

    Args:
        head: from the first byte on that is no white space.
        is_first: nothing was sent before it.
    Raises: OpeningError.
    """
    if head[:1] != b"<":
        raise _stranger(head, is_first)
    if len(head) == 1:
        return ""
    if _NAME_START.match(head, 1):
        return "message"
    if head[1:2] == b"?":
        return "declaration" if _is_declaration(head, is_first) else ""
    if head[1:2] != b"!":
        code = "bad-encoding" if head[1:2] == b"\0" else "not-well-formed"
        raise OpeningError(code, f"expected the name of an element after '<', found {head[1:2]!r}")
    if len(head) > 2:
        code = "not-well-formed" if head[2:3] in b"-[" else "restricted-xml"
        raise OpeningError(code, "expected an element; comments and CDATA stand inside messages only, declarations (DOCTYPE, ENTITY) nowhere")
    return ""


def _is_declaration(head: bytes, is_first: bool) -> bool:
    """True for a whole XML declaration; one may open the stream, and is cut off."""
    could_be = b"<?xml".startswith(head[:5]) if len(head) <= 5 else head[:5] == b"<?xml"
    if not is_first or not could_be or (len(head) == 6 and head[5:] not in b" \t\r\n"):
        text = "expected an element, found a processing instruction (or an XML declaration that is not the first thing sent)"
        raise OpeningError("restricted-xml", text)
    if not head.endswith(b"?>"):
        if len(head) > _DECLARATION_BYTES:
            raise OpeningError("not-well-formed", "expected '?>' at the end of the XML declaration")
        return False
    found = _DECLARATION.fullmatch(head)
    if not found:
        raise OpeningError("not-well-formed", 'expected <?xml version="1.0" encoding="UTF-8"?>')
    encoding = (found[1] or b"UTF-8").decode("ascii")
    if encoding.upper() not in ("UTF-8", "US-ASCII"):
        raise OpeningError("bad-encoding", f"expected encoding UTF-8, found {encoding}")
    return True


def _stranger(head: bytes, is_first: bool) -> OpeningError:
    """The error for a byte that opens nothing, with a hint for the usual strangers."""
    byte = head[0]
    if byte in (0x00, 0xFE, 0xFF) and is_first:
        return OpeningError("bad-encoding", "expected UTF-8, found what looks like UTF-16 or UTF-32")
    hint = ""
    if byte == 0x16:
        hint = "; this looks like TLS, and this port speaks plain text"
    elif head in (b"G", b"P", b"H", b"O", b"D") and is_first:
        hint = "; this is not an HTTP server"
    shown = repr(chr(byte)) if 0x20 <= byte < 0x7F else f"byte 0x{byte:02x}"
    return OpeningError("not-well-formed", f"expected '<' or white space between messages, found {shown}{hint}")
