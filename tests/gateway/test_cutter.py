"""Where a message may be cut: whole tags and texts only, its end and no byte further, and every byte looked at once."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.gateway.cutter import Cutter

LONGEST_DELIMITER = len(b"<![CDATA[")


@pytest.mark.parametrize(
    ("message", "safe"),
    [
        (b"<a", 0), (b"<a>", 3), (b"<a>text", 7), (b"<a>te&x", 5), (b"<a>te&x;<", 8), (b"<a><b c='>' d=\"'/>", 3), (b"<a><!-- > </a> -", 3),
        (b"<a><!-- </a> -->", 16), (b"<a><![CDATA[</a>]]", 3), (b"<a><![CDATA[</a>]]>", 19), (b"<a><?x </a>?>", 13), (b"<a><![CDA", 3),
        (b"<a><!D>", 7), (b"<a><!-->", 3),
    ],
)  # fmt: skip
def test_the_parser_gets_what_is_whole(message: bytes, safe: int) -> None:
    cutter = Cutter()
    cutter.advance(bytearray(message))
    assert (cutter.safe, cutter.is_end) == (safe, False)


@pytest.mark.parametrize(
    "message",
    [
        b"<a/>", b"<a></a>", b"<a><a/></a >", b"<a b='/>'\n/>", b"<a><b/><b><c></c></b>text</a>", b"<a><!--</a>--><![CDATA[</a>]]></a>",
        b"<a><?</a>?></a>",
    ],
)  # fmt: skip
def test_the_end_of_the_message_is_found(message: bytes) -> None:
    for behind in (b"", b"<b/>", b"   <b>"):
        cutter = Cutter()
        cutter.advance(bytearray(message + behind))
        assert (cutter.safe, cutter.is_end) == (len(message), True)


WORDS = st.sampled_from([
    b"<", b">", b"/>", b"<b>", b"</b>", b"<b/>", b"'", b'"', b"<!--", b"-->", b"-", b"<![CDATA[", b"]]>", b"]", b"<?", b"?>", b"&x;", b"t",
])  # fmt: skip


@given(st.lists(WORDS, max_size=20))
def test_byte_by_byte_is_as_at_once_and_no_byte_is_looked_at_again(words: list[bytes]) -> None:
    message = b"<a>" + b"".join(words)
    whole, dripped, raw = Cutter(), Cutter(), bytearray()
    whole.advance(bytearray(message))
    for byte in message:
        raw.append(byte)
        dripped.advance(raw)
        assert dripped.is_end or dripped._at > len(raw) - LONGEST_DELIMITER, "the next byte is looked at from here on"
        if dripped.is_end:
            break
    assert (dripped.is_end, dripped.safe) == (whole.is_end, whole.safe)
