"""From an XML element to a request, with every attribute checked. What is well-formed but wrong is refused, and the stream goes on."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

import msgspec

from pluto_bt.gateway.child import Child
from pluto_bt.gateway.framing import Message
from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.requests import ELEMENTS, AnyRequest, Run, Vector
from pluto_bt.source import did_you_mean

_FROM_CONTENT = {
    "command": ("position", "velocity", "acceleration", "force"), "run": ("ports",), "mission": ("text", "ports"), "params": ("values",),
    "set": ("fields",),
}  # fmt: skip
_ATTRIBUTES = {
    tag: tuple(name for name in kind.__struct_fields__ if name not in _FROM_CONTENT.get(tag, ())) for tag, kind in ELEMENTS.items()
}
_COUNTS = {"position": 2, "velocity": 2, "acceleration": 2}
_GIVEN = re.compile(r"""\s*<p\s+name\s*=\s*("[^"]*"|'[^']*')\s*(?:/>|>([^<]*)</p\s*>)""")
_INLINE = re.compile(rb"<mission\b(?:[^>\"']|\"[^\"]*\"|'[^']*')*>(.*)</mission\s*>", re.DOTALL)


def parse(message: Message) -> AnyRequest:
    """The request that a message makes. Raises: RefusedError (`unknown-element`, `invalid`, `bad-value`)."""
    tag = message.tag
    kind = ELEMENTS.get(tag)
    if kind is None:
        hint = did_you_mean(tag, ELEMENTS)
        raise RefusedError("unknown-element", f"unknown element <{tag}>; expected one of: {', '.join(sorted(ELEMENTS))}{'; ' + hint if hint else ''}")
    given: dict[str, Any] = dict(message.attrib)
    known = _ATTRIBUTES[tag]
    if kind is Run:
        given = {name: given[name] for name in known if name in given} | {"ports": {k: v for k, v in given.items() if k not in known}}
    else:
        for name in given:
            if name not in known:
                hint = did_you_mean(name, known)
                text = f'<{tag}>: unknown attribute "{name}"; expected one of: {", ".join(known)}{"; " + hint if hint else ""}'
                raise RefusedError("invalid", text)
    given |= _content(message)
    try:
        request: AnyRequest = msgspec.convert(given, kind, strict=False)
    except msgspec.ValidationError as error:
        raise RefusedError("invalid", _explain(tag, given, known, str(error))) from None
    return request


def _explain(tag: str, given: dict[str, Any], known: Sequence[str], complaint: str) -> str:
    """msgspec's complaint as: which attribute, what was expected, what was found."""
    missing = re.match(r"Object missing required field `(\w+)`", complaint)
    if missing:
        return f'<{tag}>: expected the attribute "{missing[1]}"; attributes of <{tag}>: {", ".join(known)}'
    at = re.search(r" - at `\$\.(\w+)`$", complaint)
    expected = re.sub(r", got .*| - at `.*", "", complaint).replace("`", "")
    if at is None:
        return f"<{tag}>: {complaint}"
    if expected.startswith("Invalid enum value"):
        choices = ELEMENTS[tag].__annotations__[at[1]]
        expected = "expected one of " + ", ".join(re.findall(r"['\"]([^'\"]+)['\"]", str(choices)))
    return f'<{tag} {at[1]}="{given.get(at[1])}">: {expected[:1].lower()}{expected[1:]}, found "{given.get(at[1])}"'


def _content(message: Message) -> dict[str, Any]:
    """What stands inside the element: vectors of a command, the document of a mission, else nothing but white space."""
    tag, children = message.tag, message.children
    if tag == "mission":
        inline = _INLINE.search(message.raw)
        return _document(inline[1].decode()) if inline else {}
    if message.text.strip():
        raise RefusedError("invalid", f"<{tag}>: expected no text, found {message.text.strip()[:40]!r}")
    if tag in ("params", "set"):
        return _texts(tag, children)
    allowed = _FROM_CONTENT["command"] if tag == "command" else ()
    found: dict[str, Any] = {}
    for child in children:
        if child.tag not in allowed or child.tag in found:
            expected = f"each of {', '.join(allowed)} at most once" if allowed else "no elements"
            raise RefusedError("invalid", f"<{tag}>: expected {expected}, found <{child.tag}>")
        found[child.tag] = _vector(tag, child)
    return found


def _document(text: str) -> dict[str, Any]:
    """The inputs that stand first, and the document behind them."""
    ports: dict[str, str] = {}
    at = 0
    while given := _GIVEN.match(text, at):
        one = ElementTree.fromstring(given[0].strip())
        if one.attrib["name"] in ports:
            raise RefusedError("invalid", f'<mission>: expected each <p> once; look at "{one.attrib["name"]}"')
        ports[one.attrib["name"]] = one.text or ""
        at = given.end()
    if re.match(r"\s*<p[\s/>]", text[at : at + 100]):
        raise RefusedError("invalid", '<mission>: expected <p name="INPUT">VALUE</p> with a text alone, then the document')
    document = text[at:]
    return {"ports": ports} | ({"text": document} if document.strip() else {})


def _texts(tag: str, children: Sequence[Child]) -> dict[str, Any]:
    """The texts of `<p name="…">` by name, or of the fields of a topic by tag; each once, and nothing inside them."""
    found: dict[str, str] = {}
    for child in children:
        name = child.attrib.get("name", "") if tag == "params" else child.tag
        if tag == "params" and (child.tag != "p" or list(child.attrib) != ["name"]):
            raise RefusedError("invalid", f'<{tag}>: expected <p name="…">, found <{" ".join([child.tag, *child.attrib])}>')
        if name in found or not child.is_leaf or (tag == "set" and child.attrib):
            raise RefusedError("invalid", f'<{tag}>: expected each of its elements once, with a text alone; look at "{name}"')
        found[name] = child.text
    return {"values" if tag == "params" else "fields": found}


def _vector(tag: str, child: Child) -> Vector:
    """The numbers of one child, finite and as many as the field has."""
    words = child.text.split()
    where = f"<{tag}>: <{child.tag}>"
    try:
        values = tuple(float(word) for word in words)
    except ValueError:
        raise RefusedError("bad-value", f"{where}: expected numbers separated by spaces, found {' '.join(words)[:40]!r}") from None
    if not all(map(math.isfinite, values)):
        raise RefusedError("bad-value", f"{where}: expected finite numbers, found {' '.join(words)[:40]!r}")
    expected = _COUNTS.get(child.tag, 1)
    if len(values) != expected and not (child.tag == "force" and 1 <= len(values) <= 8):
        raise RefusedError("bad-value", f"{where}: expected {expected} numbers, found {len(values)}")
    return values
