"""Random XML: documents as trees, written in a careless hand."""

from __future__ import annotations

from hypothesis import strategies as st

NAMES = st.sampled_from(["root", "Sequence", "GoTo", "x", "BehaviorTree", "ä", "ns:tag", "a.b-c"])
KEYS = ["ID", "name", "goal", "code", "_skipIf", "x", "BTCPP_format", "ü"]
BLANKS = st.sampled_from(["", " ", "\n", "\n\n", "\t", "\n\n\n    ", "  \n  "])
CHARACTERS = st.sampled_from([*"ab1;{}=<&'\"\n\t>-?!]é→ ", "&amp;", "&lt;", "&quot;", "&#10;", "&#9;", "&#13;", "&#x41;", "&foo;", "]]>", "--"])
VALUES = st.lists(CHARACTERS, max_size=8).map("".join)


@st.composite
def attributes(draw: st.DrawFn) -> str:
    """Attributes with either quote."""
    words = []
    for key in draw(st.lists(st.sampled_from(KEYS), max_size=4, unique=True)):
        quote = draw(st.sampled_from("\"'"))
        value = draw(VALUES).replace(quote, "")
        words.append(f"{draw(BLANKS) or ' '}{key}{draw(BLANKS)}={draw(BLANKS)}{quote}{value}{quote}")
    return "".join(words)


COMMENTS = VALUES.map(lambda text: f"<!--{text.replace('-->', '')}-->")
INSTRUCTIONS = VALUES.map(lambda text: f"<?pi {text.replace('?>', '')}?>")
CDATA = VALUES.map(lambda text: f"<![CDATA[{text.replace(']]>', '')}]]>")
TEXTS = VALUES.map(lambda text: text.replace("<", ""))


@st.composite
def elements(draw: st.DrawFn, depth: int = 3) -> str:
    """One element with what may stand inside."""
    name = draw(NAMES)
    head = f"<{name}{draw(attributes())}{draw(BLANKS)}"
    inner = [COMMENTS, INSTRUCTIONS, CDATA, TEXTS, BLANKS, *([elements(depth - 1)] * 3 if depth else [])]
    content = "".join(draw(st.lists(st.one_of(inner), max_size=5)))
    return f"{head}>{content}</{name}{draw(BLANKS)}>" if content or draw(st.booleans()) else f"{head}/>"


@st.composite
def documents(draw: st.DrawFn) -> str:
    """A whole file."""
    around = st.lists(st.one_of(COMMENTS, INSTRUCTIONS, BLANKS), max_size=3).map("".join)
    return draw(st.sampled_from(["", "<?xml version='1.0'?>", "\ufeff"])) + draw(around) + draw(elements()) + draw(around)
