"""The gateway's protocol under any bytes: bounded, told why, every line valid, nothing moved; however the bytes are cut."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.fuzz.effort import effort
from tests.fuzz.protocol_play import Play, deeds_that_move

PIECES = [
    b"<", b">", b"/>", b"</", b'"', b"'", b"&", b"=", b" ", b"\n", b"<ping/>", b"<stop/>", b"<stop", b"<estop reason='x'/>", b"</ping>",
    b"<ping>", b"<bye/>", b'<hello version="1.0" name="a" session="s"/>', b'<lease op="acquire" ttl_s="1"/>', b'<lease op="take"/>',
    b'<lease op="release"/>', b'<run node="GoTo" goal="1;2" id="7"/>', b'<run id="7" node="GoTo" goal="2;2"/>',
    b'<command target="drive" flags="0"><velocity>0.1 0</velocity></command>',
    b'<command target="drive" flags="0"><velocity>nan 1e400</velocity></command>', b'<subscribe topic="*" id="z"/>', b'<unsubscribe topic="*"/>',
    b'<get topic="tree"/>', b"<describe/>", b'<params op="set" rev="1"><p name="a">1</p></params>',
    b'<set topic="operator/word"><value>x</value></set>', b'<mission op="load"><root>', b"</root></mission>", b"<!--", b"-->", b"<![CDATA[",
    b"]]>", b"<!DOCTYPE a>", b"<?xml version='1.0'?>", b"<?x?>", b"&amp;", b"&x;", b"&#65;", b"&#0;", b"\xc3\xa9", b"\xc3", b"\xff", b"\x00",
    b"xmlns='a'", b"a:b", b"<a" * 20, b"x" * 200, b'<release what="estop"/>', b"<log since='0'/>", b"<why at='1'/>", b"<modules/>",
    b'<module name="slam" op="stop"/>', b"<tree format='dot'/>", b'<cancel run="r1"/>',
]  # fmt: skip
streams = st.lists(st.sampled_from(PIECES) | st.binary(max_size=6), max_size=40).map(b"".join)


def survives(data: bytes) -> None:
    """These bytes, cut where the first one says, are answered as uncut ones are."""
    whole, pieces = Play(), Play()
    cut = data[0] if data else 0
    whole.feed([data[1:]])
    pieces.feed([data[1 : 1 + cut], data[1 + cut :]])
    assert whole.heard() == pieces.heard()


FOUND = [
    b'\"\n<params op="set" rev="1"><p <ping/>name="<describe/>a">1<![CDATA[a">1</p></\xf0arams><</\xf0arams><why a\'1\'/>=lo <modules/>',
    b"<<:eas> o<?xml vers\x00ion='0.0<run id='7' node='GoTo' goal='2;2'/>'?>p=<\xff\xff",
    b"=<\xf3/><",
    b"\x20<set><value>" + bytes(40) + b"</value></set>",
]


@pytest.mark.parametrize("data", FOUND)
def test_what_was_found_stays_mended(data: bytes) -> None:
    survives(data)


@given(streams, st.lists(st.integers(1, 300), max_size=12))
@effort(600)
def test_any_bytes_are_answered_in_bounds(stream: bytes, cuts: list[int]) -> None:
    whole, pieces = Play(), Play()
    whole.feed([stream])
    parts, at = [], 0
    for cut in cuts:
        parts.append(stream[at : at + cut])
        at += cut
    pieces.feed([*parts, stream[at:]])
    assert whole.heard() == pieces.heard()
    assert whole.robot.did == pieces.robot.did


@given(streams)
@effort(400)
def test_without_a_lease_nothing_moves(stream: bytes) -> None:
    play = Play()
    play.feed([stream.replace(b"lease", b"leash")])
    play.heard()
    assert deeds_that_move(play.robot.did) == []
