"""Poses and points of the plane. Pure functions on plain numbers; only `transform_points` works on arrays.

A pose is (x m, y m, theta rad). `pose_map_robot` is the robot seen from the map; neighbouring frames cancel:
`pose_map_laser = compose(pose_map_robot, pose_robot_laser)`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Pose = tuple[float, float, float]  # x m, y m, theta rad


def wrap_angle(angle_rad: float) -> float:
    """The same angle within [-pi, pi]. Exact: an angle already inside is returned as it is."""
    return math.remainder(angle_rad, math.tau)


def compose(pose_ab: Pose, pose_bc: Pose) -> Pose:
    """Pose of c seen from a; theta within [-pi, pi]."""
    x_m, y_m, theta_rad = pose_ab
    cos, sin = math.cos(theta_rad), math.sin(theta_rad)
    return (x_m + cos * pose_bc[0] - sin * pose_bc[1], y_m + sin * pose_bc[0] + cos * pose_bc[1], wrap_angle(theta_rad + pose_bc[2]))


def transform_points(pose_ab: Pose, points_b_m: ArrayLike) -> NDArray[np.float64]:
    """(n, 2) points given in frame b, seen from a: a new (n, 2) array. No points give no points."""
    points = np.asarray(points_b_m, dtype=np.float64).reshape(-1, 2)
    cos, sin = math.cos(pose_ab[2]), math.sin(pose_ab[2])
    moved = np.zeros_like(points)  # written out, not as a matrix product: BLAS does not promise the same bits everywhere
    moved[:, 0] = pose_ab[0] + cos * points[:, 0] - sin * points[:, 1]
    moved[:, 1] = pose_ab[1] + sin * points[:, 0] + cos * points[:, 1]
    return moved
