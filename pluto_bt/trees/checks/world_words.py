"""What a mission and a world say of one another: named areas and goals, and leaves that the world's script lets fail."""

from __future__ import annotations

from dataclasses import replace

from pluto_bt.behaviours.destinations import Destination, Destinations
from pluto_bt.maps.script import FaultAction
from pluto_bt.maps.world import World
from pluto_bt.source import Fault, Faults, Place, did_you_mean
from pluto_bt.trees.checks.entries import known_text, written_homes
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.python_types import kind_of_type


def check_world_words(root: Plan, world: World, map_: World, *, may_fail: bool = False) -> tuple[Fault, ...]:
    """Faults of names: areas and goals of `map_` that the mission asks for, leaves of the mission that `world` names.

    With `may_fail` a name that the map does not have is a warning: the leaf will fail with a reason, and the mission may be ready for that.
    """
    faults, nodes = Faults(), root.walk()
    words = Faults()
    written, told = written_homes(nodes), set[tuple[Place, str]]()
    for plan in nodes:
        ports = plan.node_type.ports.values() if plan.node_type is not None else ()
        for port in ports:
            attribute = plan.element.attributes.get(port.name)
            text = known_text(plan, port.name, written) if attribute is not None and port.direction != "out" else None
            if attribute is not None and text is not None and (attribute.value_place, text) not in told:
                told.add((attribute.value_place, text))
                _check_word(text, attribute.value_place, port, map_, words)
    faults.extend(replace(fault, severity="warning") if may_fail else fault for fault in words.in_order())
    _check_leaves(nodes, world, faults)
    return faults.in_order()


def goals_of(map_: World) -> dict[str, tuple[float, float]]:
    """The places of a map by name, x m, y m; `home` is one if the map has it."""
    goals = {goal.id: (goal.x_m, goal.y_m) for goal in map_.goals}
    return goals if map_.home is None else goals | {"home": (map_.home.x_m, map_.home.y_m)}


def tell_unknown_goal(place: Place, name: str, map_: World, faults: Faults) -> None:
    """The map has no goal of that name."""
    goals = goals_of(map_)
    known = "one of: " + (", ".join(goals) or "none")
    faults.error(place, "unknown-goal", f'the map has no goal "{name}"', expected=known, found=name, mend=did_you_mean(name, goals))


def _check_word(text: str, place: Place, port: PortModel, map_: World, faults: Faults) -> None:
    """A port whose value names a place of the map."""
    if port.names == "area":
        areas = [area.id for area in map_.areas if area.id]
        if text not in areas:
            what, known = f'the map has no area "{text}"', "one of: " + (", ".join(areas) or "none")
            faults.error(place, "unknown-area", what, expected=known, found=text, mend=did_you_mean(text, areas))
    elif port.kind in (kind_of_type(Destination), kind_of_type(Destinations)):
        try:
            value = port.kind.parse(text)
        except ValueError:
            return  # told by the static check
        for one in value if isinstance(value, Destinations) else [value]:
            if one.name and one.name not in goals_of(map_):
                tell_unknown_goal(place, one.name, map_, faults)


def _check_leaves(nodes: list[Plan], world: World, faults: Faults) -> None:
    leaves = [plan for plan in nodes if not plan.children]
    names = dict.fromkeys(name for plan in leaves for name in (plan.name, plan.type_name, plan.path))
    for action in (action for entry in world.script for action in entry.actions):
        name = action.device.removeprefix("leaf:") if isinstance(action, FaultAction) and action.device.startswith("leaf:") else None
        if name is not None and name not in names:
            place = action.place if action.place.file else Place(world.file, action.place.line, action.place.column, action.place.text)
            what, known = f'the mission has no leaf "{name}"', [plan.name for plan in leaves]
            expected = "name, type or path of a leaf: " + ", ".join(dict.fromkeys(known))
            faults.error(place, "unknown-leaf", what, expected=expected, found=name, mend=did_you_mean(name, names))
