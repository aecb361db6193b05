"""Inputs of the main tree: declared by `<SubTree ID="main">` in TreeNodesModel, given by `--port NAME=VALUE`."""

from __future__ import annotations

from collections.abc import Mapping

from pluto_bt.maps.numbers import MAX_METRES
from pluto_bt.source import Place, did_you_mean, nearest_word
from pluto_bt.trees.loader.files import MissionFiles, Model, TreeSource
from pluto_bt.trees.loader.literal_check import new_words
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.loader.report import Report
from pluto_bt.trees.ports import is_beyond
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.values import BOOL, DOUBLE, INT, STRING, TEXTS, Kind, PortProblem, declared_value

POINT, POINTS = kind_of_type(tuple[float, float]), kind_of_type(list[tuple[float, float]])
# What a model may declare of an input, as `type`; other words are taken for C++ types that mean nothing here.
DECLARED = {
    "int": INT, "double": DOUBLE, "float": DOUBLE, "bool": BOOL, **dict.fromkeys(TEXTS, STRING),
    "point": POINT, "points": POINTS,
}  # fmt: skip


def set_inputs(files: MissionFiles, main: TreeSource, root: Scope, given: Mapping[str, str] | None, report: Report) -> None:
    """Write the given inputs and the defaults of the others into the root scope; each counts as a write.

    With `given` None nobody asked on a command line: inputs without a value are then left to the caller.
    """
    model = files.subtree_models.get(main.tree_id)
    meant = set()  # inputs that were given, though wrongly perhaps: they are told once
    for name, text in (given or {}).items():
        meant.add(_input_meant(name, model, main, report))
        port = model.ports.get(name) if model is not None else None
        _write(root, name, text, port.type_name if port is not None else "", Place(f"--port {name}={text}"), report, may_be_empty=False)
    for port in model.ports.values() if model is not None else ():
        entry = root.find(port.name)
        if (entry is not None and entry.value is not EMPTY) or port.direction == "out" or port.name in meant:
            continue
        if port.default is not None:
            _write(root, port.name, port.default, port.type_name, port.element.attributes["default"].value_place, report, may_be_empty=True)
        elif given is not None:
            what = f'input "{port.name}" of {main.tree_id!r} is not given'
            wanted, mend = port.description or port.type_name or "a value", f"add --port {port.name}=VALUE"
            report.error(port.element.place, "missing-input", what, expected=wanted, found="nothing", mend=mend)


def _write(root: Scope, name: str, text: str, type_name: str, place: Place, report: Report, *, may_be_empty: bool) -> None:
    """Typed as a SubTree's literal is. A default may be an empty list; who gives one made a slip."""
    kind = DECLARED.get(type_name)
    if kind is not None:
        problem = _problem(kind, text, may_be_empty)
        if problem:
            what = f'input "{name}" is declared as {type_name}; "{text}" is none'
            report.error(place, "bad-input", what, expected=kind.form, found=text or "nothing", mend=new_words(problem, kind.form))
            return
    try:
        root.write(name, declared_value(text, type_name))
    except PortProblem as problem:
        report.error(place, "bad-input", str(problem), expected="a value of the entry's kind", found=text)


def _problem(kind: Kind, text: str, may_be_empty: bool) -> str:
    """Why a text is no value of a declared input, or ""."""
    try:
        value = kind.parse(text)
    except ValueError as error:
        return str(error)
    if value == [] and not may_be_empty:
        return "it has no element; leave it out to have the default, if there is one"
    return f"no place is beyond {MAX_METRES:g} m" if kind in (POINT, POINTS) and is_beyond(value) else ""


def _input_meant(name: str, model: Model | None, main: TreeSource, report: Report) -> str:
    """The input that a name means, "" if none comes near; with a fault unless it is the name itself."""
    known = list(model.ports) if model is not None else _keys_used(main)
    if name in known:
        return name
    what = f'tree {main.tree_id!r} has no input "{name}"'
    wanted = "one of: " + (", ".join(known) or "none")
    report.error(Place(f"--port {name}"), "unknown-input", what, expected=wanted, found=name, mend=did_you_mean(name, known))
    return nearest_word(name, known)


def _keys_used(main: TreeSource) -> list[str]:
    """The root entries that the main tree names in braces: its inputs where it declares none."""
    found: dict[str, None] = {}
    waiting = list(main.element.children)
    while waiting:
        element = waiting.pop(0)
        for attribute in element.attributes.values():
            key = key_of(attribute.name, attribute.value)
            if key is not None:
                found[key] = None
        waiting.extend(element.children)
    return list(found)
