"""The robot's dead-reckoned track: every step of the last seconds, so that poses at past stamps can be asked for.

Two poses run side by side: `pose_odom` (interface 0: since the start, never jumps) and `pose_map` (interface 3: adjusted by posts).
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise

from estimation.covariance import ZERO, Covariance, blended, stepped
from estimation.history import enclosing
from estimation.se2 import IDENTITY, Pose2, blend, compose, inverse

Tilt = tuple[float, float]
LEVEL: Tilt = (0.0, 0.0)


class Moment:
    """The state after one step, and the noise of that step. Covariances are those of the pose of the same frame.

    `tilt` is (phi, psi) in rad, as an inertial sensor gave it.
    """

    __slots__ = ("covariance_map", "covariance_odom", "distance_var_m2", "pose_map", "pose_odom", "stamp_s", "tilt", "turn_var_rad2")

    def __init__(
        self,
        stamp_s: float,
        pose_odom: Pose2,
        pose_map: Pose2,
        covariance_odom: Covariance = ZERO,
        covariance_map: Covariance = ZERO,
        tilt: Tilt = LEVEL,
    ) -> None:
        self.stamp_s, self.tilt = stamp_s, tilt
        self.pose_odom, self.pose_map = pose_odom, pose_map
        self.covariance_odom, self.covariance_map = covariance_odom, covariance_map
        self.distance_var_m2 = self.turn_var_rad2 = 0.0


class Track:
    """Dead reckoning with a memory. Steps go in by `advance`, better knowledge of the pose by `adjust`."""

    def __init__(self, start: Pose2, stamp_s: float = 0.0, moments: int = 256) -> None:
        self.adjustment: Pose2 = IDENTITY  # pose_map_odom
        self.now = Moment(stamp_s, start, start)
        self._moments: deque[Moment] = deque([self.now], maxlen=moments)

    def advance(self, stamp_s: float, step: Pose2, distance_var_m2: float, turn_var_rad2: float, tilt: Tilt = LEVEL) -> Moment:
        """Take one step: `step` is the motion seen from the last pose. Raises ValueError if time does not move on."""
        last = self.now
        if stamp_s <= last.stamp_s:
            raise ValueError(f"step at {stamp_s} s, but the track is at {last.stamp_s} s")
        pose_odom = compose(last.pose_odom, step)
        pose_map = pose_odom if self.adjustment is IDENTITY else compose(self.adjustment, pose_odom)
        now = Moment(stamp_s, pose_odom, pose_map, last.covariance_odom, last.covariance_map, tilt)
        now.distance_var_m2, now.turn_var_rad2 = distance_var_m2, turn_var_rad2
        if distance_var_m2 or turn_var_rad2 or step != IDENTITY:
            P = now.covariance_odom = _carried(last.covariance_odom, last.pose_odom, pose_odom, distance_var_m2, turn_var_rad2)
            is_one = pose_map is pose_odom and last.covariance_map is last.covariance_odom  # nobody has adjusted anything yet
            now.covariance_map = P if is_one else _carried(last.covariance_map, last.pose_map, pose_map, distance_var_m2, turn_var_rad2)
        self._moments.append(now)
        self.now = now
        return now

    def at(self, stamp_s: float) -> Moment | None:
        """The state at a past stamp, between two steps along the arc that joins them; None outside the memory."""
        found = enclosing(self._moments, stamp_s)
        if found is None:
            return None
        before, after, share = found
        if before is after:
            return after
        pose_odom = blend(before.pose_odom, after.pose_odom, share)
        adjustment = compose(after.pose_map, inverse(after.pose_odom))  # not `self.adjustment`: `after` may be older than the last post
        return Moment(
            stamp_s,
            pose_odom,
            compose(adjustment, pose_odom),
            blended(before.covariance_odom, after.covariance_odom, share),
            blended(before.covariance_map, after.covariance_map, share),
            (before.tilt[0] + share * (after.tilt[0] - before.tilt[0]), before.tilt[1] + share * (after.tilt[1] - before.tilt[1])),
        )

    def adjust(self, stamp_s: float, pose_map_robot: Pose2, covariance: Covariance) -> bool:
        """The robot was at `pose_map_robot` at `stamp_s`: shift the map poses since then. False if the stamp is not remembered.

        adjustment = post(t) ∘ DR(t)⁻¹; `pose_odom` is not touched.
        """
        then = self.at(stamp_s)
        if then is None:
            return False
        self.adjustment = compose(pose_map_robot, inverse(then.pose_odom))
        pose, P = pose_map_robot, covariance
        for moment in self._since(stamp_s):
            if moment.stamp_s < stamp_s:
                continue
            if moment.stamp_s > stamp_s:
                moved = compose(self.adjustment, moment.pose_odom)
                P, pose = _carried(P, pose, moved, moment.distance_var_m2, moment.turn_var_rad2), moved
            moment.pose_map, moment.covariance_map = pose, P
        return True

    def increment_covariance(self, since_s: float, until_s: float) -> Covariance:
        """Covariance of the motion between two stamps, in the odom frame; from the oldest remembered step if `since_s` is older."""
        P, last = ZERO, self.at(since_s) or self._moments[0]
        for before, moment in pairwise(self._since(since_s)):
            if moment.stamp_s <= last.stamp_s:
                continue
            end = moment if moment.stamp_s <= until_s else self.at(until_s)
            if end is None or end.stamp_s <= last.stamp_s:
                break
            share = (end.stamp_s - last.stamp_s) / (moment.stamp_s - before.stamp_s)
            P = _carried(P, last.pose_odom, end.pose_odom, share * moment.distance_var_m2, share * moment.turn_var_rad2)
            last = end
        return P

    def _since(self, stamp_s: float) -> list[Moment]:
        """The last moment before a stamp, as far as it is remembered, and all at and after it, oldest first."""
        found = []
        for moment in reversed(self._moments):
            found.append(moment)
            if moment.stamp_s < stamp_s:
                break
        return found[::-1]


def _carried(P: Covariance, before: Pose2, after: Pose2, distance_var_m2: float, turn_var_rad2: float) -> Covariance:
    """The covariance carried over one step, whose noise acts along its mean heading."""
    return stepped(P, after[0] - before[0], after[1] - before[1], 0.5 * (before[2] + after[2]), distance_var_m2, turn_var_rad2)
