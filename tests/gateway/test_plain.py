"""What is read without a parser is read as the parser reads it, and what the parser refuses is not read without it."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from pluto_bt.gateway.framing import Framer, FramingError
from pluto_bt.gateway.limits import Limits
from pluto_bt.gateway.plain import PLAIN_ATTRIBUTES, take

BY_PARSER = Limits(attributes=PLAIN_ATTRIBUTES - 1)
MIXED = Limits(attributes=PLAIN_ATTRIBUTES)

words = st.sampled_from(["a", "ping", "p", "_b", "c.d", "e-f", "xmlns", "x:y", "1a", "é", "", "mission"])
texts = st.text(alphabet="az 09;.,>'=/?-_&<\n\t\r\"]\x00\x7fé", max_size=8)
spaces = st.sampled_from(["", " ", "  ", "\n", "\t"])
attributes = st.builds(lambda space, name, text, quote: f"{space}{name}={quote}{text}{quote}", spaces, words, texts, st.sampled_from("\"'"))
starts = st.builds(lambda name, given, space: name + "".join(given) + space, words, st.lists(attributes, max_size=4), spaces)
children = st.builds(lambda name, end, text: f"<{name}>{text}</{end or name}>", starts, st.sampled_from(["", "", "", "a"]), texts)
empties = st.builds("<{}/>".format, starts)
flats = st.builds(lambda start, inner: f"<{start}>{''.join(inner)}</{start.split(' ')[0]}>", starts, st.lists(children | texts, max_size=3))
streams = st.lists(empties | flats | spaces, min_size=1, max_size=3).map(lambda pieces: "".join(pieces).encode())


def read(stream: bytes, limits: Limits) -> tuple[list[object], str]:
    """All messages up to the end or to the first fault, and the fault's code."""
    seen: list[object] = []
    try:
        for message in Framer(limits).feed(stream):
            seen.append((message.tag, message.attrib, message.children, message.text, message.line, message.column))
    except FramingError as error:
        return seen, f"{error.code} {error.line}:{error.column}"
    return seen, ""


@given(streams)
@settings(max_examples=400)
def test_a_stream_is_read_alike_with_and_without_the_parser(stream: bytes) -> None:
    assert read(stream, MIXED) == read(stream, BY_PARSER)


def test_usual_requests_need_no_parser() -> None:
    for message in (
        "<stop/>", '<get topic="Localization/Pose" id="c12"/>', '\n<lease op="acquire" ttl_s="2" on_loss="stop"/>',
        '<command target="motion" flags="32"><position>1.5 -2e3</position><velocity>0.5 0</velocity></command>',
    ):  # fmt: skip
        assert take(message, 0) is not None
