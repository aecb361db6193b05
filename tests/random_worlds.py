"""Worlds drawn at random, and the same things as plain lists for the slow twins."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.world import Actor, OccupancyGrid, Shape, World


def star(rng, x, y, radius):
    """A simple polygon around a point, often not convex."""
    angles = np.sort(rng.uniform(0, 2 * math.pi, rng.integers(3, 9)))
    far = rng.uniform(0.3, 1.0, len(angles)) * radius
    return np.column_stack((x + far * np.cos(angles), y + far * np.sin(angles)))


def random_shape(rng, kind, id):
    x, y = rng.uniform(-10, 10, 2)
    height_m = float(rng.choice([0.15, 0.5, 2.0]))
    if kind == "circle":
        return Shape(id, "circle", np.array([[x, y]]), float(rng.uniform(0.05, 1.0)), height_m)
    if kind == "wall":
        return Shape(id, "wall", np.cumsum(np.vstack(([x, y], rng.normal(0, 2, (rng.integers(1, 5), 2)))), axis=0), 0.0, height_m)
    return Shape(id, kind, star(rng, x, y, rng.uniform(0.3, 3.0)), 0.0, height_m)


def random_grid(rng):
    occupied = (rng.random((rng.integers(20, 60), rng.integers(20, 60))) < 0.02).astype(np.uint8)
    return OccupancyGrid(occupied, np.zeros_like(occupied), float(rng.choice([0.1, 0.25])), (*rng.uniform(-6, 0, 2), float(rng.uniform(-3, 3))))


def random_world(seed, grid=False, kinds=("wall", "polygon", "circle", "hole")):
    rng = np.random.default_rng(seed)
    shapes = tuple(random_shape(rng, rng.choice(kinds), f"s{i}") for i in range(rng.integers(0, 14)))
    actors = tuple(Actor(f"a{i}", float(rng.uniform(0.1, 0.5)), 1.0, True, rng.uniform(-8, 8, (2, 2))) for i in range(rng.integers(0, 3)))
    return World("random", shapes=shapes, actors=actors, grid=random_grid(rng) if grid else None), rng


def cells(grid):
    """The solid cells of a grid as squares in the map frame, (4, 2) each."""
    x, y, theta = grid.origin
    turn = np.array([[math.cos(theta), math.sin(theta)], [-math.sin(theta), math.cos(theta)]])
    for row, column in np.argwhere(grid.occupied):
        corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + np.array((column, row))
        yield corners * grid.resolution_m @ turn + np.array((x, y))


def plain(world):
    """(solids, holes) for `slow_range`: a solid is (kind, points, radius, height)."""
    solids = [(s.kind, s.points, s.radius_m, s.height_m) for s in world.shapes if s.kind != "hole"]
    solids += [("circle", a.waypoints[:1], a.radius_m, a.height_m) for a in world.actors]
    if world.grid is not None:
        solids += [("polygon", square, 0.0, 2.0) for square in cells(world.grid)]
    return solids, [s.points for s in world.shapes if s.kind == "hole"]
