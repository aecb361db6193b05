"""Towns drawn at random: blocks of houses between streets, some of them closed, with parked cars, lamp posts and things that lie low.

`Town.make(seed)` gives the world as text, a start and a goal on the streets between which a way of 1.2 m to each side exists.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
CELL_M = 0.5
NEEDED_M = 1.2


@dataclass
class Town:
    """One town: `text` is the world file; start is x m, y m, theta degrees."""

    text: str
    start: tuple[float, float, float]
    goal: tuple[float, float]
    way_m: float

    @classmethod
    def make(cls, seed: int, walkers: int = 0) -> Town:
        """Draw towns until one has a start and a goal that are worth a drive."""
        rng = np.random.default_rng(seed)
        while True:
            town = _draw(rng, seed, walkers)
            if town is not None:
                return town


def _draw(rng: np.random.Generator, seed: int, walkers: int) -> Town | None:
    columns, rows = int(rng.integers(2, 4)), int(rng.integers(2, 4))
    xs, ys = _axis(rng, columns), _axis(rng, rows)
    width, height = xs[-1], ys[-1]
    shapes = [f'<wall id="town">0,0 {width:.2f},0 {width:.2f},{height:.2f} 0,{height:.2f} 0,0</wall>']
    solids: list[tuple[float, float, float, float]] = []
    for i in range(columns):
        for j in range(rows):
            x0, x1, y0, y1 = xs[2 * i + 1], xs[2 * i + 2], ys[2 * j + 1], ys[2 * j + 2]
            dent = rng.uniform(0.0, 1.0, 4)
            solids.append((x0 + dent[0], y0 + dent[1], x1 - dent[2], y1 - dent[3]))
    for _ in range(int(rng.integers(0, 3))):  # a street closed by a wall from house to house, or to the edge of the town
        i, j = int(rng.integers(0, columns + 1)), int(rng.integers(0, rows))
        x0, x1, y = xs[2 * i], xs[2 * i + 1], rng.uniform(ys[2 * j + 1] + 1.5, ys[2 * j + 2] - 1.5)
        solids.append((x0 - 1.2 * (i > 0), y, x1 + 1.2 * (i < columns), y + 0.3))
    for _ in range(int(rng.integers(2, 7))):  # parked cars along the houses
        x, y = rng.uniform(2.0, width - 2.0), rng.uniform(2.0, height - 2.0)
        solids.append((x - 2.0, y - 0.9, x + 2.0, y + 0.9) if rng.random() < 0.5 else (x - 0.9, y - 2.0, x + 0.9, y + 2.0))
    for k, (x0, y0, x1, y1) in enumerate(solids):
        shapes.append(f'<polygon id="s{k}">{x0:.2f},{y0:.2f} {x1:.2f},{y0:.2f} {x1:.2f},{y1:.2f} {x0:.2f},{y1:.2f}</polygon>')
    posts = rng.uniform((1.0, 1.0), (width - 1.0, height - 1.0), (int(rng.integers(3, 9)), 2))
    shapes += [f'<circle id="lamp{k}" x="{x:.2f}" y="{y:.2f}" r="0.12"/>' for k, (x, y) in enumerate(posts)]
    free = _free(width, height, solids, posts)
    ends = _ends(rng, free)
    if ends is None:
        return None
    start, goal, way_m = ends
    actors = [_walker(rng, free, k) for k in range(walkers)]
    theta = float(rng.integers(0, 360))
    text = f'<world name="town{seed}" seed="{seed}">\n' + "\n".join([*shapes, *actors])
    text += f'\n<robot platform="atrv2" x="{start[0]:.2f}" y="{start[1]:.2f}" theta_deg="{theta:.0f}"/>\n</world>'
    return Town(text, (*start, theta), goal, way_m)


def _axis(rng: np.random.Generator, blocks: int) -> list[float]:
    """Where streets and blocks begin along one side: street, block, street, …"""
    at, places = 0.0, [0.0]
    for _ in range(blocks):
        for size in (rng.uniform(4.0, 9.0), rng.uniform(8.0, 18.0)):
            at += size
            places.append(at)
    return [*places, at + rng.uniform(4.0, 9.0)]


def _free(width: float, height: float, solids: list[tuple[float, float, float, float]], posts: NDArray[np.float64]) -> Mask:
    """Which cells keep NEEDED_M from everything."""
    x, y = np.meshgrid(np.arange(0.0, width, CELL_M), np.arange(0.0, height, CELL_M), indexing="ij")
    near = np.minimum(np.minimum(x, width - x), np.minimum(y, height - y))
    for x0, y0, x1, y1 in solids:
        outside = np.hypot(np.maximum(np.maximum(x0 - x, x - x1), 0.0), np.maximum(np.maximum(y0 - y, y - y1), 0.0))
        near = np.minimum(near, outside)
    for px, py in posts:
        near = np.minimum(near, np.hypot(x - px, y - py) - 0.12)
    free: Mask = near > NEEDED_M
    return free


def _ends(rng: np.random.Generator, free: Mask) -> tuple[tuple[float, float], tuple[float, float], float] | None:
    cells = np.argwhere(free)
    if not len(cells):
        return None
    i, j = cells[rng.integers(len(cells))].tolist()
    first = (int(i), int(j))
    steps = _steps(free, first)
    far = np.argwhere(steps > 25.0 / CELL_M)
    if not len(far):
        return None
    a, b = far[rng.integers(len(far))].tolist()
    return (first[0] * CELL_M, first[1] * CELL_M), (a * CELL_M, b * CELL_M), float(steps[a, b]) * CELL_M


def _steps(free: Mask, start: tuple[int, int]) -> NDArray[np.int_]:
    """Steps from the start to each free cell, -1 = none."""
    steps = np.full(free.shape, -1)
    steps[start] = 0
    queue = deque([start])
    while queue:
        i, j = queue.popleft()
        for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b] and steps[a, b] < 0:
                steps[a, b] = steps[i, j] + 1
                queue.append((a, b))
    return steps


def _walker(rng: np.random.Generator, free: Mask, k: int) -> str:
    cells = np.argwhere(free)
    i, j = cells[rng.integers(len(cells))]
    angle = rng.uniform(0.0, math.tau)
    reach = 0.0
    while reach < 8.0:
        a, b = int(i + (reach + CELL_M) / CELL_M * math.cos(angle)), int(j + (reach + CELL_M) / CELL_M * math.sin(angle))
        if not (0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b]):
            break
        reach += CELL_M
    x, y = i * CELL_M, j * CELL_M
    speed = rng.uniform(0.5, 1.4)
    return (f'<actor id="walker{k}" r="0.25" speed="{speed:.2f}" loop="true">{x:.2f},{y:.2f} '
            f'{x + reach * math.cos(angle):.2f},{y + reach * math.sin(angle):.2f} {x:.2f},{y:.2f}</actor>')  # fmt: skip
