"""Houses and rooms drawn at random for wall follow, and how well a camera kept its distance from them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.geometry import Pose
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.skills.wall_parameters import WallParameters
from pluto_bt.track import TrackPoint

Array = NDArray[np.float64]
Rng = np.random.Generator
POST_CORNERS = 16
DOOR_M = (0.8, 1.5)
NEAR_M, SETTLED_M = 0.1, 1.0  # a camera that is so near to its distance for so much of the robot's way has arrived


@dataclass
class Building:
    """A house, or a room with `inside`, with the robot beside the middle of one of its sides.

    Attributes:
        text: the world file.
        edges: (n, 4) x, y, x, y of all that stands.
        way_m: about how long once around is.
    """

    text: str
    edges: Array
    way_m: float

    @classmethod
    def for_seed(cls, seed: int) -> tuple[Building, str, str]:
        """A building, the platform and the side to follow it on: every platform, inside and outside, both sides, in turn."""
        platform, inside, right = ("atrv2", "pioneer")[seed % 2], seed // 2 % 2 == 1, seed // 4 % 2 == 1
        wall = load_robot_file(platform).wall
        return cls.make(seed, platform, inside, right, wall.distance_m + wall.camera_side_m), platform, "right" if right else "left"

    @classmethod
    def make(cls, seed: int, platform: str, inside: bool, right: bool, middle_m: float) -> Building:
        """Draw one. `right`: the wall is on the right of the robot; `middle_m`: about how far from it the robot's middle is at the start."""
        rng = np.random.default_rng(seed)
        width_m, depth_m = rng.uniform(7.0, 13.0, 2) if inside else rng.uniform(5.0, 12.0, 2)
        corners = np.array([(0.0, 0.0), (width_m, 0.0), (width_m, depth_m), (0.0, depth_m)])
        outward = -1.0 if inside else 1.0
        outline = [corners[0]]
        things: list[Array] = []
        for k in range(1, 4):  # the side with the robot stays plain
            a, b = corners[k], corners[(k + 1) % 4]
            outline += [a, *_bay(rng, a, b)]
            if rng.random() < 0.6:
                things.append(_thing(rng, a, b, outward))
        walls = _with_door(rng, np.array([*outline, corners[0]]))
        turn = float(rng.uniform(-math.pi, math.pi))
        c, s = math.cos(turn), math.sin(turn)
        spin = np.array([[c, s], [-s, c]])
        walls = [wall @ spin for wall in walls]
        things = [np.vstack((thing, thing[:1])) @ spin for thing in things]
        x, y = np.array([0.5 * width_m, -outward * (middle_m + float(rng.uniform(-0.2, 0.6)))]) @ spin
        theta_deg = math.degrees(turn + float(rng.uniform(-0.6, 0.6))) + (0.0 if inside == right else 180.0)
        shapes = [f'<wall id="wall{i}">{_text(wall)}</wall>' for i, wall in enumerate(walls)]
        shapes += [f'<polygon id="thing{i}">{_text(thing[:-1])}</polygon>' for i, thing in enumerate(things)]
        robot = f'<robot platform="{platform}" x="{x:.3f}" y="{y:.3f}" theta_deg="{theta_deg:.1f}"/>'
        edges = np.vstack([np.hstack((line[:-1], line[1:])) for line in (*walls, *things)])
        return cls(f'<world name="building{seed}" seed="{seed}">{"".join(shapes)}{robot}</world>', edges, 2.0 * (width_m + depth_m))


def _bay(rng: Rng, a: Array, b: Array) -> list[Array]:
    """The corners of a bay or a niche, or of a slight bend, somewhere on the side from a to b; none on every third."""
    length_m = float(np.hypot(*(b - a)))
    along, out = (b - a) / length_m, np.array([(b - a)[1], -(b - a)[0]]) / length_m
    kind = rng.integers(0, 3)
    if kind == 0:
        return []
    if kind == 1:
        return [a + along * length_m * rng.uniform(0.3, 0.7) + out * rng.uniform(-0.5, 0.5)]
    width_m, depth_m = min(float(rng.uniform(0.5, 4.0)), 0.5 * length_m), float(rng.uniform(-1.2, 1.2))
    at = float(rng.uniform(0.2 * length_m, 0.8 * length_m - width_m)) if width_m < 0.6 * length_m else 0.2 * length_m
    foot, end = a + along * at, a + along * (at + width_m)
    return [foot, foot + out * depth_m, end + out * depth_m, end]


def _thing(rng: Rng, a: Array, b: Array, outward: float) -> Array:
    """The corners of a post or a box that stands near the side from a to b."""
    length_m = float(np.hypot(*(b - a)))
    along, free = (b - a) / length_m, outward * np.array([(b - a)[1], -(b - a)[0]]) / length_m
    middle = a + along * length_m * rng.uniform(0.2, 0.8) + free * rng.uniform(0.2, 1.2)
    if rng.random() < 0.5:
        angles = np.arange(POST_CORNERS) * math.tau / POST_CORNERS
        return np.asarray(middle + float(rng.uniform(0.05, 0.25)) * np.column_stack((np.cos(angles), np.sin(angles))))
    half = rng.uniform(0.15, 0.6, 2)
    tilt = float(rng.uniform(-math.pi, math.pi))
    c, s = math.cos(tilt), math.sin(tilt)
    return np.asarray(np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half @ np.array([[c, s], [-s, c]]) + middle)


def _with_door(rng: Rng, loop: Array) -> list[Array]:
    """The closed loop with an open door in one of its longer pieces, the first one excepted; as one open polyline."""
    lengths = np.hypot(*np.diff(loop, axis=0).T)
    door_m = float(rng.uniform(*DOOR_M))
    where = [k for k in range(1, len(lengths)) if lengths[k] > door_m + 1.0]
    if not where:
        return [loop]
    k = int(rng.choice(where))
    share = float(rng.uniform(0.5, lengths[k] - door_m - 0.5)) / lengths[k]
    step = loop[k + 1] - loop[k]
    left, right = loop[k] + share * step, loop[k] + (share + door_m / lengths[k]) * step
    return [np.vstack((right, loop[k + 1 : -1], loop[: k + 1], left))]


def _text(points: Array) -> str:
    return " ".join(f"{x:.3f},{y:.3f}" for x, y in points.tolist())


class Kept(NamedTuple):
    """How a camera kept its distance from the nearest wall: the farthest off, in metres.

    Attributes:
        straight_m: beside straight walls.
        corner_m: anywhere else.
        straight_share: of the way that led beside straight walls.

    The way until the camera first had its distance (within `NEAR_M`) for `SETTLED_M` is left out: the robot is still on its way to the wall.
    """

    straight_m: float
    corner_m: float
    straight_share: float


def kept(track: Sequence[TrackPoint], wall: WallParameters, side: str, edges: Array, distance_m: float) -> Kept:
    """How a run kept the distance, from when the camera first had it for a metre."""
    poses = [point.pose for point in track]
    way_m = np.concatenate(([0.0], np.cumsum([math.dist(a[:2], b[:2]) for a, b in itertools.pairwise(poses)])))
    cameras = camera_path(poses, wall.camera_back_m, wall.camera_side_m if side == "left" else -wall.camera_side_m)
    far = np.append(np.flatnonzero(np.abs(distances(cameras, edges)[0] - distance_m) >= NEAR_M), len(poses) - 1)
    next_far = far[np.searchsorted(far, np.arange(len(poses)))]
    arrived = np.flatnonzero(way_m[next_far] - way_m >= SETTLED_M)
    if not len(arrived):
        return Kept(math.inf, math.inf, 0.0)
    swing_m, middle_m = math.hypot(wall.camera_back_m, wall.camera_side_m), distance_m + wall.camera_side_m
    return kept_distance(cameras[arrived[0] :], edges, distance_m, middle_m + swing_m)


def camera_path(poses: Sequence[Pose], back_m: float, side_m: float) -> Array:
    """(n, 2) where a camera was that is held `back_m` behind and `side_m` to the left of the robot."""
    x, y, theta = np.array(poses).T
    c, s = np.cos(theta), np.sin(theta)
    return np.column_stack((x - c * back_m - s * side_m, y - s * back_m + c * side_m))


def distances(points: Array, edges: Array) -> tuple[Array, Array]:
    """(n,) how far points (n, 2) are from the nearest edge, and (n, 2) the nearest place on it."""
    starts, steps = edges[:, None, :2], edges[:, None, 2:] - edges[:, None, :2]
    share = np.clip(((points - starts) * steps).sum(-1) / np.maximum((steps**2).sum(-1), 1e-12), 0.0, 1.0)
    feet = starts + share[..., None] * steps
    away = np.hypot(feet[..., 0] - points[:, 0], feet[..., 1] - points[:, 1])
    nearest = away.argmin(axis=0), np.arange(len(points))
    return away[nearest], feet[nearest]


def kept_distance(cameras: Array, edges: Array, distance_m: float, corner_m: float) -> Kept:
    """Compare the distances of points (n, 2) from the nearest edge with the one to keep.

    Where an end of an edge is nearer than `corner_m` to the camera, or to the place on the wall beside it, is a corner: there the robot turns,
    and so far behind it the camera swings.
    """
    away, feet = distances(cameras, edges)
    ends = np.vstack((edges[:, :2], edges[:, 2:]))
    to_end_m = [np.hypot(*(places[:, None] - ends).transpose(2, 0, 1)).min(axis=1) for places in (cameras, feet)]
    is_straight = np.minimum(*to_end_m) > corner_m
    off = np.abs(away - distance_m)
    return Kept(float(off[is_straight].max(initial=0.0)), float(off[~is_straight].max(initial=0.0)), float(is_straight.mean()))
