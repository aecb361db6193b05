"""Wall follow (T = 3): along a wall such that a camera, held out to the back and the side, keeps its distance (Pluto manual, 6.2).

The camera's distance is held by the robot's: beside a straight wall the camera hangs `camera_side_m` nearer to it than the robot's middle.
At corners the camera swings by a little more or less, as it must behind a robot that cannot move sideways.
"""

from __future__ import annotations

import math
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

import numpy as np

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.heading import GAIN_PER_S, SLOW_ANGLE_RAD
from pluto_bt.skills.limits import Limits, clamp
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.steering import CLEAR_M
from pluto_bt.skills.turn_search import LEFT_RAD
from pluto_bt.skills.wall_kernels import bend_speed, seen_from, standing, way_lengths
from pluto_bt.skills.wall_parameters import WallParameters
from pluto_bt.skills.wall_path import Ball, WallPath, Wish, find_wall, foot_of, plan

DISTANCE, SIDE = 1, 2  # our own in `force` of T = 3, where it has so many numbers: metres (0 = the parameter), and below 0 = wall on the right
SWING_M = 0.4  # what is so narrow that the camera, which swings as the robot turns in its middle, comes so much too near, is not entered
NEAR_M = 0.5  # so near to its path the robot is at the wall
THERE_M, PASSED_M = 0.09, 0.3  # so near to where it turns it is there; and if that lies beside or behind it
PURSUIT_S, SHORTEST_M, LONGEST_M = 1.0, 0.3, 0.9  # how far ahead on the path it steers to
TURN_SHARE = 0.7  # of the turn rate is planned with; the rest is for what goes wrong
COMFORT_SHARE = 0.4  # of the deceleration, before bends
CREEP_MPS = 0.08
BEND_M = 0.24  # a bend is measured over so much of the path
PROGRESS_M = 0.5
ALONE_M, ALONE_WITHIN_M = 0.08, 2.5  # a point without another in the squares around it; farther away beams lie wide apart
LOST_S = 3.0  # a wall that is not seen for so long is lost
AT_WALL, TO_WALL = "at the wall", "on the way to the wall"
TURNED_RAD = math.radians(15.0)  # in a pocket it turns on the spot, until its way out lies ahead
MOST_TURN_RAD, AHEAD_RAD = math.radians(60.0), math.radians(30.0)


class WallStatus(Enum):
    """How it stands. The words of those that end it are reasons."""

    FOLLOWING = ""
    NO_WALL = "no-wall"  # waits, and looks
    LOST = "wall-lost"
    STUCK = "stuck"


class Along(NamedTuple):
    """What wall follow wants: a speed, a turn relative to the present heading, and how it stands."""

    speed_mps: float
    turn_rad: float
    status: WallStatus
    text: str


class WallFollow:
    """One wall follow from command to end. `LOST` and `STUCK` stay until the next command."""

    def __init__(self, outline: Outline, limits: Limits, parameters: WallParameters, avoid: AvoidParameters) -> None:
        self._outline = outline
        self.tune(limits, parameters, avoid)

    def tune(self, limits: Limits, parameters: WallParameters, avoid: AvoidParameters) -> None:
        """For the next wall; when the robot is lost or stuck, at once."""
        self._most, self.parameters, self._avoid = limits, parameters, avoid
        self._least_m = self._outline.side_m + avoid.margin_m + CLEAR_M

    def begin(self, command: ActuatorState) -> None:
        """A new wall: velocity = most speed and turn rate; `force[DISTANCE]`, `force[SIDE]` where they are given."""
        speed_mps, turn_radps = command.velocity
        speed_mps = min(speed_mps if speed_mps > 0.0 else self._avoid.goto_speed_mps, self._most.speed_mps)
        turn_radps = min(turn_radps if turn_radps > 0.0 else math.inf, self._most.turn_rate_radps)
        self.limits = replace(self._most, speed_mps=speed_mps, turn_rate_radps=turn_radps)
        p, given = self.parameters, command.force if len(command.force) > SIDE else (0.0, 0.0, 0.0)
        self._side = -1.0 if given[SIDE] < 0.0 else 1.0
        self.distance_m = given[DISTANCE] if given[DISTANCE] > 0.0 else p.distance_m
        middle_m = max(self.distance_m + p.camera_side_m, self._least_m)
        camera_m = (-p.camera_back_m, middle_m - self.distance_m, self.distance_m)
        turn_m = self._outline.reach_m + self._avoid.margin_m + CLEAR_M if self._most.min_turn_radius_m <= 0.0 else math.inf
        opening_m, swing_m = max(p.opening_m, middle_m + self._least_m), math.hypot(*camera_m[:2])
        self._wish = Wish(middle_m, camera_m, p.fillet_m, opening_m, self._least_m, turn_m)
        self._opening_m = max(opening_m, 2.0 * (swing_m + self.distance_m - SWING_M))
        self.reach_m = max(p.look_m, middle_m + p.fillet_m + p.lost_m)
        self._at: Planar = (0.0, 0.0, 0.0)
        self._path: WallPath | None = None
        self._scan_s = self._seen_s = -math.inf
        self._is_there = False
        self._end: Along | None = None
        self._progress: tuple[float, Planar] | None = None

    def pause(self, dt_s: float) -> None:
        """Time in which the robot had to stand for a reason outside of wall follow does not count as being stuck."""
        self._seen_s += dt_s
        if self._progress is not None:
            self._progress = (self._progress[0] + dt_s, self._progress[1])

    def step(self, now_s: float, odometry: Planar, points: Array, scan_s: float) -> Along:
        """The next decision.

        Args:
            odometry: of the robot in a frame that never jumps.
            points: (n, 5) obstacles in the robot frame: x, y, margin, velocity.
            scan_s: stamp of the newest scan; with a new one the path is worked out anew.
        """
        if self._end is not None:
            return self._end
        mirrored = (odometry[0], self._side * odometry[1], self._side * odometry[2])
        if self._path is None or scan_s != self._scan_s:
            self._scan_s = scan_s
            self._look(self._standing(points), mirrored, now_s)
        if self._path is None:
            self._progress = None
            return Along(0.0, 0.0, WallStatus.NO_WALL, f"no wall within {self.reach_m:.1f} m that there is room beside")
        if now_s - self._seen_s > LOST_S:
            self._end = Along(0.0, 0.0, WallStatus.LOST, "the wall that was followed is not there any more")
            return self._end
        return self._judged(self._drive(self._path, mirrored), now_s, odometry)

    # ---------------------------------------------------------------- looking

    @property
    def wish(self) -> Wish:
        """What the path should be; on the way to the wall, where little is seen around the robot, the ball stays smaller."""
        return self._wish._replace(opening_m=self._opening_m) if self._is_there else self._wish

    def _standing(self, points: Array) -> Array:
        """(n, 2) mirrored, of what does not move. Without ghosts of beams that were dazzled: what would stand within the robot, or all alone."""
        return standing(points, self._outline.planes, self._side, ALONE_M, ALONE_WITHIN_M)

    def _look(self, stands: Array, robot: Planar, now_s: float) -> None:
        """Work out the path anew, from where the ball was last or else from the nearest wall. Where neither leads along the wall that is
        followed, the last path holds: a thin wall is hard to see edge-on."""
        path = None if self._path is None else self._planned(self._path, stands, robot)
        if path is None or (self._is_there and path.off_m > NEAR_M):
            ball = find_wall(stands, self.wish)
            other = None if ball is None else plan(stands, ball, self.wish)
            path = path if other is None or (path is not None and path.off_m < other.off_m) else other
        if self._is_there and (path is None or path.off_m > self.parameters.lost_m):
            return
        self._path, self._at, self._seen_s = path, robot, now_s

    def _planned(self, last: WallPath, stands: Array, robot: Planar) -> WallPath | None:
        """The path that follows on the last one."""
        pocket = None if last.pocket is None else last.pocket.seen_from(self._at, robot)
        return plan(stands, _ball_from(last.ball, self._at, robot), self.wish, pocket)

    # ---------------------------------------------------------------- driving

    def _drive(self, plan: WallPath, robot: Planar) -> Along:
        """Steer to a point ahead on the path, so slow that the bends up to there can be driven; in a pocket first to where it turns."""
        path, turn = seen_from(plan.points, self._at, robot), plan.turn
        if turn and _is_at(*path[turn, :2].tolist()):
            self._path, path, turn = plan.turned(), path[turn:], 0
        foot = foot_of(path[: turn + 1] if turn else path)
        off_m = math.hypot(*path[foot, :2])
        self._is_there = self._is_there or off_m < NEAR_M
        way_m = way_lengths(path, foot)
        speed_mps = self._speed_mps(path, foot, way_m)
        ahead_m = max(SHORTEST_M, min(LONGEST_M, PURSUIT_S * speed_mps)) + 0.5 * off_m
        aim = foot + int(np.searchsorted(way_m, ahead_m))
        x, y = path[min(aim, turn or len(path) - 1), :2].tolist()
        bearing_rad, away_m = math.atan2(y, x), math.hypot(x, y)
        if plan.pocket is not None and plan.pocket.is_turned and abs(bearing_rad) > TURNED_RAD:
            return self._turning(bearing_rad)
        turn_radps = speed_mps * 2.0 * math.sin(bearing_rad) / max(away_m, 0.1)
        size_rad = max(abs(turn_radps) / GAIN_PER_S, abs(bearing_rad) - AHEAD_RAD)  # what lies far aside is first turned to
        turn_rad = clamp(math.copysign(size_rad, bearing_rad), MOST_TURN_RAD)
        share = max(0.3, 1.0 - abs(turn_rad) / SLOW_ANGLE_RAD)
        text = AT_WALL if self._is_there else TO_WALL
        return Along(min(self.limits.speed_mps, speed_mps / share), self._side * turn_rad, WallStatus.FOLLOWING, text)

    def _turning(self, bearing_rad: float) -> Along:
        """On the spot, away from the wall."""
        turn_rad = bearing_rad if bearing_rad < LEFT_RAD else -MOST_TURN_RAD
        return Along(0.0, self._side * clamp(turn_rad, MOST_TURN_RAD), WallStatus.FOLLOWING, AT_WALL)

    def _speed_mps(self, path: Array, foot: int, way_m: Array) -> float:
        """As fast as the bends ahead allow, with time to brake before them."""
        if len(way_m) < 3:
            return CREEP_MPS
        brake_mps2 = COMFORT_SHARE * self.limits.deceleration_mps2
        allowed_mps = bend_speed(path, foot, way_m, BEND_M, TURN_SHARE * self.limits.turn_rate_radps, brake_mps2)
        to_end_mps = math.sqrt(2.0 * brake_mps2 * float(way_m[-1]))
        return max(CREEP_MPS, min(self.limits.speed_mps, allowed_mps, to_end_mps))

    def _judged(self, along: Along, now_s: float, odometry: Planar) -> Along:
        """Stuck without progress."""
        last = self._progress
        if last is None or math.dist(last[1][:2], odometry[:2]) > PROGRESS_M:
            self._progress = (now_s, odometry)
        elif now_s - last[0] > self.parameters.stuck_after_s:
            self._end = Along(0.0, 0.0, WallStatus.STUCK, f"came no farther along the wall for {self.parameters.stuck_after_s:g} s")
            return self._end
        return along


def _is_at(x_m: float, y_m: float) -> bool:
    """True if a robot that drives ahead is at a place, or will come no nearer."""
    return math.hypot(x_m, y_m) < (THERE_M if x_m > abs(y_m) else PASSED_M)


def _ball_from(ball: Ball, before: Planar, now: Planar) -> Ball:
    places = seen_from(np.array([[ball.x_m, ball.y_m, 0.0], [ball.touched_x_m, ball.touched_y_m, 0.0]]), before, now)
    (x, y), (touched_x, touched_y) = places[:, :2].tolist()
    return Ball(x, y, touched_x, touched_y, ball.radius_m)
