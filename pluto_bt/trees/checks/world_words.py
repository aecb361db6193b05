"""What a mission and a world say of one another: named areas, and leaves that the world's script lets fail."""

from __future__ import annotations

from pluto_bt.maps.world import FaultAction, World
from pluto_bt.source import Fault, Faults, Place, did_you_mean
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.loader.pointers import key_of


def check_world_words(root: Plan, world: World, map_: World) -> tuple[Fault, ...]:
    """Faults of names: areas of `map_` that the mission asks for, leaves of the mission that `world` names."""
    faults, nodes = Faults(), root.walk()
    areas = [area.id for area in map_.areas if area.id]
    told: set[int] = set()
    for plan in nodes:
        ports = plan.node_type.ports.values() if plan.node_type is not None else ()
        for name in (port.name for port in ports if port.names == "area"):
            attribute = plan.element.attributes.get(name)
            if attribute is not None and key_of(name, attribute.value) is None and attribute.value not in areas and id(attribute) not in told:
                told.add(id(attribute))
                what = f'the map has no area "{attribute.value}"'
                known = "one of: " + (", ".join(areas) or "none")
                mend = did_you_mean(attribute.value, areas)
                faults.error(attribute.value_place, "unknown-area", what, expected=known, found=attribute.value, mend=mend)
    _check_leaves(nodes, world, faults)
    return faults.in_order()


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
