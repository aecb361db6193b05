"""`load_mission`, and the reading that loading and checking have in common."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pluto_bt.runtime.clock import MissionClock
from pluto_bt.source import Faults, Place, did_you_mean
from pluto_bt.trees.contracts import Contract
from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.errors import MissionError
from pluto_bt.trees.loader.construct import Construction
from pluto_bt.trees.loader.contracts import read_contracts
from pluto_bt.trees.loader.expand import Expansion, Plan
from pluto_bt.trees.loader.files import MissionFiles, TreeSource, main_place
from pluto_bt.trees.loader.foreign import add_models
from pluto_bt.trees.loader.inputs import set_inputs
from pluto_bt.trees.loader.library import add_library_trees
from pluto_bt.trees.loader.registry import NodeType, name_problem, node_types
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.loader.static import StaticCheck
from pluto_bt.trees.mission import Mission
from pluto_bt.trees.origin import Origin
from pluto_bt.trees.scopes import Board, Topics


@dataclass
class Reading:
    """What loading and checking have in common: the files, the plan and the faults."""

    files: MissionFiles
    types: dict[str, NodeType]
    board: Board
    report: Report
    main: TreeSource | None = None
    plan: Plan | None = None
    candidates: Sequence[TreeSource] = ()  # for the main tree, where it is not said which is it
    unused: list[TreeSource] = field(default_factory=list)  # trees of the mission that the main tree does not use
    text: str = ""
    file: str = ""
    contracts: Sequence[Contract] = ()
    lacks_nodes: bool = False  # the plan has nodes without a class: it can be drawn and checked, not run

    @property
    def origin(self) -> Origin:
        """Where the mission came from."""
        return Origin(self.text, self.file, tuple(self.files.paths))


def load_mission(
    text_or_path: str | Path,
    nodes: Iterable[Any] = (),
    clock: MissionClock | None = None,
    blackboard: Mapping[str, Any] | None = None,
    enums: Mapping[str, int] | None = None,
    *,
    tree: str | None = None,
    ports: Mapping[str, str] | None = None,
    robot: Any = None,
    topics: Topics | None = None,
    file: str | None = None,
    plugins: Sequence[str] = (),
) -> Mission:
    """Load a mission in BehaviorTree.CPP v4 XML.

    Args:
        text_or_path: the XML itself if it begins with "<", else the name of a file.
        nodes: classes of leaves, besides all that py_trees' registry knows.
        clock: the mission's time; without one, the monotonic clock of this computer.
        blackboard: values of root entries before the first tick.
        enums: names that scripts may use as numbers, besides those that plugins bring.
        tree: the main tree (`--tree`).
        ports: inputs of the main tree (`--port`), as text.
        robot, topics: what leaves find at `blackboard.robot` and under `@topic` keys.
        file: the name to show for a text, and where its includes are looked for.
        plugins: modules with leaves, to be imported.
    Raises: MissionError with all faults, for everything that BehaviorTree.CPP refuses at load.
    """
    with no_collecting():
        reading = read_mission(text_or_path, nodes, blackboard, tree=tree, ports=ports, topics=topics, file=file, plugins=plugins)
        return build(reading, clock, enums, robot)


def build(reading: Reading, clock: MissionClock | None, enums: Mapping[str, int] | None = None, robot: Any = None) -> Mission:
    """The mission that was read. Raises: MissionError for everything that BehaviorTree.CPP refuses at load."""
    report, faults = reading.report, reading.report.faults
    if report.stops_loading or reading.lacks_nodes or reading.plan is None or reading.main is None:
        raise MissionError(faults.in_order())
    reading.board.robot = robot
    context = Context(clock if clock is not None else _monotonic_clock())
    construction = Construction(context, {**plugin_enums(), **(enums or {})}, report)
    root = construction.run(reading.plan)
    if report.stops_loading:
        raise MissionError(faults.in_order())
    mission = Mission(reading.main.tree_id, root, construction.tracked, reading.board, context, reading.origin)
    mission.contracts = tuple(reading.contracts)
    return mission


def plan_mission(text_or_path: str | Path, nodes: Iterable[Any] = (), *, tree: str | None = None, file: str | None = None) -> Plan:
    """The expanded main tree, without making nodes, for drawing. Raises MissionError."""
    reading = read_mission(text_or_path, nodes, None, tree=tree, ports=None, topics=None, file=file, plugins=())
    if reading.report.stops_loading or reading.plan is None:
        raise MissionError(reading.report.faults.in_order())
    return reading.plan


def read_mission(
    text_or_path: str | Path,
    nodes: Iterable[Any],
    blackboard: Mapping[str, Any] | None,
    *,
    tree: str | None,
    ports: Mapping[str, str] | None,
    topics: Topics | None,
    file: str | None,
    plugins: Sequence[str],
    models: Sequence[str | Path] = (),
) -> Reading:
    """Read the files, check each tree as it is written, and unfold the main tree; the arguments are those of `load_mission`."""
    faults = Faults()
    reading = Reading(MissionFiles(faults), node_types(nodes, plugins), Board(topics), Report(faults))
    _read_files(reading, text_or_path, file, models)
    if reading.files.root is None:
        return reading
    has_frame = bool(reading.files.trees) or not faults.has_errors
    reading.contracts = read_contracts(reading.files.contracts, reading.report)
    StaticCheck(reading.files, reading.types, reading.report).run()
    if not has_frame:
        return reading
    main = _main_tree(reading, tree)
    for key, value in (blackboard or {}).items():
        reading.board.root.write(key, value)
    if main is not None:
        unfold(reading, main, ports)
    return reading


def unfold(reading: Reading, main: TreeSource, ports: Mapping[str, str] | None) -> None:
    """Make `main` the main tree of a reading: its inputs and its plan."""
    reading.main = main
    set_inputs(reading.files, main, reading.board.root, ports, reading.report)
    own_trees = list(reading.files.trees.values())
    add_library_trees(reading.files)
    expansion = Expansion(reading.files, reading.types, reading.board, reading.report)
    reading.plan = expansion.run(main)
    _tell_missing(reading)
    reading.unused = [source for source in own_trees if source.tree_id not in expansion.used]


def _tell_missing(reading: Reading) -> None:
    """Nodes that are known by name alone, where the main tree would run them."""
    waiting = [reading.plan] if reading.plan is not None else []
    while waiting:
        plan = waiting.pop()
        waiting.extend(plan.children)
        if plan.node_type is not None and plan.node_type.missing:
            reading.lacks_nodes = True
            what = f"<{plan.type_name}> is not there yet: our robots have no {plan.node_type.missing}"
            reading.report.late(plan.element.place, "not-there-yet", what, expected="another node", found=plan.type_name)


def _read_files(reading: Reading, text_or_path: str | Path, file: str | None, models: Sequence[str | Path]) -> None:
    if isinstance(text_or_path, str) and text_or_path.lstrip("\ufeff \t\r\n").startswith("<"):
        reading.text = text_or_path
        reading.files.read_text(text_or_path, file or "")
    else:
        reading.file = str(text_or_path)
        reading.files.read_file(Path(text_or_path), file or str(text_or_path))
    for path in models:
        reading.files.read_models(Path(path), str(path))
    if models:
        add_models(reading.types, reading.files.node_models.values())


def _main_tree(reading: Reading, asked: str | None) -> TreeSource | None:
    """The tree asked for, else `main_tree_to_execute`, else the only one, else the only one that no other refers to."""
    files, report = reading.files, reading.report
    assert files.root is not None  # the caller has read a document
    known = ", ".join(files.trees) or "none"
    if not files.trees:
        report.error(files.root.place, "no-tree", "the mission has no tree", expected='<BehaviorTree ID="…">', found="none")
        return None
    attribute = files.root.attributes.get("main_tree_to_execute")
    name = asked if asked is not None else attribute.value if attribute is not None else None
    if name is not None:
        if name not in files.trees and not files.is_whole and asked is None:
            return None  # it may be in the file that could not be read
        if name not in files.trees:
            place = main_place(files.root) if asked is None else Place("--tree")
            mend = did_you_mean(name, files.trees)
            report.error(place, "unknown-tree", f"there is no tree {name!r}", expected=f"one of: {known}", found=name, mend=mend)
            return None
        return files.trees[name]
    if len(files.trees) == 1:
        return next(iter(files.trees.values()))
    if files.unnamed or not files.is_whole:
        return None  # told already: a tree has no ID, a file could not be read
    return _unreferenced(reading, known)


def _unreferenced(reading: Reading, known: str) -> TreeSource | None:
    files = reading.files
    assert files.root is not None  # as above
    referred: set[str] = set()
    for source in files.trees.values():
        waiting = list(source.element.children)
        while waiting:
            element = waiting.pop()
            waiting.extend(element.children)
            if element.tag == "SubTree" and element.get("ID") != source.tree_id:
                referred.add(element.get("ID"))
    free = [source for source in files.trees.values() if source.tree_id not in referred]
    if len(free) == 1:
        return free[0]
    found = f"{len(free)} trees that no other refers to"
    what = "which tree is the main one is not said"
    reading.candidates = free
    good = next((source.tree_id for source in free or files.trees.values() if not name_problem(source.tree_id)), "ID")
    mend = f'add main_tree_to_execute="{good}" to <root>, or give --tree'
    reading.report.error(files.root.place, "no-main-tree", what, expected=f"one of: {known}", found=found, mend=mend)
    return None


@contextlib.contextmanager
def no_collecting() -> Iterator[None]:
    """No garbage collection inside: a growing mission holds no garbage, and looking for it would take as long as loading."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def _monotonic_clock() -> MissionClock:
    from pluto_bt.runtime.clock import MonotonicClock

    return MonotonicClock()
