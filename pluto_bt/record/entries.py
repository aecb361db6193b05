"""What the black box says of a run besides its topics: the run itself, each tree that began, and each step of the executive."""

from __future__ import annotations

from typing import Any

import msgspec

RUN, TREE, TICK = "pluto/run", "pluto/tree", "pluto/tick"
STATUS_OF_LETTER = {"I": "IDLE", "R": "RUNNING", "S": "SUCCESS", "F": "FAILURE", "K": "SKIPPED"}
WATCHED = "watched"  # the mode of a recording made from outside: topics, but no ticks
LINKS = ("motion", "avoidance", "drive", "filter")  # of the chain, from above, as a situation names them
KEYFRAME_EVERY = 100  # ticks: every so often a tick says all and not only what changed


class Run(msgspec.Struct, kw_only=True):
    """What was run. `files` are the names of attachments: the mission with its includes, the world with its map, the platform.

    Attributes:
        hashes: SHA-256 of each attachment, and `parameters`: of the platform file with all settings.
        mode: lockstep or threads; watched if it was recorded from outside.
        resumed: what the mission remembered of a run that was cut off.
        settings: of `--set`; `ports`, `tree`, `plugins`, `start`, `seed` as given.
    """

    version: str = ""
    mode: str = "lockstep"
    mission: str = ""
    world: str = ""
    map: str = ""
    platform: str = ""
    seed: int = 0
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tree: str | None = None
    ports: dict[str, str] = {}
    settings: tuple[str, ...] = ()
    plugins: tuple[str, ...] = ()
    hashes: dict[str, str] = {}
    resumed: dict[str, Any] = {}


class NodeRow(msgspec.Struct, frozen=True, gc=False):
    """A node of a tree, as it does not change: `kind` is its type, `sort` one of Control, Decorator, SubTree, Action, Condition."""

    path: str
    kind: str
    name: str
    depth: int
    sort: str = "Action"
    ports: dict[str, str] = {}


class Tree(msgspec.Struct, kw_only=True):
    """A tree that begins: the mission, an errand, or the job `number` of motion.

    `text` is the XML of a tree that came as text; `file` names the attachment it came from, "" for trees of the library.
    """

    run: int
    role: str
    name: str
    nodes: tuple[NodeRow, ...]
    text: str = ""
    file: str = ""


class Posted(msgspec.Struct, frozen=True, gc=False, omit_defaults=True):
    """A command that a tree gave, and whether it was taken: `refused` is "" or the word of the refusal."""

    to: str
    flags: int
    position: tuple[float, float] = (0.0, 0.0)
    velocity: tuple[float, float] = (0.0, 0.0)
    refused: str = ""


class Branch(msgspec.Struct, gc=False, omit_defaults=True):
    """One tree in one tick.

    Attributes:
        run, tick: which tree, and its how manyeth tick.
        nodes: one letter a node, depth first: I R S F, K = skipped.
        finished: the leaves that ended in this tick, in order: (number, S F or K); a parent may have made them idle again since.
        feedback: what changed: number of the node -> its words.
        board: what changed: "scope/key" -> value; `gone`: entries that are no more.
        state: of the tree after the tick, if it ended: succeeded, failed, aborted; `reason` with it.
        is_key: everything is told, not only what changed.
    """

    run: int
    tick: int
    nodes: str
    finished: tuple[tuple[int, str], ...] = ()
    feedback: dict[int, str] = {}
    board: dict[str, Any] = {}
    gone: tuple[str, ...] = ()
    state: str = "running"
    reason: str = ""
    text: str = ""
    is_key: bool = False


class Link(msgspec.Struct, frozen=True, gc=False, omit_defaults=True):
    """What a link of the chain says, or localisation of its witnesses."""

    element: tuple[int, ...] = ()
    reason: str = ""
    text: str = ""


class Situation(msgspec.Struct, frozen=True, gc=False, omit_defaults=True):
    """What `why` looks at, at one moment. Two that are equal need not be told twice.

    Attributes:
        links: motion, avoidance, drive, filter, localisation -> what it says.
        stale: topics that are too old -> the stamp of their last value (s).
        modules: those that do not run -> state and error.
        hold: the word and the text of a latched stop.
        moves: the wheels turn. `wanted`: the drive lets a velocity through to the filter.
        mission: state and reason. `ended`: word and text of what other than the mission ended the run.
    """

    links: dict[str, Link] = {}
    stale: dict[str, float] = {}
    modules: dict[str, str] = {}
    hold: tuple[str, str] = ("", "")
    moves: bool = False
    wanted: bool = False
    mission: tuple[str, str] = ("", "")
    ended: tuple[str, str] = ("", "")


class Tick(msgspec.Struct, gc=False, omit_defaults=True):
    """One step of the executive in which something was ticked or ordered.

    Attributes:
        t_ns: the run's time. `step` counts these entries.
        orders: carried out before the tick: (verb, run, text).
        trees: what was ticked. `commands`: what the trees gave.
        seqs: sequence numbers that this tick saw of the topics that leaves read; only those that changed.
        pose: x m, y m, theta rad of `Localization/Pose`.
        situation: if it changed.
        is_key: `seqs` and `situation` are told whole. `is_end`: no step, but how things stood when the run was over.
    """

    t_ns: int
    step: int
    orders: tuple[tuple[str, int, str], ...] = ()
    trees: tuple[Branch, ...] = ()
    commands: tuple[Posted, ...] = ()
    seqs: dict[str, int] = {}
    pose: tuple[float, float, float] | None = None
    situation: Situation | None = None
    is_key: bool = False
    is_end: bool = False

    @property
    def t_s(self) -> float:
        """Seconds of the run."""
        return self.t_ns / 1e9
