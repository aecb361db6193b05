"""Finds the steady parts of a mission: `pluto_bt.trees.engine.steady` says what that is."""

from __future__ import annotations

from typing import Any

from py_trees.behaviour import Behaviour

from pluto_bt.trees.engine.conditions import CONDITIONS
from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.node import Node
from pluto_bt.trees.engine.steady import Part, remember
from pluto_bt.trees.loader.pointers import key_of
from pluto_bt.trees.scopes import Board
from pluto_bt.trees.tracked import Tracked


def remember_steady_parts(tracked: list[Tracked], board: Board, context: Context) -> None:
    """Give the topmost node of each steady part a memory; a single leaf is not worth one."""
    parts: dict[int, Part] = {}
    for one in reversed(tracked):  # children before parents
        part = _part_of(one, parts, board)
        if part is not None:
            parts[id(one.node)] = part
    for one in tracked:
        node = one.node
        inside = node.parent is not None and id(node.parent) in parts
        if id(node) in parts and node.children and not inside:
            remember(node, parts[id(node)], board, context)


def _part_of(one: Tracked, parts: dict[int, Part], board: Board) -> Part | None:
    node, attributes = one.node, one.plan.element.attributes
    if any(name in attributes for name in CONDITIONS):
        return None
    if not node.children:
        return _leaf(one, board)
    if not _declares(node, "PASSES_ON") or not all(id(child) in parts for child in node.children):
        return None
    inner = [parts[id(child)] for child in node.children]
    inputs = dict.fromkeys(read for part in inner for read in part.inputs)
    keeps_place = _declares(node, "KEEPS_PLACE") or any(part.places for part in inner)
    return Part(tuple(inputs), tuple(node.iterate()) if keeps_place else ())


def _leaf(one: Tracked, board: Board) -> Part | None:
    node: Any = one.node
    own_tick = not isinstance(node, Node) and type(node).tick is not Behaviour.tick
    if own_tick or not _declares(node, "PORTS_ALONE"):
        return None
    inputs = []
    for attribute in one.plan.element.attributes.values():
        port = one.plan.node_type.ports.get(attribute.name) if one.plan.node_type is not None else None
        key = key_of(attribute.name, attribute.value) if port is not None else None
        if port is None or key is None:
            continue
        if port.direction != "in" or key.removeprefix("@") in board.topic_names or _leads_to_topic(one, key, board):
            return None
        inputs.append((one.plan.scope, key))
    return Part(tuple(inputs))


def _declares(node: Any, what: str) -> bool:
    """True if the very class says so: one that inherits may do more than its parent."""
    return bool(vars(type(node)).get(what, False))


def _leads_to_topic(one: Tracked, key: str, board: Board) -> bool:
    """True if a SubTree maps the key to a topic of the robot."""
    scope = one.plan.scope
    while scope.parent is not None and not key.startswith("@"):
        key, scope = scope.remap.get(key, key), scope.parent
    return key.removeprefix("@") in board.topic_names
