"""Adapter `marker`: camera markers through the gate, accepted ones to localisation (seed 002)."""

from __future__ import annotations

import math
from collections import deque
from typing import Annotated

import msgspec
from msgspec import Meta

from drivers.records import MarkerRecord
from estimation.marker_gate import BAD_HEADING, TOO_FAST, MarkerGate
from estimation.marker_trust import Contradiction, MarkerTrust
from pluto_bt.blackboard.codes import Setter
from pluto_bt.blackboard.messages import MarkerState, Pose
from pluto_bt.blackboard.poses import pose_at
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.modules.context import Context

JUDGED = 3  # accepted markers whose headings are judged together
TOO_OLD = "too-old"  # nobody remembers where the robot pointed then
REPEATED = "repeated"  # the same numbers again
MOVED_M = 0.05


class MarkerParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table `[marker]` of the platform file: the gate's figures from the car's notes, and what an accepted marker is trusted with."""

    min_quality: Annotated[float, Meta(ge=0, description="below: refused, low-quality")] = 0.25
    max_heading_error_deg: Annotated[float, Meta(gt=0, le=180, description="from the gyro's heading; above: refused, bad-heading")] = 45.0
    max_speed_mps: Annotated[float, Meta(gt=0, description="from the last accepted marker; at or above: refused, too-fast")] = 1.0
    heading_pull: Annotated[float, Meta(ge=0, le=1, description="share of the heading's error that one accepted marker takes away")] = 0.05
    position_noise_m: Annotated[float, Meta(gt=0, description="standard deviation of a marker's position")] = 0.03
    heading_noise_deg: Annotated[float, Meta(gt=0, description="standard deviation of a marker's heading")] = 2.0
    most_heading_bias_deg: Annotated[float, Meta(gt=0, description="median of the last three; more: the gyro is wrong")] = 8.0
    far_m: Annotated[float, Meta(gt=0, description="from the estimate; an accepted marker farther off must be confirmed by the next")] = 0.5
    silent_after_s: Annotated[float, Meta(gt=0, description="when none has passed for so long it is told: marker-stale")] = 10.0


class Marker:
    """`car/marker` with the gate's verdict for each reading. An accepted one is posted as a robot pose at its stamp: the position
    is the camera's, the heading is the estimate, pulled a little towards the camera's, else the gyro's drift would end long runs.

    The gate lets nonsense pass when there is nothing to compare it with: the first marker, or one after a long shadow. So an accepted
    marker far from the estimate moves the pose only if the one before told the same. And it refuses for ever whoever was carried and turned:
    where three in a row see the car turned by the same angle, they are right. One that never agreed before and stands alone may hang wrong;
    it moves nothing. While those who can be right contradict the estimate the car should stand: `is_elsewhere`.
    """

    def __init__(self, context: Context) -> None:
        self._device = context.devices["marker"]
        self._board = context.board
        self._state = context.board.publisher("car/marker", "marker")
        self._box = context.posts
        self._start_rad = context.start_pose[2]
        p = context.parameters(MarkerParameters)
        self._parameters = p
        self._last: tuple[tuple[float, ...], tuple[float, ...]] | None = None  # numbers of the last new reading, and dead reckoning then
        self._say = context.say
        self._off_rad: deque[float] = deque(maxlen=JUDGED)  # heading of the last accepted markers less the estimate's
        self._trust = MarkerTrust(math.radians(p.most_heading_bias_deg))
        self.gate = MarkerGate(p.min_quality, math.radians(p.max_heading_error_deg), p.max_speed_mps)

    def start(self, now_s: float) -> None:
        """Nothing to get ready."""

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """Judge each reading that has arrived."""
        for record in self._device.read():
            if isinstance(record, MarkerRecord):
                self._judge(record, now_s)

    def _judge(self, r: MarkerRecord, now_s: float) -> None:
        newest = self._newest()
        pose = pose_at(self._board, "Localization/Pose", r.stamp_s)
        is_past = pose is None and newest is not None and r.stamp_s < newest.stamp_s
        pose = pose or newest
        heading_rad = self._start_rad if pose is None else pose.pose[3]
        seen = (r.x_m, r.y_m, r.theta_rad)
        refused = TOO_OLD if is_past else self._repeated(r) or self.gate.judge(r.stamp_s, seen, r.quality, heading_rad)
        if self._trusts(r, refused, pose, heading_rad):
            if refused == BAD_HEADING:
                heading_rad = r.theta_rad
                self.gate.forget()
                refused = self.gate.judge(r.stamp_s, seen, r.quality, heading_rad)
            self._trust.agree(r.marker)
            self._post(r, heading_rad, 0.0 if pose is None else pose.covariance[8])
        passed = self.gate.accepted_count
        self._state.put(MarkerState(r.stamp_s, r.marker, *seen, r.quality, refused, passed, self._trust.is_elsewhere), now_s)

    def _repeated(self, r: MarkerRecord) -> str:
        """A camera that sees the same to the last digit though the car has moved on looks at nothing."""
        sample = self._board.newest("Localization/Dead-Reckoning")
        here = sample.value.pose[:2] if sample is not None and isinstance(sample.value, Pose) else (0.0, 0.0)
        numbers, last = (r.x_m, r.y_m, r.theta_rad, r.quality), self._last
        if last is not None and last[0] == numbers:
            return REPEATED if math.dist(last[1], here) > MOVED_M else ""
        self._last = (numbers, here)
        return ""

    def _trusts(self, r: MarkerRecord, refused: str, pose: Pose | None, heading_rad: float) -> bool:
        """True if the reading is to move the pose: it is near the estimate, or one of several that tell the same and can be right."""
        off = self._off(r, pose, heading_rad)
        if off is None or refused not in ("", BAD_HEADING, TOO_FAST):
            return False
        if pose is None or (not refused and not self._is_far(off, pose)):
            return not refused
        self._trust.contradict(off)
        if not refused:
            return self._trust.alike > 1 and (self._trust.is_confirmed or self._trust.is_fresh)
        is_turned = refused == BAD_HEADING and self._trust.alike >= JUDGED and self._trust.is_confirmed
        if is_turned:
            off_deg = math.degrees(off.theta_rad)
            text = f"the markers see the car {off_deg:+.0f} deg from where it was thought to point: somebody has turned it, and they are believed"
            self._say("warning", "pose-jump", "marker", text)
        return is_turned

    def _off(self, r: MarkerRecord, pose: Pose | None, heading_rad: float) -> Contradiction | None:
        """The reading less the estimate; None if it makes no sense."""
        x_m, y_m = (r.x_m, r.y_m) if pose is None else pose.pose[:2]
        off = Contradiction(r.stamp_s, r.marker, r.x_m - x_m, r.y_m - y_m, wrap_angle(r.theta_rad - heading_rad))
        return off if math.isfinite(off.x_m + off.y_m + off.theta_rad) else None

    def _is_far(self, off: Contradiction, pose: Pose) -> bool:
        """True if the estimate, with what it may be off by itself, does not explain the reading."""
        sigma_m = math.sqrt(max(0.0, pose.covariance[0] + pose.covariance[4]))
        return math.hypot(off.x_m, off.y_m) > max(self._parameters.far_m, 3.0 * sigma_m)

    def _bias_rad(self, off_rad: float) -> float:
        """What most of the last `JUDGED` markers agree upon against the gyro, rad; 0 while it is small, or they are too few."""
        self._off_rad.append(off_rad)
        bias_rad = sorted(self._off_rad)[JUDGED // 2] if len(self._off_rad) == JUDGED else 0.0  # the median: one nonsense marker says nothing
        if abs(bias_rad) < math.radians(self._parameters.most_heading_bias_deg):
            return 0.0
        self._off_rad.clear()
        text = f"the last {JUDGED} markers see the car {math.degrees(bias_rad):+.0f} deg from where the gyro says it points: the heading is put right"
        self._say("warning", "gyro-drift", "marker", text)
        return bias_rad

    def _newest(self) -> Pose | None:
        """The estimate now; None before the first."""
        sample = self._board.newest("Localization/Pose")
        return sample.value if sample is not None and isinstance(sample.value, Pose) else None

    def _post(self, r: MarkerRecord, heading_rad: float, heading_var_rad2: float) -> None:
        p = self._parameters
        theta_rad = heading_rad + p.heading_pull * wrap_angle(r.theta_rad - heading_rad) + self._bias_rad(wrap_angle(r.theta_rad - heading_rad))
        xy, tt = p.position_noise_m**2, (1 - p.heading_pull) ** 2 * heading_var_rad2 + (p.heading_pull * math.radians(p.heading_noise_deg)) ** 2
        covariance = (xy, 0.0, 0.0, 0.0, xy, 0.0, 0.0, 0.0, tt)
        self._box.post("marker", Pose(r.stamp_s, (r.x_m, r.y_m, 0.0, theta_rad, 0.0, 0.0), covariance, Setter.JUST_SET))
