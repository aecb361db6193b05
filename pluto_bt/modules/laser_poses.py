"""Where the laser is: its mount on the platform, turned by the wrist, carried by the robot."""

from __future__ import annotations

from typing import NamedTuple

from estimation.covariance import Covariance, as_nine, moved
from estimation.se2 import Pose2, between
from estimation.se3 import Pose6, compose
from estimation.track import Moment, Tilt
from pluto_bt.blackboard.messages import LaserPose
from pluto_bt.modules.context import Context
from pluto_bt.modules.wrist_angles import wrist_at


class Arm(NamedTuple):
    """The laser seen from the robot, and the wrist angles that put it there. Pan turns about z at the mount, tilt then about y."""

    pose_robot_laser: Pose6
    pan_rad: float
    tilt_rad: float


class LaserPlace:
    """Knows the laser's mount and the history of the wrist, in space. (`mount.LaserMount` is its plain sister, as avoidance and filter need it.)"""

    def __init__(self, context: Context) -> None:
        laser = context.platform.devices.laser
        self._xyz = (0.0, 0.0, 0.0) if laser is None else (laser.x_m, laser.y_m, laser.z_m)
        self._has_wrist = context.platform.devices.wrist is not None
        self._board = context.board

    def arm(self, stamp_s: float) -> Arm | None:
        """The laser at `stamp_s`; None if nobody knows where the wrist held it."""
        angles = wrist_at(self._board, stamp_s) if self._has_wrist else (0.0, 0.0)
        return None if angles is None else Arm((*self._xyz, angles[0], angles[1], 0.0), *angles)

    def planar(self, robot: Moment) -> Pose2 | None:
        """The laser seen from the robot, both looked at from above."""
        arm = self.arm(robot.stamp_s)
        if arm is None:
            return None
        x, y, _, theta, _, _ = compose(in_space(robot.pose_odom, robot.tilt), arm.pose_robot_laser)
        return between(robot.pose_odom, (x, y, theta))


def in_space(pose: Pose2, tilt: Tilt) -> Pose6:
    """A pose in the plane with the robot's phi and psi."""
    return (pose[0], pose[1], 0.0, pose[2], tilt[0], tilt[1])


def laser_pose(stamp_s: float, robot: Pose2, tilt: Tilt, arm: Arm, covariance: Covariance, setter: int) -> LaserPose:
    """The message: pose of the laser, pan and tilt appended. `covariance` is the robot's; it is carried out to the laser."""
    laser = compose(in_space(robot, tilt), arm.pose_robot_laser)
    P = moved(covariance, laser[0] - robot[0], laser[1] - robot[1])
    return LaserPose(stamp_s, (*laser, arm.pan_rad, arm.tilt_rad), as_nine(P), int(setter))
