"""Motion of the robot's outline through a scene: is a way free.

The bound that is used: when the robot moves from pose a to pose b, no point of the outline moves further than
`hypot(dx, dy) + radius * |dtheta|`, where radius is the furthest corner from the robot's origin. As long as the sum of that stays below
the last exact clearance there is no contact, and nothing needs to be looked at.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from pluto_bt.maps.geometry import Pose, transform_points, wrap_angle
from pluto_bt.maps.scene import Nearest, Scene


class Blocked(NamedTuple):
    """Where a way is not free: the leg from `poses[leg]` on, the robot's pose there, and what is too near."""

    leg: int
    pose_map_robot: Pose
    nearest: Nearest


def path_is_clear(scene: Scene, outline_robot_m: ArrayLike, poses: Sequence[Pose], margin_m: float = 0.0, step_m: float = 0.01) -> Blocked | None:
    """The first place on a way where the outline comes as near as `margin_m` to something solid, or touches it; None = the way is free.

    Between two poses the robot moves straight while it turns evenly, the short way. The way is walked in steps as long as the clearance
    allows, so that nothing is missed; where it is tight, by `step_m`, and what then reaches in by less than half of that may pass unseen.

    Raises: ValueError for a `step_m` that is not above 0.
    """
    if not step_m > 0.0:
        raise ValueError(f"a way is not walked in steps of {step_m} m")
    outline = np.array(outline_robot_m, dtype=np.float64)
    radius_m = outline_radius_m(outline)
    for leg, (start, end) in enumerate(zip(poses, [*poses[1:], *poses[-1:]], strict=True)):
        length_m = motion_bound_m(start, end, radius_m)
        done_m = 0.0
        while True:
            pose = between(start, end, done_m / length_m if length_m > 0.0 else 0.0)
            nearest = scene.clearance(transform_points(pose, outline))
            if nearest.distance_m <= margin_m:
                return Blocked(leg, pose, nearest)
            if done_m >= length_m:
                break
            done_m = min(length_m, done_m + max(nearest.distance_m - margin_m, step_m))
    return None


def outline_radius_m(outline_robot_m: ArrayLike) -> float:
    """The furthest corner from the robot's origin."""
    return max(math.hypot(x_m, y_m) for x_m, y_m in np.asarray(outline_robot_m).tolist())


def motion_bound_m(start: Pose, end: Pose, radius_m: float) -> float:
    """No point within `radius_m` of the robot's origin is further from where it was than this, at any time of the motion."""
    return math.hypot(end[0] - start[0], end[1] - start[1]) + radius_m * abs(wrap_angle(end[2] - start[2]))


def between(start: Pose, end: Pose, share: float) -> Pose:
    """The pose at a share of the way: straight, turning evenly the short way."""
    turn_rad = wrap_angle(end[2] - start[2])
    return (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]), start[2] + share * turn_rad)
