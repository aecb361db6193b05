"""Connects the ports of one node: each to a literal or to an entry of its scope."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from py_trees.ports import NoDataAvailable

from pluto_bt.trees.errors import PortMisfit
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.ports import PortModel, PortProblem, range_problem
from pluto_bt.trees.scopes import NO_BOARD, EntryReader, MissingValue, Scope
from pluto_bt.trees.values import ANYTHING, Kind

Readers = dict[str, Callable[[], Any]]
Writers = dict[str, Callable[[Any], None]]


def wire(plan: Plan, ports: dict[str, PortModel]) -> tuple[Readers, Writers]:
    """Functions that read the inputs and write the outputs of a node. A port that leads nowhere has none."""
    readers: Readers = {}
    writers: Writers = {}
    for name, port in ports.items():
        attribute = plan.element.attributes.get(name)
        given = attribute.value if attribute is not None else port.default
        if given is None:
            continue
        key = key_of(name, given) if isinstance(given, str) else None
        if port.direction != "out":
            readers[name] = _literal(port.kind, given) if key is None else _entry(plan.scope, key, port)
        if port.direction != "in" and key is not None:
            writers[name] = _writer(plan.scope, key, port.kind)
    return readers, writers


def _literal(kind: Kind, given: Any) -> Callable[[], Any]:
    """A reader of a value that stands in the file. One that does not fit is told when it is read: the loader let it pass."""
    try:
        value = kind.convert(given) if isinstance(given, str) else given
    except PortProblem as problem:
        sentence = str(problem)

        def refuse() -> Any:
            raise PortProblem(sentence)

        return refuse
    is_shared = isinstance(value, (list, dict)) or hasattr(value, "popleft")

    def read() -> Any:
        return copy.copy(value) if is_shared else value  # a reader must not change the file's value for the others

    read.literal = True  # type: ignore[attr-defined]  # Loop begins a literal queue anew at each activation
    return read


def _entry(scope: Scope, key: str, port: PortModel) -> Callable[[], Any]:
    read = EntryReader(scope, key, ANYTHING if port.kind.raw else port.kind).read
    if port.ge is None and port.le is None and not port.choices and not port.unit:
        return read

    def read_checked() -> Any:
        value = read()
        problem = range_problem(port, value)
        if problem:
            raise PortProblem(f"entry {key!r} = {value!r} is outside what port {port.name!r} allows: {problem}")
        return value

    return read_checked


def _writer(scope: Scope, key: str, kind: Kind) -> Callable[[Any], None]:
    def write(value: Any) -> None:
        scope.write(key, kind.convert(value) if kind.typed else value, kind)

    return write


def wire_leaf(leaf: Any, ports: dict[str, PortModel], readers: Readers, writers: Writers) -> None:
    """Bind py_trees' port methods of this instance to the mission's own store, never to py_trees' global blackboard."""
    written: dict[str, Any] = {}
    leaf.get_input = _get_input(leaf, ports, readers)
    leaf._set_output = _set_output(leaf, ports, writers, written)

    def get_last_output(port_name: str) -> Any:
        _need_output(leaf, ports, port_name)
        if port_name not in written:
            raise NoDataAvailable(f"{leaf.name}: output port {port_name!r} has not been written")
        return written[port_name]

    def reset_port(port_name: str) -> None:
        written.pop(port_name, None)

    leaf.get_last_output, leaf.reset_port, leaf.last_outputs = get_last_output, reset_port, written


def _get_input(leaf: Any, ports: dict[str, PortModel], readers: Readers) -> Callable[..., Any]:
    owners = {name: getattr(read, "__self__", None) for name, read in readers.items()}
    cells = {name: owner for name, owner in owners.items() if isinstance(owner, EntryReader)}
    find = cells.get
    board = next((cell.board for cell in cells.values()), NO_BOARD)

    def get_input(port_name: str, default: Any = None) -> Any:
        cell = find(port_name)
        if cell is not None and cell.seen == board.changes:  # as `EntryReader.read` does; written out, as most leaves do little else
            value = cell.entry.value
            if type(value) is cell.wanted:
                return value
        try:
            return readers[port_name]()
        except MissingValue as missing:
            return _fallback(leaf, ports[port_name], default, f"{missing}; write it on every way that leads here, or once at the beginning")
        except PortProblem as misfit:
            raise PortMisfit(f"port {port_name!r}: {misfit}") from None
        except KeyError:
            if port_name in readers:
                raise
        if port_name not in ports or ports[port_name].direction == "out":
            raise KeyError(f"{leaf.name}: input port {port_name!r} is not declared")
        return _fallback(leaf, ports[port_name], default, "give it in the file")

    return get_input


def _set_output(leaf: Any, ports: dict[str, PortModel], writers: Writers, written: dict[str, Any]) -> Callable[[str, Any], None]:
    def set_output(port_name: str, value: Any) -> None:
        _need_output(leaf, ports, port_name)
        kind = ports[port_name].kind
        try:
            written[port_name] = kind.convert(value) if kind.typed else value
            if port_name in writers:
                writers[port_name](value)
        except PortProblem as misfit:
            raise PortMisfit(f"port {port_name!r}: {misfit}") from None

    return set_output


def _need_output(leaf: Any, ports: dict[str, PortModel], port_name: str) -> None:
    if port_name not in ports or ports[port_name].direction == "in":
        raise KeyError(f"{leaf.name}: output port {port_name!r} is not declared")


def _fallback(leaf: Any, port: PortModel, default: Any, why: str) -> Any:
    """What an input without data gives: the caller's default, the declared one, else NoDataAvailable."""
    if default is not None:
        return default
    if port.default is not None:
        value = port.default
        return port.kind.convert(value) if isinstance(value, str) else copy.deepcopy(value)
    raise NoDataAvailable(f'port "{port.name}" of "{leaf.name}" has no value: {why}')
