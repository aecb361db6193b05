"""Rotations in space as theta about z, then phi about y, then psi about x (DESIGN.md, section 3), for the laser on its wrist."""

from __future__ import annotations

import math

Matrix3 = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
Pose6 = tuple[float, float, float, float, float, float]


def rotation(theta_rad: float, phi_rad: float, psi_rad: float) -> Matrix3:
    """Rz(theta) Ry(phi) Rx(psi): columns are the axes of the turned frame."""
    ct, st = math.cos(theta_rad), math.sin(theta_rad)
    cp, sp = math.cos(phi_rad), math.sin(phi_rad)
    cs, ss = math.cos(psi_rad), math.sin(psi_rad)
    return (
        (ct * cp, ct * sp * ss - st * cs, ct * sp * cs + st * ss),
        (st * cp, st * sp * ss + ct * cs, st * sp * cs - ct * ss),
        (-sp, cp * ss, cp * cs),
    )


def angles(R: Matrix3) -> tuple[float, float, float]:
    """(theta, phi, psi) of a rotation; phi within ±90°. At phi = ±90° psi is taken as 0."""
    phi = math.asin(max(-1.0, min(1.0, -R[2][0])))
    if abs(R[2][0]) > 1.0 - 1e-12:
        return math.atan2(-R[0][1], R[1][1]), phi, 0.0
    return math.atan2(R[1][0], R[0][0]), phi, math.atan2(R[2][1], R[2][2])


def times(A: Matrix3, B: Matrix3) -> Matrix3:
    """The product A B."""
    (a, b, c), (d, e, f), (g, h, i) = B
    x, y, z = ((p * a + q * d + r * g, p * b + q * e + r * h, p * c + q * f + r * i) for p, q, r in A)
    return (x, y, z)


def compose(pose_a_b: Pose6, pose_b_c: Pose6) -> Pose6:
    """Frame c seen from frame a; a pose is (x, y, z, theta, phi, psi)."""
    R = rotation(*pose_a_b[3:])
    p = pose_b_c[:3]
    x, y, z = (pose_a_b[i] + R[i][0] * p[0] + R[i][1] * p[1] + R[i][2] * p[2] for i in range(3))
    return (x, y, z, *angles(times(R, rotation(*pose_b_c[3:]))))
