"""Guides drawn at random for follow: somebody leads through a hall with pillars, stops, turns sharply; others cross."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pluto_bt.maps.geometry import Pose

Point = tuple[float, float]
Rng = np.random.Generator
SIDE_M = 18.0
PERSON_M = 0.25
SHARPEST_RAD = math.radians(110.0)  # a guide who turns back more would walk into the robot


@dataclass
class Guide:
    """A hall with people.

    Attributes:
        text: the world file. The robot stands at the middle, looking at the guide, who is the nearest.
        way: corners of the guide's way.
        speed_mps: of the guide.
    """

    text: str
    way: list[Point]
    speed_mps: float

    @classmethod
    def make(cls, seed: int, platform: str = "atrv2", others: int = 2) -> Guide:
        """Draw a hall with pillars, a guide at 0.4 to 0.8 m/s and `others` at 0.4 to 1.2 m/s."""
        rng = np.random.default_rng(seed)
        way = [(2.2, float(rng.uniform(-0.5, 0.5)))]
        heading = 0.0
        while len(way) < 8:
            step_m, to = float(rng.uniform(1.5, 5.0)), heading + float(rng.uniform(-SHARPEST_RAD, SHARPEST_RAD))
            x, y = way[-1][0] + step_m * math.cos(to), way[-1][1] + step_m * math.sin(to)
            if max(abs(x), abs(y)) < 0.5 * SIDE_M - 1.5:
                way.append((round(x, 2), round(y, 2)))
                heading = to
            else:
                heading += math.radians(10.0)  # along the hall's wall
        speed_mps = float(rng.uniform(0.4, 0.8))
        pillars = _pillars(rng, way)
        shapes = [f'<circle id="pillar{i}" x="{x:.2f}" y="{y:.2f}" r="{r:.2f}"/>' for i, (x, y, r) in enumerate(pillars)]
        people = [_actor("guide", way, speed_mps)]
        for i in range(others):
            path = [(float(x), float(y)) for x, y in rng.uniform(-0.5 * SIDE_M + 1.0, 0.5 * SIDE_M - 1.0, (3, 2))]
            if math.hypot(*path[0]) > 4.0:
                people.append(_actor(f"other{i}", path, float(rng.uniform(0.4, 1.2)), loop=True))
        half = 0.5 * SIDE_M
        hall = f'<wall id="hall">{-half},{-half} {half},{-half} {half},{half} {-half},{half} {-half},{-half}</wall>'
        robot = f'<robot platform="{platform}" x="0" y="0" theta_deg="0"/>'
        return cls(f'<world name="guide{seed}" seed="{seed}">{hall}{"".join(shapes)}{"".join(people)}{robot}</world>', way, speed_mps)

    def at(self, t_s: float) -> Point:
        """Where the guide is."""
        to_go_m = self.speed_mps * t_s
        for a, b in pairwise(self.way):
            length_m = math.dist(a, b)
            if to_go_m < length_m:
                return a[0] + to_go_m / length_m * (b[0] - a[0]), a[1] + to_go_m / length_m * (b[1] - a[1])
            to_go_m -= length_m
        return self.way[-1]

    @property
    def lasts_s(self) -> float:
        """How long the guide walks."""
        return sum(math.dist(a, b) for a, b in pairwise(self.way)) / self.speed_mps

    def near_share(self, track: Sequence[tuple[float, Pose]], within_m: float) -> float:
        """In which share of the track the robot is so near to the guide."""
        return sum(math.dist(pose[:2], self.at(t_s)) < within_m for t_s, pose in track) / max(1, len(track))


def _pillars(rng: Rng, way: Sequence[Point]) -> list[tuple[float, float, float]]:
    """Pillars beside the guide's way, and not where the robot begins."""
    found: list[tuple[float, float, float]] = []
    for _ in range(12):
        x, y, r = (float(value) for value in (*rng.uniform(-0.5 * SIDE_M + 1.0, 0.5 * SIDE_M - 1.0, 2), rng.uniform(0.1, 0.4)))
        gap_m = min(_to_piece((x, y), a, b) for a, b in pairwise(way)) - r
        if gap_m > 0.9 and math.hypot(x, y) - r > 1.5:
            found.append((x, y, r))
    return found


def _to_piece(p: Point, a: Point, b: Point) -> float:
    step = (b[0] - a[0], b[1] - a[1])
    share = ((p[0] - a[0]) * step[0] + (p[1] - a[1]) * step[1]) / max(step[0] ** 2 + step[1] ** 2, 1e-9)
    share = min(1.0, max(0.0, share))
    return math.dist(p, (a[0] + share * step[0], a[1] + share * step[1]))


def _actor(name: str, way: Sequence[Point], speed_mps: float, loop: bool = False) -> str:
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in way)
    return f'<actor id="{name}" r="{PERSON_M}" speed="{speed_mps:.2f}" loop="{str(loop).lower()}">{points}</actor>'
