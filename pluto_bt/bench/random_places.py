"""Places drawn at random that nobody tuned to: rooms with doors and furniture, a street, a wood of posts, each with people if wanted."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from pluto_bt.maps.world import Actor, Shape, World

Rng = np.random.Generator
DOOR_M = (1.5, 2.2)


def rooms(rng: Rng, people: int = 0) -> World:
    """Two by two rooms of five to seven metres, a door in each wall between them, some boxes and a round table."""
    width_m, depth_m = rng.uniform(10.0, 14.0, 2)
    x, y = width_m * rng.uniform(0.45, 0.55), depth_m * rng.uniform(0.45, 0.55)
    shapes = [_fence(width_m, depth_m)]
    for i, (low, high) in enumerate(((0.0, y), (y, depth_m))):
        shapes += [_wall(f"wall{i}{j}", [(x, a), (x, b)]) for j, (a, b) in enumerate(_with_door(rng, low, high))]
    for i, (low, high) in enumerate(((0.0, x), (x, width_m))):
        shapes += [_wall(f"wall{2 + i}{j}", [(a, y), (b, y)]) for j, (a, b) in enumerate(_with_door(rng, low, high))]
    shapes += [_box(rng, f"box{i}", rng.uniform(1.0, width_m - 1.0), rng.uniform(1.0, depth_m - 1.0), 0.3, 0.9) for i in range(4)]
    shapes.append(_post("table", rng.uniform(2.0, width_m - 2.0), rng.uniform(2.0, depth_m - 2.0), 0.5))
    return World("rooms", shapes=tuple(shapes), actors=_people(rng, people, width_m, depth_m))


def street(rng: Rng, people: int = 0) -> World:
    """Forty metres between two house fronts with corners, parked cars on one side, lamp posts on the other."""
    length_m, width_m = 40.0, float(rng.uniform(8.0, 12.0))
    corners = np.linspace(0.0, length_m, 9)
    shapes = [
        _wall("north", [(x, width_m + float(rng.uniform(0.0, 0.8))) for x in corners]),
        _wall("south", [(x, -float(rng.uniform(0.0, 0.8))) for x in corners]),
    ]
    parked = (i for i in range(6) if rng.random() < 0.7)
    shapes += [_box(rng, f"car{i}", 4.0 + 6.5 * i + rng.uniform(-1.0, 1.0), 1.3, 1.8, 4.2, rng.normal(0.0, 0.04)) for i in parked]
    shapes += [_post(f"lamp{i}", 3.0 + 7.0 * i, width_m - 1.2, 0.08) for i in range(6)]
    shapes += [_post(f"bin{i}", rng.uniform(3.0, 37.0), rng.uniform(3.5, width_m - 3.0), 0.3) for i in range(4)]
    return World("street", shapes=tuple(shapes), actors=_people(rng, people, length_m, width_m))


def wood(rng: Rng, people: int = 0) -> World:
    """Posts and trees in a fenced square, nowhere nearer to each other than two metres."""
    side_m = 18.0
    places: list[tuple[float, float]] = []
    for _ in range(300):
        x, y = rng.uniform(1.0, side_m - 1.0, 2).tolist()
        if all(math.dist((x, y), other) > 2.4 for other in places) and len(places) < 26:
            places.append((x, y))
    shapes = [_fence(side_m, side_m)] + [_post(f"tree{i}", x, y, float(rng.uniform(0.05, 0.35))) for i, (x, y) in enumerate(places)]
    return World("wood", shapes=tuple(shapes), actors=_people(rng, people, side_m, side_m))


def lone_thing(rng: Rng) -> World:
    """A wide fenced field with one thing in its middle: a post, a box, a parked car, or two metres of wall."""
    kind, turn_rad = int(rng.integers(4)), float(rng.uniform(-math.pi, math.pi))
    dx, dy = math.cos(turn_rad), math.sin(turn_rad)
    thing = (
        _post("post", 0.0, 0.0, float(rng.uniform(0.03, 0.6))),
        _box(rng, "box", 0.0, 0.0, 0.3, 1.2),
        _box(rng, "car", 0.0, 0.0, 1.8, 4.2, turn_rad),
        _wall("wall", [(-dx, -dy), (dx, dy)]),
    )[kind]
    return World("one thing", shapes=(_wall("fence", [(-9, -9), (9, -9), (9, 9), (-9, 9), (-9, -9)]), thing))


PLACES: dict[str, Callable[[Rng, int], World]] = {"rooms": rooms, "street": street, "wood": wood}


def _fence(width_m: float, depth_m: float) -> Shape:
    return _wall("fence", [(0, 0), (width_m, 0), (width_m, depth_m), (0, depth_m), (0, 0)])


def _wall(id: str, points: list[tuple[float, float]]) -> Shape:
    return Shape(id, "wall", np.array(points, dtype=float))


def _post(id: str, x: float, y: float, radius_m: float) -> Shape:
    return Shape(id, "circle", np.array([[x, y]]), radius_m)


def _box(rng: Rng, id: str, x: float, y: float, shortest_m: float, longest_m: float, turn_rad: float | None = None) -> Shape:
    """A box around a point, turned anyhow unless said."""
    theta = float(rng.uniform(-math.pi, math.pi)) if turn_rad is None else turn_rad
    half = np.array([longest_m, shortest_m] if turn_rad is not None else rng.uniform(shortest_m, longest_m, 2)) / 2.0
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    return Shape(id, "polygon", corners @ np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]]) + (x, y))


def _with_door(rng: Rng, low: float, high: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """The two pieces of a wall from `low` to `high` that a door leaves."""
    door_m = float(rng.uniform(*DOOR_M))
    at = float(rng.uniform(low + 0.6, high - 0.6 - door_m))
    return (low, at), (at + door_m, high)


def _people(rng: Rng, count: int, width_m: float, depth_m: float) -> tuple[Actor, ...]:
    """Who walks to and fro between some points, at a stroll, through everything."""
    return tuple(
        Actor(f"person{i}", 0.25, float(rng.uniform(0.4, 1.1)), True, rng.uniform((1.0, 1.0), (width_m - 1.0, depth_m - 1.0), (3, 2)))
        for i in range(count)
    )
