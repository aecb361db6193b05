"""Yards drawn at random for explore: a fence, sheds, walls and trees; and how much of the ground that can be reached was covered."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pluto_bt.blackboard.messages import LocalMapState

Mask = NDArray[np.bool_]
CELL_M = 0.25
BODY_M = 0.75  # ground that the middle of the robot can reach keeps so far from everything
COVERED = 2


@dataclass
class Yard:
    """One yard: its world file, the rectangle (b, h) in front of the start, and which ground can be reached."""

    text: str
    start: tuple[float, float, float]
    rectangle: tuple[float, float]
    reachable: Mask

    @classmethod
    def make(cls, seed: int) -> Yard:
        """Draw a yard with the robot at the middle of its west side, looking east."""
        rng = np.random.default_rng(seed)
        width, height = rng.uniform(12.0, 30.0), rng.uniform(10.0, 24.0)
        start = (1.5, height / 2.0, 0.0)
        rectangle = (height / 2.0 - rng.uniform(0.0, 2.0), width - 1.5 - rng.uniform(0.0, 3.0))
        boxes = [(0.0, 0.0, width, 0.05), (0.0, height - 0.05, width, height), (0.0, 0.0, 0.05, height), (width - 0.05, 0.0, width, height)]
        shapes = [f'<wall id="fence">0,0 {width:.2f},0 {width:.2f},{height:.2f} 0,{height:.2f} 0,0</wall>']
        for k in range(int(rng.integers(2, 7))):
            x, y, sx, sy = rng.uniform(5.0, width - 1.0), rng.uniform(1.0, height - 1.0), rng.uniform(0.3, 4.0), rng.uniform(0.3, 4.0)
            box = (x, y, min(x + sx, width), min(y + sy, height))
            boxes.append(box)
            x0, y0, x1, y1 = box
            shapes.append(f'<polygon id="s{k}">{x0:.2f},{y0:.2f} {x1:.2f},{y0:.2f} {x1:.2f},{y1:.2f} {x0:.2f},{y1:.2f}</polygon>')
        text = f'<world name="yard{seed}" seed="{seed}">' + "".join(shapes)
        text += f'<robot platform="atrv2" x="{start[0]:.2f}" y="{start[1]:.2f}" theta_deg="0"/></world>'
        return cls(text, start, rectangle, _reachable(width, height, boxes, start, rectangle))

    def covered_share(self, shown: LocalMapState) -> float:
        """How much of the reachable ground the map shows as covered."""
        cells = np.frombuffer(shown.cells, dtype=np.uint8).reshape(shown.rows, shown.columns)
        x, y = (np.argwhere(self.reachable) * CELL_M + 0.5 * CELL_M).T
        i, j = np.floor((x - shown.x_m) / shown.cell_m).astype(int), np.floor((y - shown.y_m) / shown.cell_m).astype(int)
        inside = (i >= 0) & (i < shown.rows) & (j >= 0) & (j < shown.columns)
        return float(np.count_nonzero(cells[i[inside], j[inside]] == COVERED)) / len(x)


def _reachable(
    width: float, height: float, boxes: list[tuple[float, float, float, float]], start: tuple[float, float, float], rectangle: tuple[float, float]
) -> Mask:
    x, y = np.meshgrid(np.arange(0.0, width, CELL_M) + CELL_M / 2, np.arange(0.0, height, CELL_M) + CELL_M / 2, indexing="ij")
    near = np.full(x.shape, math.inf)
    for x0, y0, x1, y1 in boxes:
        near = np.minimum(near, np.hypot(np.maximum(np.maximum(x0 - x, x - x1), 0.0), np.maximum(np.maximum(y0 - y, y - y1), 0.0)))
    base, depth = rectangle
    free = (near > BODY_M) & (x >= start[0]) & (x <= start[0] + depth) & (np.abs(y - start[1]) <= base)
    found = np.zeros(free.shape, dtype=bool)
    first = (int((start[0] + 0.3) / CELL_M), int(start[1] / CELL_M))
    found[first], queue = True, deque([first])
    while queue:
        i, j = queue.popleft()
        for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= a < free.shape[0] and 0 <= b < free.shape[1] and free[a, b] and not found[a, b]:
                found[a, b] = True
                queue.append((a, b))
    return found
