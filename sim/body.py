"""The robot's body: its true pose and velocities, and what its wheels do. Joins platform figures and kernels."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.platform import Platform
from sim import motion
from sim.motors import Motors
from sim.noise import Noise
from sim.simtime import TICK_S, SimTime
from sim.steering import SteeringServo

Pose = tuple[float, float, float]


class Body:
    """The truth of the robot, in the map frame. `advance` moves it; `hold` takes back a move that would have hit something.

    Attributes:
        x_m, y_m, theta_rad: pose of the point under the crossing of the wheel diagonals; theta is not wrapped.
        speed_mps, turn_rate_radps: of the body. wheel_speed_mps, wheel_turn_rate_radps: of the wheels, also when the body is held.
        wheel_distance_m, wheel_heading_rad: what the wheels have run; path_m: length of the true path;
            driven_m: the same, backwards counted negative.
    """

    def __init__(self, platform: Platform, start: Pose, seed: int, ideal: bool, time: SimTime) -> None:
        body, limits = platform.body, platform.limits
        self.motors = Motors(limits, time)
        self.servo = SteeringServo(body, platform.devices.steering, Noise(seed, "steering"), ideal) if body.kinematics == "ackermann" else None
        self._plant = np.zeros(motion.PLANT_SIZE)
        self._plant[motion.TICK] = TICK_S
        self._plant[motion.ACCELERATION] = limits.acceleration_mps2
        self._plant[motion.DECELERATION] = limits.deceleration_mps2
        self._plant[motion.TURN_ACCELERATION] = math.radians(limits.turn_acceleration_dps2)
        lag_s = limits.motor_time_constant_s
        self._plant[motion.LAG_SHARE] = 1.0 - math.exp(-TICK_S / lag_s) if lag_s > 0.0 else 1.0
        if self.servo:
            self._plant[motion.STEERING_RATE] = self.servo.rate_percent_per_s
            self._plant[motion.CURVATURE_PER_PERCENT] = self.servo.curvature_per_percent
        self._advance_wheels, self._advance_car = motion.advance_wheels.compiled(), motion.advance_car.compiled()
        self._state = np.zeros(motion.STATE_SIZE)
        self._state[:3] = start
        self._read()

    def _read(self) -> None:
        """Take the state vector over into plain floats, which everybody else reads."""
        s = self._state.tolist()
        self.x_m, self.y_m, self.theta_rad = s[motion.X], s[motion.Y], s[motion.THETA]
        self.speed_mps, self.turn_rate_radps = s[motion.BODY_SPEED], s[motion.BODY_TURN_RATE]
        self.wheel_speed_mps, self.wheel_turn_rate_radps = s[motion.WHEEL_SPEED], s[motion.WHEEL_TURN_RATE]
        self._setpoint_mps, self._setpoint_radps = s[motion.SPEED_SETPOINT], s[motion.TURN_SETPOINT]
        self.wheel_distance_m, self.wheel_heading_rad = s[motion.WHEEL_DISTANCE], s[motion.WHEEL_HEADING]
        self.path_m, self.driven_m = s[motion.PATH_LENGTH], s[motion.BODY_DISTANCE]

    @property
    def pose(self) -> Pose:
        """x, y, theta as the state has it."""
        return (self.x_m, self.y_m, self.theta_rad)

    def apply_commands(self, now_ns: int) -> None:
        """Bring the commands that are due into force."""
        if self.motors.advance(now_ns) and self.servo:
            self.servo.command(*self.motors.command)

    def advance(self, n_ticks: int, slip: float, blocked: bool) -> None:
        """Move on by `n_ticks` under the command in force, losing the share `slip` of the wheels' motion; `blocked` wheels stand still."""
        if blocked:
            self._stand_still()
        elif self.servo:
            self._advance_car(self._state, self._plant, self.motors.command[0], self.servo.percent, self.servo.error, 1.0 - slip, n_ticks)
        else:
            self._advance_wheels(self._state, self._plant, *self.motors.command, 1.0 - slip, n_ticks)
        self._read()

    def _stand_still(self) -> None:
        """Wheels and body at once without motion; the steering stays."""
        for entry in (motion.SPEED_SETPOINT, motion.TURN_SETPOINT, motion.WHEEL_SPEED, motion.WHEEL_TURN_RATE):
            self._state[entry] = 0.0
        for entry in (motion.BODY_SPEED, motion.BODY_TURN_RATE, motion.ARC_SPEED, motion.ARC_TURN_RATE):
            self._state[entry] = 0.0

    def carry(self, to: Pose) -> None:
        """Somebody lifts the robot and sets it down; its wheels go on as they did, and count nothing of it."""
        self._state[:3] = to
        self._read()

    def reach_m(self, n_ticks: int, radius_m: float) -> float:
        """An upper bound of how far any point of the outline can move in the next `n_ticks`."""
        command_v, command_w = self.motors.command
        speed = max(abs(self._setpoint_mps), abs(command_v), abs(self.wheel_speed_mps))
        turn_rate = max(abs(self._setpoint_radps), abs(command_w), abs(self.wheel_turn_rate_radps))
        if self.servo:
            turn_rate = speed * 100.0 * self.servo.curvature_per_percent
        return n_ticks * TICK_S * (speed + turn_rate * radius_m)

    def last_arc(self) -> tuple[float, float]:
        """(speed m/s, turn rate rad/s) of the arc that the body was sent along in the last tick."""
        return float(self._state[motion.ARC_SPEED]), float(self._state[motion.ARC_TURN_RATE])

    def hold(self, before: Pose, share: float) -> None:
        """Undo the part of the last tick beyond `share` of it: the body has met something and stands.

        The strong wheels of a skid-steer or differential base go on turning; the small motor of a car stalls, and its wheels with it
        (that is how the car's notes find an obstacle: told to drive, and the speed is 0).
        """
        speed, turn_rate = self.last_arc()
        self._state[:3] = motion.along_arc(before, speed, turn_rate, share * TICK_S)
        self._state[motion.PATH_LENGTH] -= abs(speed) * TICK_S * (1.0 - share)
        self._state[motion.BODY_DISTANCE] -= speed * TICK_S * (1.0 - share)
        self._state[motion.BODY_SPEED] = self._state[motion.BODY_TURN_RATE] = 0.0
        if self.servo:
            self._state[motion.SPEED_SETPOINT] = self._state[motion.WHEEL_SPEED] = 0.0
        self._read()
