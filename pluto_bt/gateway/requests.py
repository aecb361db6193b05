"""What a client may say: one struct an element, read from the XML with every attribute checked.

The structs are also what travels to the executive. A request that is well-formed but wrong raises `RefusedError`; the stream goes on.
"""

from __future__ import annotations

import math
import re
from typing import Annotated, Any, Literal, TypeAlias

import msgspec
from msgspec import Meta

from pluto_bt.gateway.framing import Message
from pluto_bt.gateway.port import RefusedError
from pluto_bt.source import did_you_mean

Word = Annotated[str, Meta(max_length=128)]
Seconds = Annotated[float, Meta(ge=0.0, le=1e9)]
Vector = tuple[float, ...]


class Request(msgspec.Struct, frozen=True, kw_only=True, tag=True, tag_field="_", forbid_unknown_fields=True, gc=False):
    """Root of all requests; replies carry the same `id`."""

    id: Word = ""


class SayHello(Request, frozen=True, kw_only=True):
    """Who the client is; `session` is the name under which `command` and `run` act once."""

    version: str = "1.0"
    name: Word = ""
    token: Word = ""
    session: Word = ""


class Ping(Request, frozen=True, kw_only=True):
    """Are you there?"""

    t: str = ""


class Describe(Request, frozen=True, kw_only=True):
    """What exists; at most one of the four."""

    topic: str | None = None
    node: str | None = None
    param: str | None = None
    module: str | None = None


class Get(Request, frozen=True, kw_only=True):
    """The newest value of a topic."""

    topic: str


class Subscribe(Request, frozen=True, kw_only=True):
    """Values from now on; rate 0 = each value; on_change = only if the content differs from the last one sent."""

    topic: Annotated[str, Meta(min_length=1)]
    max_rate_hz: Annotated[float, Meta(ge=0.0, le=1e6)] = 0.0
    on_change: bool = False


class Unsubscribe(Request, frozen=True, kw_only=True):
    """No more of these."""

    topic: str


class Lease(Request, frozen=True, kw_only=True):
    """Who may drive."""

    op: Literal["acquire", "take", "renew", "query", "release"]
    ttl_s: Annotated[float, Meta(ge=0.1, le=60.0)] = 2.0
    on_loss: Literal["stop", "pause", "continue"] = "stop"


class Command(Request, frozen=True, kw_only=True):
    """A raw ActuatorState into the chain or to the wrist."""

    target: Literal["motion", "avoidance", "drive", "wrist"]
    flags: Annotated[int, Meta(ge=-(2**31), lt=2**31)]
    position: Vector = (0.0, 0.0)
    velocity: Vector = (0.0, 0.0)
    acceleration: Vector = (0.0, 0.0)
    force: Vector = (0.0,)


class Run(Request, frozen=True, kw_only=True):
    """Run one node or library tree with these ports; deadline 0 = none."""

    node: Annotated[str, Meta(min_length=1)]
    deadline_s: Seconds = 0.0
    ports: dict[str, str] = {}  # msgspec copies the default for each instance


class Cancel(Request, frozen=True, kw_only=True):
    """End a run."""

    run: str


class Stop(Request, frozen=True, kw_only=True):
    """Zero velocity at once."""


class Estop(Request, frozen=True, kw_only=True):
    """As stop, but latched."""

    reason: str = ""


class Release(Request, frozen=True, kw_only=True):
    """Unlatch; the robot does not move by that."""

    what: Literal["estop"]


class MissionOp(Request, frozen=True, kw_only=True):
    """The mission: load, start, pause and so on; `text` is the inline document."""

    op: Literal["load", "check", "start", "pause", "resume", "abort", "list", "fetch", "state"]
    name: str = ""
    text: str = ""


class ShowTree(Request, frozen=True, kw_only=True):
    """The tree now."""

    format: Literal["xml", "ascii", "dot"] = "xml"


class ShowModules(Request, frozen=True, kw_only=True):
    """Every module."""


class ModuleOp(Request, frozen=True, kw_only=True):
    """Start or stop one module."""

    name: str
    op: Literal["start", "stop"]


class Log(Request, frozen=True, kw_only=True):
    """Events after the sequence number `since`, of this level or worse."""

    since: Annotated[int, Meta(ge=0)] = 0
    level: Literal["info", "warning", "error"] = "info"


class Bye(Request, frozen=True, kw_only=True):
    """Close the connection."""


AnyRequest: TypeAlias = (
    SayHello | Ping | Describe | Get | Subscribe | Unsubscribe | Lease | Command | Run | Cancel | Stop | Estop | Release
    | MissionOp | ShowTree | ShowModules | ModuleOp | Log | Bye
)  # fmt: skip

ELEMENTS: dict[str, type[Any]] = {
    "hello": SayHello, "ping": Ping, "describe": Describe, "get": Get, "subscribe": Subscribe, "unsubscribe": Unsubscribe, "lease": Lease,
    "command": Command, "run": Run, "cancel": Cancel, "stop": Stop, "estop": Estop, "release": Release, "mission": MissionOp,
    "tree": ShowTree, "modules": ShowModules, "module": ModuleOp, "log": Log, "bye": Bye,
}  # fmt: skip
_FROM_CONTENT = {"command": ("position", "velocity", "acceleration", "force"), "run": ("ports",), "mission": ("text",)}
_COUNTS = {"position": 2, "velocity": 2, "acceleration": 2}
_INLINE = re.compile(rb"<mission\b(?:[^>\"']|\"[^\"]*\"|'[^']*')*>(.*)</mission\s*>", re.DOTALL)


def parse(message: Message) -> AnyRequest:
    """The request that a message makes. Raises: RefusedError (`unknown-element`, `invalid`, `bad-value`)."""
    tag = message.element.tag
    kind = ELEMENTS.get(tag)
    if kind is None:
        hint = did_you_mean(tag, ELEMENTS)
        raise RefusedError("unknown-element", f"unknown element <{tag}>; expected one of: {', '.join(sorted(ELEMENTS))}{'; ' + hint if hint else ''}")
    given: dict[str, Any] = dict(message.element.attrib)
    known = [name for name in kind.__struct_fields__ if name not in _FROM_CONTENT.get(tag, ())]
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
        return msgspec.convert(given, kind, strict=False)  # type: ignore[no-any-return]
    except msgspec.ValidationError as error:
        raise RefusedError("invalid", _explain(tag, given, known, str(error))) from None


def _explain(tag: str, given: dict[str, Any], known: list[str], complaint: str) -> str:
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
    tag = message.element.tag
    if tag == "mission":
        inline = _INLINE.search(message.raw)
        text = inline[1].decode() if inline else ""
        return {"text": text} if text.strip() else {}
    children = [child for child in message.element if isinstance(child.tag, str)]
    stray = "".join(message.element.itertext()) if not children else (message.element.text or "") + "".join(child.tail or "" for child in children)
    if stray.strip():
        raise RefusedError("invalid", f"<{tag}>: expected no text, found {stray.strip()[:40]!r}")
    allowed = _FROM_CONTENT["command"] if tag == "command" else ()
    found: dict[str, Any] = {}
    for child in children:
        if child.tag not in allowed or child.tag in found:
            expected = f"each of {', '.join(allowed)} at most once" if allowed else "no elements"
            raise RefusedError("invalid", f"<{tag}>: expected {expected}, found <{child.tag}>")
        found[child.tag] = _vector(tag, child)
    return found


def _vector(tag: str, child: Any) -> Vector:
    """The numbers of one child, finite and as many as the field has."""
    words = "".join(child.itertext()).split()
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
