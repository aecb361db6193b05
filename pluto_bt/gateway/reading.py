"""One message while its bytes come in: expat's events to tag, attributes and children, and the bounds that show at a tag.

Its names live as long as the message. (libxml2 keeps the names of all documents in one table for good: who thinks of new ones fills the memory.)
"""

from __future__ import annotations

from xml.parsers import expat

from pluto_bt.gateway.child import Child
from pluto_bt.gateway.limits import Limits

ROOT = b"<private>\n"
"""Fed first: a DOCTYPE inside an element is a syntax error, and the message's first line is the second."""
Attributes = dict[str, str]


class RestrictedError(Exception):
    """What may not stand in a message. `code` is one of the fatal codes."""

    def __init__(self, code: str, text: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text


class Reading:
    """What is known of the message so far.

    Attributes:
        tag, attrib: of the message itself; the tag is "" until its start tag is complete. A name in a name-space is `{uri}name`.
        children, text: what is directly inside it; of a `mission` neither is told.
        open: the tags that are open, the message's own first.
        is_complete: its end has come.
    """

    def __init__(self, limits: Limits) -> None:
        self.tag = ""
        self.attrib: Attributes = {}
        self.children: list[Child] = []
        self.text = ""
        self.open: list[str] = []
        self.is_mission = self.is_complete = False
        self._limits = limits
        self._names: set[str] = set()  # of a mission, which may be long: expat keeps each until the message ends, at ten times its length
        self._declared = 0  # name-spaces of the element that is about to begin
        self._child: tuple[str, Attributes] = ("", {})
        self._child_text, self._child_is_leaf = "", True

    def parser(self) -> expat.XMLParserType:
        """A parser that tells us what comes; it knows us, we do not know it, so that both go when the connection does."""
        parser = expat.ParserCreate("utf-8", "}")
        parser.buffer_text = True
        getattr(parser, "SetReparseDeferralEnabled", bool)(False)  # newer ones wait for more where a tag came in two pieces
        parser.Parse(ROOT, False)
        parser.StartNamespaceDeclHandler = self._declare
        parser.StartElementHandler, parser.EndElementHandler = self._begin, self._end
        parser.CharacterDataHandler, parser.ProcessingInstructionHandler = self._characters, self._instruction
        return parser

    # expat's calls -----------------------------------------------------------------------------------------------
    def _declare(self, prefix: str | None, uri: str | None) -> None:
        self._declared += 1
        if self.is_mission:
            self._names.add(f"xmlns:{prefix}")

    def _begin(self, name: str, attributes: Attributes) -> None:
        """Raises: RestrictedError beyond a bound."""
        name = _shown(name)
        self.open.append(name)
        depth = len(self.open)
        if depth == 1:
            self.tag, self.attrib, self.is_mission = name, _all_shown(attributes), name == "mission"
        elif depth == 2:
            self._child, self._child_text, self._child_is_leaf = (name, attributes), "", True
        else:
            self._child_is_leaf = False
        count, self._declared = len(attributes) + self._declared, 0
        self._require_bounds(depth, count)
        if self.is_mission:
            self._require_few_names(name, attributes)

    def _require_bounds(self, depth: int, attributes: int) -> None:
        limit = self._limits.mission_depth + 1 if self.is_mission else self._limits.depth
        if depth > limit:
            raise RestrictedError("too-deep", f"expected at most {limit} elements inside each other")
        if attributes > self._limits.attributes:
            raise RestrictedError("too-large", f"expected at most {self._limits.attributes} attributes, found {attributes}")

    def _require_few_names(self, name: str, attributes: Attributes) -> None:
        self._names.add(name)
        self._names.update(attributes)
        if len(self._names) > self._limits.names:
            raise RestrictedError("too-large", f"expected at most {self._limits.names} different names in a mission")

    def _end(self, name: str) -> None:
        self.open.pop()
        if not self.open:
            self.is_complete = True
        elif len(self.open) == 1 and not self.is_mission:
            tag, attributes = self._child
            self.children.append(Child(tag, _all_shown(attributes), self._child_text, self._child_is_leaf))

    def _characters(self, text: str) -> None:
        if self.is_mission:
            return
        if len(self.open) == 1:
            self.text += text
        elif len(self.open) == 2:
            self._child_text += text

    def _instruction(self, target: str, text: str) -> None:
        raise RestrictedError("restricted-xml", "expected elements and text, found a processing instruction")


def _shown(name: str) -> str:
    """Expat's `uri}name` as everybody else writes it."""
    return "{" + name if "}" in name else name


def _all_shown(attributes: Attributes) -> Attributes:
    return {_shown(name): value for name, value in attributes.items()}
