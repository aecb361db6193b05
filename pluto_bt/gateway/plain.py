"""The plain messages, which are nearly all: one tag with a few attributes, perhaps flat children, printable ASCII. They need no XML parser.

`take` knows a part of XML only; what it does not know it leaves to the parser. What it takes it reads as the parser would
(tests/gateway/test_plain.py holds them against each other).
"""

from __future__ import annotations

import re

from pluto_bt.gateway.child import Child

PLAIN_ATTRIBUTES, PLAIN_DEPTH = 8, 2
_NAME = r"[A-Za-z_][A-Za-z0-9_.\-]*"
_ATTRIBUTE = f' +({_NAME})="([ !#-%\'-;=-~]*)"'  # values of printable characters, without & and <
_FEW, _MANY = (re.compile(f"[ \\t\\r\\n]*<({_NAME})" + f"(?:{_ATTRIBUTE}" * n + ")?" * n + " */?>") for n in (4, PLAIN_ATTRIBUTES))
_CHILD = re.compile(f"<({_NAME})>([ !-%'-;=?-~]*)</\\1>")  # nor with >: the parser knows where that may stand


NO_ATTRIBUTES: dict[str, str] = {}  # of most children; nobody changes it


Plain = tuple[str, dict[str, str], tuple[Child, ...], int, int]
"""Tag, attributes and children of an element, the positions of its `<` and behind it: a tuple, for this is the way of every message."""


def take(text: str, at: int) -> Plain | None:
    """The plain element that begins at `at`, white space before it or not; None for what only the parser can tell."""
    found = _FEW.match(text, at)
    if found is None:
        found = _MANY.match(text, at)
        if found is None:
            return None
        words, last = found.groups(), found.lastindex or 1
        attrib, count = dict(zip(words[1:last:2], words[2:last:2], strict=True)), last // 2
        tag: str = words[0]
    else:  # the same without loops
        tag, a, for_a, b, for_b, c, for_c, d, for_d = found.groups()
        if b is None:
            attrib, count = ({}, 0) if a is None else ({a: for_a}, 1)
        elif c is None:
            attrib, count = {a: for_a, b: for_b}, 2
        else:
            attrib, count = ({a: for_a, b: for_b, c: for_c}, 3) if d is None else ({a: for_a, b: for_b, c: for_c, d: for_d}, 4)
    if len(attrib) != count or "xmlns" in attrib:  # one stands twice, or declares a name-space
        return None
    start, end = at if text[at] == "<" else found.start(1) - 1, found.end()
    if text[end - 2] == "/":
        return tag, attrib, (), start, end
    close = text.find(f"</{tag}>", end)
    inner = _CHILD.findall(text, end, close) if close > end else None
    if not inner or sum([2 * len(name) + len(word) for name, word in inner]) + 5 * len(inner) != close - end:  # something stands between them
        return None
    return tag, attrib, tuple([Child(name, NO_ATTRIBUTES, word) for name, word in inner]), start, close + len(tag) + 3
