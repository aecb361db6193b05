"""Houses drawn at random: a grid of rooms with doors between them, furniture along the walls. For stories of robots that navigate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

ROOM_M = 6.0
WALL = '<wall id="{id}">{x0:.2f},{y0:.2f} {x1:.2f},{y1:.2f}</wall>'


@dataclass
class House:
    """`text` is the world file; `middles` the middle of each room, row by row; `doors` the middle of each door by the two rooms it joins."""

    text: str
    middles: list[tuple[float, float]]
    doors: dict[tuple[int, int], tuple[float, float]]

    @classmethod
    def make(cls, seed: int, platform: str, door_m: float, columns: int = 3, rows: int = 2, more: str = "", script: str = "") -> House:
        """All neighbouring rooms are joined by a door somewhere in their common wall."""
        rng = np.random.default_rng(seed)
        parts = [f'<wall id="outside">0,0 {columns * ROOM_M},0 {columns * ROOM_M},{rows * ROOM_M} 0,{rows * ROOM_M} 0,0</wall>']
        doors: dict[tuple[int, int], tuple[float, float]] = {}
        for i in range(columns * rows):
            x, y = ROOM_M * (i % columns), ROOM_M * (i // columns)
            at = float(rng.uniform(1.5, ROOM_M - 1.5))
            if i % columns:
                doors[i - 1, i] = (x, y + at)
                parts += _wall(f"w{i}", x, y, at, door_m, upright=True)
            at = float(rng.uniform(1.5, ROOM_M - 1.5))
            if i >= columns:
                doors[i - columns, i] = (x + at, y)
                parts += _wall(f"s{i}", x, y, at, door_m, upright=False)
            dx, dy = rng.uniform(-1.6, 1.6, 2)
            if abs(dx) + abs(dy) > 1.7:
                parts.append(f'<circle id="table{i}" x="{x + ROOM_M / 2 + dx:.2f}" y="{y + ROOM_M / 2 + dy:.2f}" r="0.3"/>')
        middles = [(ROOM_M * (i % columns + 0.5), ROOM_M * (i // columns + 0.5)) for i in range(columns * rows)]
        parts += [f'<goal id="room{i}" x="{x}" y="{y}"/>' for i, (x, y) in enumerate(middles)]
        robot = f'<robot platform="{platform}" x="{middles[0][0]}" y="{middles[0][1]}" ideal="true"/>'
        text = f'<world name="house" seed="{seed}">{"".join(parts)}{more}{robot}{f"<script>{script}</script>" if script else ""}</world>'
        return cls(text, middles, doors)


def _wall(id: str, x: float, y: float, at: float, door_m: float, upright: bool) -> list[str]:
    """A wall of a room's length from (x, y), with a door whose middle is `at` metres along it."""
    ends = ((0.0, at - door_m / 2), (at + door_m / 2, ROOM_M))
    if upright:
        return [WALL.format(id=f"{id}{k}", x0=x, y0=y + low, x1=x, y1=y + high) for k, (low, high) in enumerate(ends)]
    return [WALL.format(id=f"{id}{k}", x0=x + low, y0=y, x1=x + high, y1=y) for k, (low, high) in enumerate(ends)]
