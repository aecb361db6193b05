"""What a client may say: one struct an element; the same structs travel to the executive. `parse` reads them from the XML."""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeAlias

import msgspec
from msgspec import Meta

from pluto_bt.blackboard.messages import ActuatorState

Word = Annotated[str, Meta(max_length=128)]
Seconds = Annotated[float, Meta(ge=0.0, le=1e9)]
Vector = tuple[float, ...]
LEAST_RATE_HZ = 1e-3
"""A value in a quarter of an hour; of much less the period is no number any more."""


class Request(msgspec.Struct, frozen=True, kw_only=True, tag=True, tag_field="_", forbid_unknown_fields=True, gc=False):
    """Root of all requests; replies carry the same `id`."""

    id: Word = ""

    @property
    def element(self) -> str:
        """The name of its XML element."""
        return _TAGS[type(self)]

    @property
    def only_looks(self) -> bool:
        """True for what changes nothing on the robot: whoever may watch may ask it, and it may be asked again, or be forgotten with its client."""
        return looks(self.element, getattr(self, "op", ""))

    @property
    def acts(self) -> bool:
        """True for what may change something: the audit log keeps it."""
        return acts(self.element, getattr(self, "op", ""))


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

    def __post_init__(self) -> None:
        """Raises: ValueError for a rate that is nearly 0."""
        if 0.0 < self.max_rate_hz < LEAST_RATE_HZ:
            raise ValueError(f'expected max_rate_hz 0 (each value) or at least {LEAST_RATE_HZ:g}, found "{self.max_rate_hz:g}"')


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
    """The mission: load, check, start, pause and so on; a document of one's own stands inside as `<root …>`, inputs before it as `<p name="…">`."""

    op: Literal["load", "check", "start", "pause", "resume", "abort", "list", "fetch", "state"]
    name: str = ""
    text: str = ""
    ports: dict[str, str] = {}


class ShowTree(Request, frozen=True, kw_only=True):
    """The tree now."""

    format: Literal["xml", "ascii", "dot"] = "xml"


class Why(Request, frozen=True, kw_only=True):
    """Why the robot is, or is not, moving; `at` = at this second of the run."""

    at: Annotated[float, Meta(ge=0.0, le=1e9)] | None = None


class ShowModules(Request, frozen=True, kw_only=True):
    """Every module."""


class ModuleOp(Request, frozen=True, kw_only=True):
    """Start or stop one module."""

    name: str
    op: Literal["start", "stop"]


class Params(Request, frozen=True, kw_only=True):
    """Parameters: get them (`name` may end in `*`), set some, all or none, take the last change back, keep what is set for the next run.

    `rev` = the revision that the client saw; `confirm_s` > 0: the change goes back by itself unless a `set` without it (it may be empty) or a
    `save` follows in that time.
    """

    op: Literal["get", "set", "rollback", "save"] = "get"
    name: str = "*"
    rev: Annotated[int, Meta(ge=0)] | None = None
    confirm_s: Annotated[float, Meta(ge=0.0, le=3600.0)] = 0.0
    values: dict[str, str] = {}  # msgspec copies the default for each instance


class SetTopic(Request, frozen=True, kw_only=True):
    """Write a topic whose writer is `gateway`: one child a field, as in `<value>`."""

    topic: str
    fields: dict[str, str] = {}


class Log(Request, frozen=True, kw_only=True):
    """Events after the sequence number `since`, of this level or worse."""

    since: Annotated[int, Meta(ge=0)] = 0
    level: Literal["info", "warning", "error"] = "info"


class Bye(Request, frozen=True, kw_only=True):
    """Close the connection."""


AnyRequest: TypeAlias = (
    SayHello | Ping | Describe | Get | Subscribe | Unsubscribe | Lease | Command | Run | Cancel | Stop | Estop | Release
    | MissionOp | ShowTree | Why | ShowModules | ModuleOp | Params | SetTopic | Log | Bye
)  # fmt: skip

ELEMENTS: dict[str, type[Any]] = {
    "hello": SayHello, "ping": Ping, "describe": Describe, "get": Get, "subscribe": Subscribe, "unsubscribe": Unsubscribe, "lease": Lease,
    "command": Command, "run": Run, "cancel": Cancel, "stop": Stop, "estop": Estop, "release": Release, "mission": MissionOp,
    "tree": ShowTree, "why": Why, "modules": ShowModules, "module": ModuleOp, "params": Params, "set": SetTopic, "log": Log, "bye": Bye,
}  # fmt: skip

_TAGS = {kind: tag for tag, kind in ELEMENTS.items()}
_LOOKS = frozenset({"ping", "describe", "get", "subscribe", "tree", "why", "modules", "log"})
_LOOKING_OPS = {"lease": ("query",), "mission": ("list", "state", "fetch", "check"), "params": ("get",)}


_MANNERS = frozenset({"hello", "unsubscribe", "bye"})


def acts(tag: str, op: str) -> bool:
    """True if the element may change something on the robot, so that it belongs into the audit log; a lease that is renewed changes nothing."""
    return tag in ELEMENTS and tag not in _MANNERS and not looks(tag, op) and op != "renew"


def looks(tag: str, op: str) -> bool:
    """True if the element with this `op` ("" = it has none) only looks."""
    return tag in _LOOKS or op in _LOOKING_OPS.get(tag, ())


def actuator(request: Command, now_s: float) -> ActuatorState:
    """The command as the chain takes it, stamped with its arrival."""
    (p0, p1), (v0, v1), (a0, a1) = request.position, request.velocity, request.acceleration
    return ActuatorState(now_s, request.flags, (p0, p1), (v0, v1), (a0, a1), request.force)
