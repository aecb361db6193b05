"""Slow and plain twins of the ray and gap kernels: every beam against everything, in three dimensions, with no short cut."""

from __future__ import annotations

import math

import numpy as np

FLOOR_M = -1.0


def beam(pose, tilt_rad, angle_rad):
    """Unit vector of a beam in the map frame."""
    level = np.array([math.cos(angle_rad), math.sin(angle_rad), 0.0])
    tilted = np.array([level[0] * math.cos(tilt_rad), level[1], -level[0] * math.sin(tilt_rad)])
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.array([c * tilted[0] - s * tilted[1], s * tilted[0] + c * tilted[1], tilted[2]])


def inside(points, x, y):
    """Winding number is not zero."""
    angle = 0.0
    for (x1, y1), (x2, y2) in zip(points, np.roll(points, -1, axis=0), strict=True):
        a, b = complex(x1 - x, y1 - y), complex(x2 - x, y2 - y)
        turn = b * a.conjugate()
        angle += math.atan2(turn.imag, turn.real)
    return abs(angle) > math.pi


def crossings(start, direction, points, closed):
    """Ranges at which a beam passes the upright planes of an outline."""
    ends = np.roll(points, -1, axis=0) if closed else points[1:]
    for p, q in zip(points, ends, strict=False):
        matrix = np.array([[direction[0], p[0] - q[0]], [direction[1], p[1] - q[1]]])
        if abs(np.linalg.det(matrix)) > 1e-14:
            r, share = np.linalg.solve(matrix, p - start[:2])
            if r >= 0.0 and 0.0 <= share <= 1.0:
                yield r


def solid_ranges(start, direction, points, radius_m, kind):
    """Ranges of sides; and a function that tells whether a point of the plane is over the solid."""
    if kind == "circle":
        centre = points[0]
        a = direction[0] ** 2 + direction[1] ** 2
        b = direction[:2] @ (start[:2] - centre)
        c = (start[:2] - centre) @ (start[:2] - centre) - radius_m**2
        root = b * b - a * c
        sides = [(-b - math.sqrt(root)) / a, (-b + math.sqrt(root)) / a] if root >= 0.0 and a > 0.0 else []
        return [r for r in sides if r >= 0.0], lambda x, y: math.hypot(x - centre[0], y - centre[1]) <= radius_m
    if kind == "wall":
        return list(crossings(start, direction, points, False)), lambda x, y: False
    return list(crossings(start, direction, points, True)), lambda x, y: inside(points, x, y)


def slow_range(solids, holes, pose, z_m, tilt_rad, angle_rad, max_range_m):
    """Range of one beam. `solids`: (kind, points, radius, height); `holes`: points."""
    start, direction = np.array([pose[0], pose[1], z_m]), beam(pose, tilt_rad, angle_rad)
    found = [max_range_m]
    for kind, points, radius_m, height_m in solids:
        sides, over = solid_ranges(start, direction, points, radius_m, kind)
        if z_m <= height_m and over(pose[0], pose[1]):
            return 0.0
        found += [r for r in sides if 0.0 <= z_m + r * direction[2] <= height_m]
        if direction[2] < 0.0 and z_m > height_m:
            r = (height_m - z_m) / direction[2]
            found += [r] if over(*(start + r * direction)[:2]) else []
    if direction[2] < 0.0:
        found.append(ground_range(holes, start, direction))
    return min(found)


def ground_range(holes, start, direction):
    """Range to the ground, or to the side or floor of a hole in it."""
    ground = -start[2] / direction[2]
    if not any(inside(points, *(start + ground * direction)[:2]) for points in holes):
        return ground
    ends = [(FLOOR_M - start[2]) / direction[2]]
    for points in holes:
        for r in crossings(start, direction, points, True):
            behind = start + (r + 1e-7) * direction
            if ground < r < ends[0] and not any(inside(other, behind[0], behind[1]) for other in holes):
                ends.append(r)
    return min(ends)


def slow_walk(occupied, x, y, dx, dy, reach):
    """Range in cells by the plain walk from cell to cell in closed form: line k is crossed at (k - x) * (1 / dx), horizontal lines first."""
    rows, columns = occupied.shape
    ix, iy = math.floor(x), math.floor(y)
    per_x, per_y = (1.0 / dx if dx else 1e300), (1.0 / dy if dy else 1e300)
    t = 0.0
    for _ in range(10 * (rows + columns + abs(ix) + abs(iy))):
        if t >= reach:
            return reach
        if 0 <= ix < columns and 0 <= iy < rows and occupied[iy, ix]:
            return t
        tx = ((ix + 1 if per_x > 0 else ix) - x) * per_x
        ty = ((iy + 1 if per_y > 0 else iy) - y) * per_y
        if tx < ty:
            t, ix = tx, ix + (1 if per_x > 0 else -1)
        else:
            t, iy = ty, iy + (1 if per_y > 0 else -1)
    return reach
