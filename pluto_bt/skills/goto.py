"""Goto (T = 2): a straight way to a point with simple avoidance (Pluto manual, 6.2). Decides speed and heading, and whether it is there or stuck."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from pluto_bt.blackboard.codes import Avoidance, GotoStatus, split_flags
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.backing import BEHIND_RAD, Backing, Behind
from pluto_bt.skills.limits import Limits
from pluto_bt.skills.outline import Array, Outline, Planar
from pluto_bt.skills.steering import ROOM_M, Steer, Steering

PROGRESS_M = 0.1  # coming nearer by less is no progress
PROGRESS_RAD = 0.1  # nor is turning to the way by less
ARRIVAL_MPS = 0.08  # slowest approach
COMFORT_SHARE = 0.5  # of the deceleration is used when nothing presses
MOVED_M, MOVED_RAD = 0.01, 0.02  # less is standing still, whatever the wheels are told
WEDGED_M = 0.05  # with less free way on the best heading the robot cannot go on
DEAD_END_M = 1.0  # who cannot turn to where he wants to go, and that is behind him, does not drive into this first
BACK_MPS = 0.3  # where something watches
BACK_S = 8.0  # whose way back leads nowhere for so long gives it up
HELD_S, CREPT_M, CREPT_RAD = 3.0, 0.1, 0.2  # whom a link below lets come no farther in so long backs too
SAME_S, SAME_M = 0.5, 1.0  # a goal so soon after the last step and so near to the last goal follows on it


class Way(NamedTuple):
    """What goto wants: a speed, a turn relative to the present heading, and how it stands."""

    speed_mps: float
    turn_rad: float
    status: GotoStatus
    text: str = ""


class Goto:
    """One goto from command to end. `REACHED` and `STUCK` stay until the next command."""

    def __init__(self, outline: Outline, limits: Limits, parameters: AvoidParameters) -> None:
        self._outline, self._most, self.parameters = outline, limits, parameters
        self._steer, self._backing = Steer(outline), Backing(outline)
        self.status = GotoStatus.NONE
        self._goal, self._last_s = (0.0, 0.0), -math.inf

    def tune(self, limits: Limits, parameters: AvoidParameters) -> None:
        """Speed and tolerance count from the next goal on, the rest at once."""
        self._most, self.parameters = limits, parameters

    def begin(self, command: ActuatorState, now_s: float, behind: Behind = Behind.SEEN) -> None:
        """A new goal: position = x, y in Localization/Pose; velocity = most speed and turn rate; force[0]; acceleration[0] = tolerance_m if > 0.

        A goal beside the last one, while that is still driven to, is the same order with other figures: somebody is followed. Then what stood in
        the way stays known. `behind`: what the robot knows of what lies there.
        """
        follows_on = self.status is GotoStatus.RUNNING and now_s - self._last_s < SAME_S and math.dist(command.position, self._goal) < SAME_M
        speed_mps, turn_radps = command.velocity
        most, p = self._most, self.parameters
        speed_mps = min(speed_mps if speed_mps > 0.0 else p.goto_speed_mps, most.speed_mps)
        turn_radps = min(turn_radps if turn_radps > 0.0 else math.inf, most.turn_rate_radps)
        self.limits = replace(most, speed_mps=speed_mps, turn_rate_radps=turn_radps)
        self._goal = command.position
        self._back_mps = min(speed_mps, BACK_MPS if behind is Behind.HEARD else p.blind_speed_mps)
        self._is_blind, self._hears_behind = behind is Behind.UNKNOWN, behind is Behind.HEARD
        self._force = command.force[0] if command.force and command.force[0] > 0.0 else 1.0
        kind = split_flags(command.flags)
        self._sees = kind is not None and kind[0] is not Avoidance.NONE
        self._tolerance_m = command.acceleration[0] if command.acceleration[0] > 0.0 else p.goto_tolerance_m
        self.status = GotoStatus.RUNNING
        self._best_m = self._best_rad = math.inf
        self._progress_s = self._last_s = now_s
        if follows_on:
            return
        self._moved_s = self._came_s = self._braked_s = self._back_s = now_s
        self._backing.forget()
        self._began: Planar | None = None  # where the odometry was then …
        self._has_come_m = 0.0  # … and how far from there it has been
        self._stood: Planar | None = None  # where the odometry was when it last told of a motion …
        self._crept: Planar | None = None  # … and of one that is worth the name
        self._steer.forget()

    def pause(self, now_s: float, dt_s: float) -> None:
        """Time in which the robot had to stand for a reason outside of goto (laser rebooting) does not count as being stuck."""
        self._progress_s = min(now_s, self._progress_s + dt_s)
        self._moved_s, self._came_s = min(now_s, self._moved_s + dt_s), min(now_s, self._came_s + dt_s)
        self._back_s = min(now_s, self._back_s + dt_s)

    def step(self, now_s: float, pose: Planar, odometry: Planar, points: Array) -> Way:
        """The next decision.

        Args:
            pose: of the robot in the frame of the goal.
            odometry: of the robot in a frame that never jumps.
            points: (n, 5) obstacles in the robot frame: x, y, margin, velocity.
        """
        self._last_s = now_s
        dx, dy = self._goal[0] - pose[0], self._goal[1] - pose[1]
        distance_m, goal_rad = math.hypot(dx, dy), wrap_angle(math.atan2(dy, dx) - pose[2])
        self._note(now_s, distance_m, odometry)
        if self._is_there(distance_m, goal_rad, now_s):
            self.status = GotoStatus.REACHED
            return Way(0.0, 0.0, self.status, f"goal reached within {distance_m:.2f} m")
        if (why := self._stuck_text(now_s, distance_m)) != "":
            self.status = GotoStatus.STUCK
            return Way(0.0, 0.0, self.status, why)
        self._backing.note(odometry)
        turnable_rad = self._backing.turnable_rad(points)
        to_go_m = distance_m - 0.5 * self._tolerance_m
        steering = self._steer.choose(points, goal_rad, to_go_m, self._force, turnable_rad, odometry[2])
        aim_rad = self._backing.aim(steering.wish_rad, odometry[2])
        can_turn = -turnable_rad[0] <= aim_rad <= turnable_rad[1] or max(turnable_rad) >= math.pi  # the long way round will do
        is_behind = abs(aim_rad) > BEHIND_RAD and (abs(goal_rad) > BEHIND_RAD or self._backing.is_leaving)
        if not self._backing.is_on and self._is_wedged(steering, is_behind and not can_turn, now_s):
            self._backing.begin(odometry, aim_rad, self._is_blind)
            self._came_s = self._back_s = now_s
        if self._backing.is_on and self._goes_on_backing(can_turn, now_s, odometry):
            return self._back(points, odometry, turnable_rad)
        if abs(steering.heading_rad) < self._best_rad - PROGRESS_RAD:  # a turn may take long among people
            self._best_rad, self._progress_s = abs(steering.heading_rad), now_s
        return Way(self._speed_mps(steering, distance_m), steering.heading_rad, self.status)

    def note_share(self, now_s: float, share: float) -> None:
        """How much of the last decision was let through: what is held although all of it was, is held by a link below, for what goto does not see."""
        if share < 1.0:
            self._braked_s = now_s

    def give_up_backing(self) -> None:
        """The way back is blocked too."""
        self._backing.end()

    def _note(self, now_s: float, distance_m: float, odometry: Planar) -> None:
        if distance_m < self._best_m - PROGRESS_M:
            self._best_m, self._best_rad, self._progress_s = distance_m, math.inf, now_s
        self._began = self._began or odometry
        self._has_come_m = max(self._has_come_m, math.dist(odometry[:2], self._began[:2]))
        stood = self._stood
        if stood is None or math.dist(stood[:2], odometry[:2]) > MOVED_M or abs(wrap_angle(odometry[2] - stood[2])) > MOVED_RAD:
            self._stood, self._moved_s = odometry, now_s
        crept = self._crept
        if crept is None or math.dist(crept[:2], odometry[:2]) > CREPT_M or abs(wrap_angle(odometry[2] - crept[2])) > CREPT_RAD:
            self._crept, self._came_s = odometry, now_s

    def _is_there(self, distance_m: float, goal_rad: float, now_s: float) -> bool:
        """Inside half the tolerance; or inside the tolerance and not coming nearer any more."""
        if distance_m > self._tolerance_m:
            return False
        return distance_m <= 0.5 * self._tolerance_m or abs(goal_rad) > math.radians(80.0) or now_s - self._moved_s > 1.0

    def _stuck_text(self, now_s: float, distance_m: float) -> str:
        p = self.parameters
        if now_s - self._moved_s > p.blocked_after_s:
            return f"could not move for {p.blocked_after_s:g} s, {distance_m:.2f} m to go"
        if now_s - self._progress_s > p.stuck_after_s:
            return f"came no nearer for {p.stuck_after_s:g} s, {distance_m:.2f} m to go"
        return ""

    def _speed_mps(self, steering: Steering, distance_m: float) -> float:
        """Slower before obstacles, in narrow places, and towards the goal."""
        brake_mps2 = COMFORT_SHARE * self.limits.deceleration_mps2
        room = 0.35 + 0.65 * min(1.0, max(0.0, steering.room_m) / ROOM_M)
        before_m, to_goal_m = max(0.0, steering.free_m), max(0.0, distance_m - 0.3 * self._tolerance_m)
        speed_mps = min(self.limits.speed_mps * room, math.sqrt(2.0 * brake_mps2 * before_m))
        return min(speed_mps, max(ARRIVAL_MPS, math.sqrt(2.0 * brake_mps2 * to_goal_m)))

    def _is_wedged(self, steering: Steering, cannot_turn_back: bool, now_s: float) -> bool:
        """Whether to back: neither driving nor turning helps, or the way is behind the robot, which cannot turn, and before it the way ends soon.
        With A = 0 it goes straight or not at all."""
        if not self._sees or self.limits.min_turn_radius_m > 0.0 or self.parameters.back_off_m <= 0.0:
            return False
        if self._is_blind and self._backing.known_m < self.parameters.back_off_m:
            return False
        knows_behind = self._hears_behind or self._has_come_m >= self.parameters.back_off_m  # it came from there
        if now_s - max(self._came_s, self._braked_s) > HELD_S and knows_behind:
            return True
        if cannot_turn_back and (self._backing.is_leaving or steering.free_m < DEAD_END_M):
            return True
        sees_why = steering.free_m <= WEDGED_M and abs(steering.heading_rad) <= math.radians(10.0)
        return sees_why and now_s - self._moved_s >= 1.0

    def _goes_on_backing(self, can_turn: bool, now_s: float, odometry: Planar) -> bool:
        if now_s - self._came_s > HELD_S:
            self._backing.end()
            return False
        if self._backing.makes_way(odometry):
            self._back_s = now_s
            if self._backing.is_leaving:
                self._progress_s = now_s
        elif now_s - self._back_s > BACK_S:
            self._backing.end()
            self._began, self._has_come_m, self._hears_behind = odometry, 0.0, False  # it is held that way too
            return False
        return self._backing.goes_on(odometry, self.parameters.back_off_m, can_turn)

    def _back(self, points: Array, odometry: Planar, turnable_rad: tuple[float, float]) -> Way:
        """Straight back between what stands beside the robot, slower before what stands behind."""
        turn_rad, free_m = self._backing.way_back(points, odometry, turnable_rad)
        most_mps = self._back_mps if self._backing.is_leaving else min(self._back_mps, self.parameters.blind_speed_mps)
        return Way(-min(most_mps, math.sqrt(2.0 * COMFORT_SHARE * self.limits.deceleration_mps2 * free_m)), turn_rad, self.status)
