"""The stream of messages: however it is cut, the same messages; whatever is sent, a bounded error."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.bench.resident import resident_mb
from pluto_bt.gateway.framing import Framer, FramingError, Message
from pluto_bt.gateway.limits import Limits

LIMITS = Limits()
Seen = list[tuple[str, int, int, dict[str, str]]]


def run(pieces: list[bytes], limits: Limits = LIMITS) -> tuple[Seen, FramingError | None]:
    """The messages and the error that these pieces lead to."""
    framer = Framer(limits)
    seen: list[Message] = []
    try:
        for piece in pieces:
            seen.extend(framer.feed(piece))
    except FramingError as error:
        return [(message.tag, message.line, message.column, message.attrib) for message in seen], error
    return [(message.tag, message.line, message.column, message.attrib) for message in seen], None


def bytewise(data: bytes) -> list[bytes]:
    return [data[i : i + 1] for i in range(len(data))]


@pytest.mark.parametrize(
    ("stream", "tags"),
    [
        (b"<ping/>", ["ping"]),
        (b'<?xml version="1.0" encoding="UTF-8"?>\r\n<ping/>\n<stop />', ["ping", "stop"]),
        (b"<?xml version='1.0'?><ping/>", ["ping"]),
        (b"<ping/><ping></ping><ping\n/>", ["ping", "ping", "ping"]),
        (b'<ping t="a>b"/><ping t=\'"/>\'/>', ["ping", "ping"]),
        (b"<ping><!-- </ping> --><![CDATA[</ping>]]></ping ><stop/>", ["ping", "stop"]),
        ("<ping t='é\U0001f916'/>".encode(), ["ping"]),
        (b"<ping t='&lt;&amp;&#65;&quot;'/>", ["ping"]),
        (b"  \t\r\n", []),
        (b"<a><a><a/></a></a>", ["a"]),
    ],
)
def test_complete_messages_come_as_soon_as_their_last_byte(stream: bytes, tags: list[str]) -> None:
    seen, error = run([stream])
    assert ([tag for tag, *_ in seen], error) == (tags, None)
    assert run(bytewise(stream)) == (seen, None)


def test_a_message_knows_where_it_began_in_the_stream() -> None:
    seen, _ = run(["<a/> <é/>\n\n  <b\n/><c/>".encode()])
    assert [(tag, line, column) for tag, line, column, _ in seen] == [("a", 1, 1), ("é", 1, 6), ("b", 3, 3), ("c", 4, 3)]


BIG = 64 * 1024
ATTACKS = [
    # bytes                                                                     code               line, column
    (b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "restricted-xml", 1, 1),
    (b'<?xml version="1.0"?><!DOCTYPE a SYSTEM "file:///etc/passwd"><a/>', "restricted-xml", 1, 22),
    (b"<a><!DOCTYPE a></a>", "restricted-xml", 1, 6),
    (b"<a>&b;</a>", "restricted-xml", 1, 4),
    (b'<a b="&c;"/>', "restricted-xml", 1, 1),
    (b"<a><?php x?></a>", "restricted-xml", 1, 1),
    (b"<?php x?><a/>", "restricted-xml", 1, 1),
    (b'<a/><?xml version="1.0"?>', "restricted-xml", 1, 5),
    (b' <?xml version="1.0"?>', "restricted-xml", 1, 2),
    (b'<?xml version="1.0" encoding="UTF-16"?><a/>', "bad-encoding", 1, 1),
    ("<a/>".encode("utf-16"), "bad-encoding", 1, 1),
    ("<a/>".encode("utf-16-le"), "bad-encoding", 1, 1),
    ("<a/>".encode("utf-16-be"), "bad-encoding", 1, 1),
    (b"<a>\xff</a>", "bad-encoding", 1, 4),
    (b"<a b='\xc3('/>", "bad-encoding", 1, 7),
    (b"<a>\xed\xa0\x80</a>", "bad-encoding", 1, 4),
    (b"<\xf3/>", "bad-encoding", 1, 1),
    (b"<a></\xe2\x82>", "bad-encoding", 1, 6),
    (b"<a>\x00</a>", "not-well-formed", 1, 4),
    (b"<a>&#0;</a>", "not-well-formed", 1, 4),
    (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n", "not-well-formed", 1, 1),
    (b"\x16\x03\x01\x02\x00", "not-well-formed", 1, 1),
    (b"SSH-2.0-OpenSSH_9.2\r\n", "not-well-formed", 1, 1),
    (b"<a/>\nrubbish", "not-well-formed", 2, 1),
    (b"<a/></a>", "not-well-formed", 1, 5),
    (b"</private>", "not-well-formed", 1, 1),
    (b"<a></private>", "not-well-formed", 1, 6),
    (b"<!-- between -->", "not-well-formed", 1, 1),
    (b"<![CDATA[x]]>", "not-well-formed", 1, 1),
    (b"<a>\n  <b></a>", "not-well-formed", 2, 8),
    (b"<a b='1' b='2'/>", "not-well-formed", 1, 10),
    (b"<a b=1/>", "not-well-formed", 1, 6),
    (b"<1/>", "not-well-formed", 1, 1),
    (b"<a><b></c d='<e>", "not-well-formed", 1, 11),  # said before anything else has come
    (b"<a b='x><c", "not-well-formed", 1, 9),
    (b"<a b=c\n<d", "not-well-formed", 1, 6),
    (b"<ping/><" + b"n" * BIG, "too-large", 1, 8),
    (b"<a " + b"n" * BIG, "too-large", 1, 1),
    (b"<a b='" + b"v" * BIG, "too-large", 1, 1),
    (b"<a b='" + b">" * BIG, "too-large", 1, 1),
    (b"<a>" + b"t" * BIG, "too-large", 1, 1),
    (b"<a><!--" + b"c" * BIG, "too-large", 1, 1),
    (b"<a><![CDATA[" + b"</a>" * (BIG // 4), "too-large", 1, 1),
    (b" " * (BIG + 1), "too-large", 1, BIG + 1),
    (b"<a>" + b"<b/>" * BIG, "too-large", 1, 1),
    (b"<mission>" + b"t" * (1024 * 1024), "too-large", 1, 1),
    (b"<a " + b" ".join(b"a%d='1'" % i for i in range(33)) + b"/>", "too-large", 1, 1),
    (b"<a " + b" ".join(b"xmlns:a%d='1'" % i for i in range(33)) + b"/>", "too-large", 1, 1),
    (b"<a>" * 17, "too-deep", 1, 1),
    (b"<mission>" + b"<a>" * 257, "too-deep", 1, 1),
]


@pytest.mark.parametrize(("stream", "code", "line", "column"), ATTACKS, ids=[repr(attack[0][:40]) for attack in ATTACKS])
def test_an_attack_gets_its_code_and_place(stream: bytes, code: str, line: int, column: int) -> None:
    _, error = run([stream])
    assert error is not None
    assert (error.code, error.line, error.column) == (code, line, column), error.text
    if len(stream) < 2 * BIG:
        _, bit_by_bit = run(bytewise(stream))
        assert bit_by_bit is not None and bit_by_bit.code == code


def test_limits_let_pass_what_is_just_within_them() -> None:
    for stream in (
        b"<a>" + b"t" * (BIG - 7) + b"</a>",
        b"<a " + b" ".join(b"a%d='1'" % i for i in range(32)) + b"/>",
        b"<a>" * 16 + b"</a>" * 16,
        b"<mission>" + b"<a>" * 256 + b"</a>" * 256 + b"</mission>",
        b"<mission>" + b"t" * (1024 * 1024 - 19) + b"</mission>",
        b" " * (BIG - 4) + b"<a/>",
    ):
        seen, error = run([stream, b"<ping/>"])
        assert error is None and len(seen) == 2, (error and error.text, stream[:20])


NAMING = ["<n{name}><!-- --></n{name}>", '<ping n{name}="&amp;"/>', '<ping xmlns:n="{name}"/>', "<ping><n{name}/><!-- --></ping>"]


@pytest.mark.parametrize("form", NAMING)
def test_new_names_leave_nothing_behind(form: str) -> None:
    before_mb = resident_mb()
    for number in range(500):
        run([form.format(name=f"{number}." + "x" * 20_000).encode()])  # 20 MB of names
    assert resident_mb() - before_mb < 5.0


def test_strangers_are_told_what_this_port_is() -> None:
    assert "not an HTTP server" in str(run([b"POST / HTTP/1.1"])[1])
    assert "looks like TLS" in str(run([b"\x16\x03\x01"])[1])


WORDS = st.sampled_from([
    b"<", b">", b"/>", b"<a>", b"</a>", b"<a/>", b"<mission>", b"</mission>", b"<!--", b"-->", b"<![CDATA[", b"]]>", b"<?xml version='1.0'?>",
    b"&amp;", b"&x;", b"<!DOCTYPE", b"<?p?>", b' b="', b"'", b'"', b"\n", b" ", b"text", "é".encode(), b"\xff", b"\x00", b"<a b='1' c=\"&gt;\">",
    b"x" * 70,
])  # fmt: skip


@settings(max_examples=300, deadline=None)
@given(st.lists(WORDS, max_size=30), st.data())
def test_a_stream_cut_anywhere_gives_what_the_whole_stream_gives(words: list[bytes], data: st.DataObject) -> None:
    small = Limits(message_bytes=200, mission_bytes=400, depth=4, mission_depth=6)
    stream = b"".join(words)
    whole, fault = run([stream], small)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=8)))
    pieces = [stream[i:j] for i, j in zip([0, *cuts], [*cuts, len(stream)], strict=True)]
    for cut in (pieces, bytewise(stream)):
        parts, error = run(cut, small)
        assert parts == whole
        assert (error and error.code) == (fault and fault.code)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=400))
def test_rubbish_never_raises_anything_else(rubbish: bytes) -> None:
    run([rubbish])
    run([b"<a " + rubbish])
