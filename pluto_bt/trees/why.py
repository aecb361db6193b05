"""Why the robot is, or is not, moving: the chain of causes from the mission down to a sensor or a person, the first cause first.

Pure: it looks at a situation, its trail and the nodes at work, live or from a black box. Every cause has a layer, a code of the documented
lists, a sentence, since when, how old what it speaks of is, and what would unblock it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from pluto_bt.blackboard.codes import status_name
from pluto_bt.record.entries import LINKS, Link
from pluto_bt.record.trail import Trail, Trouble
from pluto_bt.skills import reasons
from pluto_bt.trees.contracts import CONTRACT
from pluto_bt.trees.why_words import ODOMETRY, OF_CODE, OF_SENSOR, OF_THE_BASE, OF_WAITING, WRITERS, cure, meaning, rank

LOCALISATION: Final = "localisation"
MODULE_ERROR: Final = "module-error"
ENDED_BY_ORDER: Final = ("aborted", reasons.STOPPED)  # of a mission
CHAIN_MODULES: Final = ("world", "base", "local", "filter", "drive", "avoid", "motion", "executive")
RECENT_S: Final = 6.0  # a complaint so lately still explains why a leaf has given up
STUCK_S: Final = 25.0  # the same for who is stuck: goto tries for 20 s to come nearer, and is held back only now and then
BASE_TOPICS: Final = ("ATRV2/Bumper", "ATRV2/Sonar", "ATRV2/Battery")


class NodeAtWork(NamedTuple):
    """A node that works or has ended its tree: `since_s` seconds of the run."""

    path: str
    kind: str
    status: str
    feedback: str
    since_s: float


def innermost(rows: Sequence[tuple[int, bool]]) -> list[int]:
    """Which nodes of a tree the others wait for: those that run while nothing below them does, leaves or decorators that wait themselves.

    `rows`: the (depth, does it run) of each node, depth first.
    """
    found, highest = [], -1  # the least depth from here to the next node that runs
    for i in reversed(range(len(rows))):
        depth, runs = rows[i]
        if runs and highest <= depth:
            found.append(i)
        highest = depth if runs else min(highest, depth)
    return found[::-1]


class Cause(NamedTuple):
    """One link of the chain.

    `layer`: mission, node, motion, avoidance, drive, filter, sensor, module, operator or run; `age_s`: of what it is read from.
    """

    layer: str
    code: str
    text: str
    since_s: float
    age_s: float = 0.0
    unblock: str = ""


@dataclass
class View:
    """What is looked at. `ended`: state, reason and text of the mission if it is over; `paused`: the word of a pause that
    keeps the robot waiting; not while it runs an errand."""

    now_s: float
    trail: Trail
    nodes: Sequence[NodeAtWork] = ()
    mission: str = ""
    ended: tuple[str, str, str] = ("", "", "")
    paused: str = ""


@dataclass
class Answer:
    """The answer: is it moving, and the causes, first cause first; none if nothing hinders it."""

    is_moving: bool
    causes: list[Cause] = field(default_factory=list)

    @property
    def first(self) -> Cause | None:
        """The first cause."""
        return self.causes[0] if self.causes else None


def explain(view: View) -> Answer:
    """The chain of causes at this moment."""
    first = _first(view)
    upward = [*_links(view), *_nodes(view), *_mission(view), *_beside(view)]
    if first is not None:
        upward = [cause for cause in upward if (cause.layer, cause.code) != (first.layer, first.code)]
    return Answer(view.trail.situation.moves, [first, *upward] if first is not None else upward)


# -------------------------------------------------------------------- the first cause


def _first(view: View) -> Cause | None:
    """Where it began: a person or his rule, a leaf, a module, or what a sensor says; in this order, because each makes the next ones complain."""
    return _person(view) or _contract(view) or _leaf_error(view) or _module(view) or _sensor(view) or _plain_end(view)


def _person(view: View) -> Cause | None:
    trail = view.trail
    word, text = trail.situation.hold
    if word:
        return _cause("operator", word, text, _since(view, "hold"))
    if trail.situation.mission == ENDED_BY_ORDER:
        return _cause("operator", reasons.STOPPED, "an operator ended the mission", _since(view, "mission"), unblock="start the mission anew")
    if view.paused in ("", MODULE_ERROR) or trail.situation.moves:  # that of a module is nobody's; whom somebody drives by hand, none keeps standing
        return None
    if view.paused == reasons.ESTOP:  # and is released: nothing holds the robot any more
        text = "an emergency stop, released since, paused the mission"
        return _cause("mission", view.paused, text, _since(view, "mission"), unblock=cure(reasons.OPERATOR_STOP))
    return _cause("operator", view.paused, f"the mission was paused: {view.paused}", _since(view, "mission"))


def _contract(view: View) -> Cause | None:
    """A rule of the mission that ended the run, whatever else was going on."""
    word, text = view.trail.situation.ended
    return _cause("run", word, text, _since(view, "ended")) if word == CONTRACT else None


def _leaf_error(view: View) -> Cause | None:
    _, reason, text = view.ended
    ended_word, ended_text = view.trail.situation.ended
    if reason == "leaf-error":
        return _cause("node", reason, text, _since(view, "mission"))
    if ended_word == "hung":
        layer = "node" if "leaf" in ended_text.split('"', 1)[0] else "module"
        return _cause(layer, "hung", ended_text, _since(view, "ended"))
    return None


def _module(view: View) -> Cause | None:
    """A module of the chain that does not run."""
    return next((cause for name in CHAIN_MODULES if (cause := _stopped(view, name)) is not None), None)


def _stopped(view: View, name: str) -> Cause | None:
    """A module, if it does not run."""
    trouble = view.trail.situation.modules.get(name)
    if trouble is None:
        return None
    code = "hung" if trouble.startswith("hung") else "module-stopped" if trouble == "stopped" else MODULE_ERROR
    unblock = f"`pluto module start {name}`" if code == "module-stopped" else ""
    return _cause("module", code, f'module "{name}" is {trouble}', _since(view, f"module/{name}"), unblock=unblock)


def _sensor(view: View) -> Cause | None:
    """What the lowest complaint of the chain speaks of; topics that are too old speak before all others."""
    complaints = list(_complaints(view))
    if view.ended[1] == reasons.STUCK:  # waiting for somebody is not being stuck
        complaints = [(name, trouble) for name, trouble in complaints if trouble.link.reason != reasons.WALKER]
    words = [trouble.link.reason or OF_CODE.get(_code(trouble.link), "") for _, trouble in complaints]
    if not words:
        return None
    stale = view.trail.situation.stale
    if ODOMETRY in stale and any(word in OF_THE_BASE for word in words):
        return _base(view)
    ranked = sorted(range(len(words)), key=lambda i: (rank(words[i]), i))
    if words[ranked[0]] not in OF_SENSOR:
        return None
    trouble = complaints[ranked[0]][1]
    word = words[ranked[0]]
    device, topic = OF_SENSOR[word]
    if topic in WRITERS and (reader := _stopped(view, WRITERS[topic])) is not None:
        return reader  # the device may be well: nobody listens to it
    text = trouble.link.text or meaning(word)
    return _cause("sensor", word, f"{device}: {text}", trouble.since_ns / 1e9, _age(view, topic))


def _base(view: View) -> Cause:
    stale = view.trail.situation.stale
    is_all = any(topic in stale for topic in BASE_TOPICS)
    code = "base-lost" if is_all else reasons.ODOMETRY_STALE
    text = "the base delivers nothing any more" if is_all else "odometry: the base delivers no new readings"
    return _cause("sensor", code, text, stale[ODOMETRY], _age(view, ODOMETRY))


def _complaints(view: View) -> Iterator[tuple[str, Trouble]]:
    """What the links complain of, the lowest first: now, or lately where the mission has given up or waits for it; then the mission's own word."""
    now_ns, is_over = view.now_s * 1e9, bool(view.ended[0]) or bool(view.trail.situation.ended[0])
    recent_s = STUCK_S if view.ended[1] == reasons.STUCK else RECENT_S
    may_be_past = is_over or not view.trail.situation.moves
    for name in (*reversed(LINKS), LOCALISATION):
        trouble = view.trail.troubles.get(name)
        is_mended = name == LOCALISATION and trouble is not None and trouble.link.reason != reasons.LOST  # what is found out there is corrected
        if trouble is None or (is_mended and not may_be_past):
            continue
        lately_ns = now_ns - (trouble.until_ns if trouble.until_ns is not None else now_ns)
        if trouble.until_ns is None or (lately_ns <= recent_s * 1e9 and may_be_past):
            yield name, trouble
    word = view.ended[1] or view.trail.situation.ended[0]
    if word:
        yield "mission", Trouble(Link((), word, view.ended[2] or view.trail.situation.ended[1]), round(_since(view, "mission") * 1e9))


def _plain_end(view: View) -> Cause | None:
    """What ended the mission or the run, where nothing below says more."""
    state, reason, text = view.ended
    word, words = view.trail.situation.ended
    if word:
        return _cause("run", word, words, _since(view, "ended"))
    return _cause("node", reason, text or state, _since(view, "mission")) if reason else None


# -------------------------------------------------------------------- the way up


def _beside(view: View) -> Iterator[Cause]:
    """What hinders nobody and should be known all the same: it is told last."""
    link = view.trail.situation.links.get(LOCALISATION)
    if link is not None and link.reason == reasons.MARKER_STALE:
        yield _cause(LOCALISATION, link.reason, link.text, _since(view, f"link/{LOCALISATION}"))


def _links(view: View) -> Iterator[Cause]:
    """The links that are not as they should be, the lowest first."""
    for name in reversed(LINKS):
        link = view.trail.situation.links.get(name)
        if link is None:
            continue
        code = _code(link)
        if link.reason or code not in (0, None):
            word = link.reason or status_name(0, link.element[0])
            names = ", ".join(f"[{i}] {value} {status_name(i, value)}" for i, value in enumerate(link.element) if value)
            text = "; ".join(part for part in (link.text, f"status {names}" if names else "") if part)
            yield _cause(name, word, text, _since(view, f"link/{name}"))


def _nodes(view: View) -> Iterator[Cause]:
    """The nodes that work or wait."""
    for node in view.nodes:
        text = f"{node.path} ({node.kind}){': ' + node.feedback if node.feedback else ''}"
        yield Cause("node", node.status.lower(), text, node.since_s, unblock=OF_WAITING.get(node.kind, ""))


def _mission(view: View) -> Iterator[Cause]:
    state, reason = view.trail.situation.mission
    if state:
        text = f"mission {view.mission} {state}" if view.mission else f"the mission is {state}"
        is_released = reason == reasons.ESTOP and view.trail.situation.hold[0] != reasons.ESTOP
        yield _cause("mission", reason or state, text, _since(view, "mission"), unblock=cure(reasons.OPERATOR_STOP) if is_released else "")


def _cause(layer: str, code: str, text: str, since_s: float, age_s: float = 0.0, unblock: str = "") -> Cause:
    return Cause(layer, code, text, since_s, age_s, unblock or cure(code))


def _code(link: Link) -> int | None:
    return link.element[0] if link.element else None


def _since(view: View, what: str) -> float:
    return view.trail.since_ns.get(what, 0) / 1e9


def _age(view: View, topic: str) -> float:
    """Seconds since the last value of a topic that is too old; 0 for one that is not."""
    stamp_s = view.trail.situation.stale.get(topic)
    return 0.0 if stamp_s is None else view.now_s - stamp_s
