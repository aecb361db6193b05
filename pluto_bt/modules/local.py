"""Adapter `local`: the five pose interfaces (manual, section 3; DESIGN.md, section 9, rows Post_Pose, setter, covariance).

0 Localization/Dead-Reckoning        the track since the start; never jumps
1 Localization/Laser_Dead-Reckoning  0 at the latest scan, carried to the laser
2 Localization/Post_Pose             improved poses in (through the post box)
3 Localization/Pose                  0 adjusted by 2
4 Localization/Laser_Pose            1 adjusted by 2
"""

from __future__ import annotations

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from estimation.covariance import Covariance, StepNoise, as_nine, from_nine, moved, stepped
from estimation.se2 import compose, inverse
from estimation.track import Track
from pluto_bt.blackboard.codes import Setter
from pluto_bt.blackboard.messages import Pose, ScanTiming
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.modules.context import Context
from pluto_bt.modules.laser_poses import LaserPlace, laser_pose
from pluto_bt.modules.marker_watch import MarkerWatch
from pluto_bt.modules.motion_check_shown import MotionCheckShown
from pluto_bt.modules.motion_sources import MotionSources
from pluto_bt.modules.post_box import refusal

JUMP_M, TURNED_RAD = 1.0, math.radians(5.0)  # a post that moves position or heading farther is told


class LocalParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table `[local]` of the platform file: how wrong a step of dead reckoning may be, and when a setter counts as gone."""

    yaw_enable: Annotated[bool, Meta(description="false: the heading is that of the wheels alone (the jBot article's switch)")] = True
    distance_noise_m_per_sqrt_m: Annotated[float, Meta(ge=0, description="standard deviation of the way after one metre")] = 0.03
    wheel_turn_noise_deg_per_sqrt_deg: Annotated[float, Meta(ge=0, description="of the wheels' heading after one degree of turn")] = 0.75
    wheel_turn_noise_deg_per_sqrt_m: Annotated[float, Meta(ge=0, description="of the wheels' heading after one metre")] = 1.7
    gyro_noise_deg_per_sqrt_s: Annotated[float, Meta(ge=0, description="of the gyro's heading after one second")] = 0.06
    setter_stale_after_s: Annotated[float, Meta(gt=0, description="a setter 1 … 3 that posts nothing for so long counts as gone: setter 0")] = 2.0

    def step_noise(self) -> StepNoise:
        """The same in radians."""
        return StepNoise(
            self.distance_noise_m_per_sqrt_m,
            self.wheel_turn_noise_deg_per_sqrt_deg * math.sqrt(math.radians(1.0)),
            math.radians(self.wheel_turn_noise_deg_per_sqrt_m),
            math.radians(self.gyro_noise_deg_per_sqrt_s),
        )


class Local:
    """Reckons the pose at the rate of the odometry, takes posts, and gives the laser's pose at every scan."""

    def __init__(self, context: Context) -> None:
        board = context.board
        p = context.parameters(LocalParameters)
        self._parameters = p
        self._say = context.say
        self._sources = MotionSources(context, p.step_noise(), p.yaw_enable)
        self._check = MotionCheckShown(context, self._sources.check)
        self._wheels_know_turns = context.platform.body.kinematics != "ackermann"
        self._markers = MarkerWatch(context)
        self._place = LaserPlace(context)
        self._box = context.posts
        self.track = Track(context.start_pose)
        self.dropped = 0  # posts and scans whose stamp is not in the history
        self._setter_s = 0.0
        self._timing = board.reader("sick/timing")
        self._timing_seq = 0
        self._scan_s: float | None = None  # stamp of the scan whose laser poses were published last
        self._dead_reckoning = board.publisher("Localization/Dead-Reckoning", "local")
        self._pose = board.publisher("Localization/Pose", "local")
        self._post_pose = board.publisher("Localization/Post_Pose", "local")
        self._laser_dead_reckoning = board.publisher("Localization/Laser_Dead-Reckoning", "local")
        self._laser_pose = board.publisher("Localization/Laser_Pose", "local")

    def start(self, now_s: float) -> None:
        """The estimate starts at the start pose; a restarted module goes on where it was."""
        self._publish_poses(now_s)

    def stop(self) -> None:
        """Nothing to let go of."""

    def step(self, now_s: float) -> None:
        """One step of the track if there is one, then posts, then poses out."""
        step = self._sources.step(now_s)
        if step is not None and step.stamp_s > self.track.now.stamp_s:
            self.track.advance(*step)
        posts = self._box.take()
        for source, pose in posts:
            self._accept(source, pose, now_s)
        self._forget_stale_setter(now_s)
        if step is not None or posts:
            self._publish_poses(now_s)
        self._serve_scan(now_s)
        self._check.tell(now_s, self._sources.silence if self._sources.silence[0] else self._markers.silence(now_s))

    def _publish_poses(self, now_s: float) -> None:
        now = self.track.now
        phi, psi = now.tilt
        x, y, theta = now.pose_odom
        pose, nine = (x, y, 0.0, wrap_angle(theta), phi, psi), as_nine(self._doubted(now.covariance_odom, theta))
        self._dead_reckoning.put(Pose(now.stamp_s, pose, nine), now_s)
        if now.pose_map is not now.pose_odom or now.covariance_map is not now.covariance_odom:  # else nobody has adjusted anything yet
            x, y, theta = now.pose_map
            pose, nine = (x, y, 0.0, wrap_angle(theta), phi, psi), as_nine(self._doubted(now.covariance_map, theta))
        self._pose.put(Pose(now.stamp_s, pose, nine, self._box.set_by), now_s)

    def _doubted(self, P: Covariance, theta_rad: float) -> Covariance:
        """With what slipping wheels leave open for the moment, and what is owed."""
        doubt_m = self._sources.check.way.doubt_m
        return P if doubt_m == 0.0 else stepped(P, 0.0, 0.0, theta_rad, doubt_m**2, 0.0)

    def _accept(self, source: str, post: Pose, now_s: float) -> None:
        """Adjust the track by a post. The setter is checked again here: it may have changed since the post was left."""
        refused = refusal(post.setter, self._box.set_by) or self._adjust(source, post, now_s)
        if refused:
            self._say("warning", refused, "local", f"pose posted by {source} at {post.stamp_s:.3f} s not taken: {refused}")
            return
        self._box.set_by, self._setter_s = post.setter, now_s
        if post.setter != Setter.NOBODY:
            self._check.found()
            self._markers.found(now_s)
        self._post_pose.put(post, now_s)

    def _adjust(self, source: str, post: Pose, now_s: float) -> str:
        if post.setter == Setter.NOBODY:  # the poster has ended: its last adjustment stays
            return ""
        if not all(map(math.isfinite, (*post.pose, *post.covariance))):
            return "bad-value"
        pose, P = (post.pose[0], post.pose[1], post.pose[3]), from_nine(post.covariance)
        then = self.track.at(post.stamp_s)
        if post.setter > 0:
            mount = None if then is None else self._place.planar(then)
            if mount is None:
                self.dropped += 1
                return "stamp-not-in-history"
            robot = compose(pose, inverse(mount))
            P, pose = moved(P, robot[0] - pose[0], robot[1] - pose[1]), robot
        jump_m = 0.0 if then is None else math.dist(pose[:2], then.pose_map[:2])
        turned_rad = 0.0 if then is None else wrap_angle(pose[2] - then.pose_map[2])
        if self.track.adjust(post.stamp_s, pose, P):
            if source == "marker" and not self._wheels_know_turns and abs(turned_rad) > TURNED_RAD:  # a person who says so blames no gyro
                self._sources.check.turn.put_right(now_s, turned_rad)
            if jump_m > JUMP_M:
                self._say("warning", "pose-jump", "local", f"a post moves the position by {jump_m:.1f} m; it is believed")
            return ""
        self.dropped += 1
        return "stamp-not-in-history"

    def _forget_stale_setter(self, now_s: float) -> None:
        if self._box.set_by > 0 and now_s - self._setter_s > self._parameters.setter_stale_after_s:
            self._say("warning", "setter-stale", "local", f"setter {self._box.set_by} has posted nothing for {now_s - self._setter_s:.1f} s: 0 now")
            self._box.set_by = Setter.NOBODY

    def _serve_scan(self, now_s: float) -> None:
        """Laser poses at the stamp of a new scan, as soon as the track reaches there."""
        sample = self._timing()
        if sample is None or sample.seq == self._timing_seq or not isinstance(sample.value, ScanTiming):
            return
        stamp_s = sample.value.stamp_s
        if stamp_s > self.track.now.stamp_s:
            return  # odometry of that moment is still on its way
        self._timing_seq = sample.seq
        then, arm = self.track.at(stamp_s), self._place.arm(stamp_s)
        if then is None or arm is None:
            self.dropped += 1
            return
        self._check.look(stamp_s, arm, then)
        increment = self.track.increment_covariance(-math.inf if self._scan_s is None else self._scan_s, stamp_s)
        self._scan_s = stamp_s
        self._laser_dead_reckoning.put(laser_pose(stamp_s, then.pose_odom, then.tilt, arm, increment, Setter.NOBODY), now_s)
        P = self._doubted(then.covariance_map, then.pose_map[2])
        self._laser_pose.put(laser_pose(stamp_s, then.pose_map, then.tilt, arm, P, self._box.set_by), now_s)
