"""Interpolation of stamped poses in time: positions linearly, angles along the shorter arc."""

from __future__ import annotations

import math

from pluto_bt.blackboard.messages import ActuatorState, Message, Pair, Pose
from pluto_bt.blackboard.store import Blackboard, Snapshot


def blend_angle(a_rad: float, b_rad: float, share: float) -> float:
    """The angle at `share` (0 … 1) of the shorter arc from a to b, not wrapped."""
    return a_rad + share * math.remainder(b_rad - a_rad, math.tau)


def share_between(before: Message, after: Message, stamp_s: float) -> float:
    """Where `stamp_s` lies between two stamps: 0 at the first, 1 at the second."""
    span_s = after.stamp_s - before.stamp_s
    return 0.0 if span_s <= 0.0 else (stamp_s - before.stamp_s) / span_s


def pose_at(board: Blackboard | Snapshot, name: str, stamp_s: float) -> Pose | None:
    """The pose of a pose topic at `stamp_s`, interpolated; None if its history does not reach there."""
    pair = board.around(name, stamp_s)
    if pair is None:
        return None
    before, after = pair[0].value, pair[1].value
    if not isinstance(before, Pose) or not isinstance(after, Pose):
        raise TypeError(f"{name} does not carry poses")
    share = share_between(before, after, stamp_s)
    a, b = before.pose, after.pose
    x, y, z = a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])
    theta, phi, psi = blend_angle(a[3], b[3], share), blend_angle(a[4], b[4], share), blend_angle(a[5], b[5], share)
    return Pose(stamp_s, (x, y, z, theta, phi, psi), after.covariance, after.setter)


def actuator_at(board: Blackboard | Snapshot, name: str, stamp_s: float) -> Pair | None:
    """The two angles (rad) of an actuator topic such as the wrist's state at `stamp_s`, interpolated; None if its history does not reach there."""
    pair = board.around(name, stamp_s)
    if pair is None:
        return None
    before, after = pair[0].value, pair[1].value
    if not isinstance(before, ActuatorState) or not isinstance(after, ActuatorState):
        raise TypeError(f"{name} does not carry the state of an actuator")
    share = share_between(before, after, stamp_s)
    first_rad, second_rad = (blend_angle(before.position[i], after.position[i], share) for i in (0, 1))
    return first_rad, second_rad
