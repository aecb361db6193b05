"""Follow: goes after the nearest moving thing at a distance."""

from __future__ import annotations

import math
from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS, MotionLeaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot, pose_of
from pluto_bt.blackboard.codes import CommandType
from pluto_bt.blackboard.messages import LaserPose, LaserScan, Pose
from pluto_bt.skills.follow import REACH_M, Aim, Search
from pluto_bt.skills.follow import Follow as Skill
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.pieces import pieces_of

WIDEST_M: Final = {"person": 0.8, "nearest": 1.2}  # what is wider is not looked at
POST_EVERY_S: Final = 0.3
REFRESH_S: Final = 1.0  # of standing
TOLERANCE_M: Final = 0.05
FACE_PER_S: Final = 1.2  # turn rate for each radian that the target is off
FACING_RAD: Final = math.radians(8.0)
ASIDE_RAD, WRIST_RAD = math.radians(60.0), math.radians(10.0)  # a target farther aside draws the laser, again when it has gone so far
TEXTS: Final = {Search.NOBODY: "nothing moves here", Search.LOST: "the target is out of sight for too long"}


class Follow(MotionLeaf):
    """Follows the nearest moving thing that the laser sees, at `distance_m`; SUCCESS after `duration_s` of following.

    Fails with `no-object` if nothing moves for 10 s, with `target-lost` if the target stays out of sight for 8 s.
    The wrist keeps the laser on a target that walks off to the side.
    """

    PATIENCE_S = {"bumper": 6.0}  # whom it met walks on
    DEVICES: ClassVar = ("laser",)
    INPUT_PORTS = {
        "target": Port(str, False, "whom: what is as narrow as a person, or anything", "person", choices=tuple(WIDEST_M)),
        "distance_m": Port(float, False, "distance kept, from the robot's middle to the target's near side", 1.5, unit="m", ge=0.5, le=8.0),
        "duration_s": Port(float, False, "how long to follow", math.inf, unit="s", ge=0.0),
        **MOTION_INPUTS,
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def begin(self, robot: Robot) -> Status | None:
        """Look first; nothing moves before somebody does."""
        if lack := self.lacks(robot.platform.devices):
            return self.fail("no-device", lack)
        self._skill = Skill(float(self.get_input("distance_m")), self.max_speed_mps(robot), self.now_s())
        self._scan_s = self._next_post_s = self._next_stand_s = -math.inf
        self._found_s: float | None = None
        self._stand(robot)
        return None

    def initialise(self) -> None:
        """The laser looks ahead at first."""
        super().initialise()
        self._pan_rad = 0.0

    def resume(self, robot: Robot) -> None:
        """What happened during the pause is unknown: the target is looked for where it was."""
        self._skill.pause(self._gap_s)
        self._ticket, self._was_accepted, self._next_post_s = None, False, -math.inf
        self._next_stand_s = -math.inf
        self._posted_s = self._last_s

    def follow(self, robot: Robot) -> Status:
        """See, decide, drive."""
        status = self.chain_status(robot)
        trouble = self.chain_trouble(robot, status)
        if trouble is not None:
            return trouble
        dead = robot.newest("Localization/Dead-Reckoning")
        if self.is_blind or not isinstance(dead, Pose) or robot.is_stale("Localization/Dead-Reckoning"):
            self._skill.pause(self._gap_s)  # nobody has gone who cannot be seen
            return self._stand(robot, "waiting for the laser" if self.is_blind else "waiting for dead reckoning")
        at: Planar = (dead.pose[0], dead.pose[1], dead.pose[3])
        self._look(robot, at)
        now_s = self.now_s()
        state = self._skill.state(now_s)
        if state in TEXTS:
            return self.fail(state.value, TEXTS[state])
        if state is Search.LOOKING:
            return self._stand(robot, "looking for something that moves")
        self._found_s = self.elapsed_s if self._found_s is None else self._found_s
        if self.elapsed_s - self._found_s >= float(self.get_input("duration_s")):
            return self.succeed("followed")
        aim = self._skill.aim(at, now_s)
        self._point(robot, aim.turn_rad)
        if now_s >= self._next_post_s - 1e-6:
            self._next_post_s = now_s + POST_EVERY_S
            self._drive(robot, aim, at)
        return self.wait(f"target {aim.distance_m:.2f} m away{'' if state is Search.SEEN else ', out of sight'}")

    def terminate(self, new_status: Status) -> None:
        """Stand, and look ahead again."""
        super().terminate(new_status)
        robot = self.robot
        if robot is not None and self._pan_rad != 0.0:
            self._turn_wrist(robot, 0.0)

    def _stand(self, robot: Robot, text: str = "") -> Status:
        """Told again and again, so that the chain tells what becomes of the sensors meanwhile."""
        now_s = self.now_s()
        if now_s >= self._next_stand_s - 1e-6 or (self._ticket is not None and self._ticket.command.velocity != STILL):
            self._next_stand_s, self._next_post_s = now_s + REFRESH_S, now_s
            self.post(robot, CommandType.VELOCITY)
        return self.wait(text)

    def _point(self, robot: Robot, bearing_rad: float) -> None:
        """Turn the laser after a target that comes near the edge of its field, no farther than needed: on the other side somebody may come, and the
        stop filter lets the robot creep at most where nobody looks. Look ahead again when it is ahead."""
        wanted_rad = math.copysign(abs(bearing_rad) - 0.5 * ASIDE_RAD, bearing_rad) if abs(bearing_rad) > ASIDE_RAD else 0.0
        if abs(wanted_rad - self._pan_rad) > WRIST_RAD and (wanted_rad != 0.0 or abs(bearing_rad) < 0.5 * ASIDE_RAD):
            self._turn_wrist(robot, wanted_rad)

    def _turn_wrist(self, robot: Robot, pan_rad: float) -> None:
        wrist = robot.platform.devices.wrist
        if wrist is not None:
            limit_rad, self._pan_rad = math.radians(wrist.pan_limit_deg), pan_rad
            rate, acceleration = math.radians(wrist.max_rate_dps), math.radians(wrist.max_acceleration_dps2)
            robot.point_wrist(max(-limit_rad, min(limit_rad, pan_rad)), 0.0, rate, acceleration)

    def _look(self, robot: Robot, at: Planar) -> None:
        """Take the newest scan, once, as soon as it is known where it was taken from."""
        scan, mount = robot.newest("sick/scan"), robot.newest("Localization/Laser_Dead-Reckoning")
        if not isinstance(scan, LaserScan) or not isinstance(mount, LaserPose):
            return
        if scan.stamp_s <= self._scan_s or abs(mount.stamp_s - scan.stamp_s) > 1e-6 or abs(mount.pose[7]) > math.radians(2.0):
            return  # a laser that looks down sees the ground
        self._scan_s = scan.stamp_s
        laser: Planar = (mount.pose[0], mount.pose[1], mount.pose[3])
        widest_m = WIDEST_M[self.get_input("target")]
        self._skill.see(pieces_of(scan.ranges_m, scan.angle_min_rad, scan.angle_step_rad, laser, REACH_M, widest_m), at, scan.stamp_s)

    def _drive(self, robot: Robot, aim: Aim, at: Planar) -> None:
        """A goto to the place before the target; near enough, turn to it."""
        pose = pose_of(robot)
        if aim.speed_mps <= 0.0 or pose is None:
            rate = FACE_PER_S * aim.turn_rad if abs(aim.turn_rad) > FACING_RAD else 0.0
            limit = math.radians(robot.platform.limits.max_turn_rate_dps)
            self.post(robot, CommandType.VELOCITY, velocity=(0.0, max(-limit, min(limit, rate))))
            return
        turn = pose[2] - at[2]  # from the frame of dead reckoning to that of the map
        c, s = math.cos(turn), math.sin(turn)
        dx, dy = aim.goal[0] - at[0], aim.goal[1] - at[1]
        goal = (pose[0] + c * dx - s * dy, pose[1] + s * dx + c * dy)
        velocity = (aim.speed_mps, math.radians(robot.platform.limits.max_turn_rate_dps))
        self.post(robot, CommandType.GOTO, goal, velocity, TOLERANCE_M)
