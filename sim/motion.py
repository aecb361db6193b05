"""How wheels and body move in steps of one tick: the hot kernels, on a plain state vector.

Wheels: the setpoint follows the command within the acceleration limits, the wheels follow the setpoint with a first-order lag.
Body: an exact arc with the mean of the velocities before and after the tick, shortened by slip. Turning and driving slip alike.
A command's turn rate is meant for the body: the base's own controller knows the effective track and drives the wheels
`effective_track_m / track_m` times as fast against each other as rigid geometry would ask, so on firm ground turn rates are kept.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import kernel

Vector = NDArray[np.float64]

# The state vector. Pose and body velocities are the truth; wheel values are what the motors do, also when the body is held.
X, Y, THETA = 0, 1, 2
SPEED_SETPOINT, TURN_SETPOINT = 3, 4
WHEEL_SPEED, WHEEL_TURN_RATE = 5, 6
BODY_SPEED, BODY_TURN_RATE = 7, 8
WHEEL_DISTANCE, WHEEL_HEADING = 9, 10
PATH_LENGTH = 11
ARC_SPEED, ARC_TURN_RATE = 12, 13  # of the last tick: the body moved along this arc
STEERING, STEERING_SERVO = 14, 15  # percent, positive to the left: as commanded, and as the servo really stands
BODY_DISTANCE = 16  # signed way of the body
STATE_SIZE = 17

# The plant vector: what does not change in a run.
TICK, ACCELERATION, DECELERATION, TURN_ACCELERATION, LAG_SHARE, STEERING_RATE, CURVATURE_PER_PERCENT = range(7)
PLANT_SIZE = 7


@kernel
def ramp(value: float, target: float, up_step: float, down_step: float) -> float:
    """`value` moved towards `target`: by at most `up_step` away from zero, `down_step` towards zero; a change of sign pauses at zero."""
    if value * target < 0.0:
        target = 0.0
    limit = down_step if abs(target) < abs(value) else up_step
    if target > value:
        return min(target, value + limit)
    return max(target, value - limit)


@kernel
def move_body(state: Vector, speed_mps: float, turn_rate_radps: float, grip: float, dt_s: float) -> None:
    """Move the pose along the arc of the mean body velocities of this tick; `speed_mps` and `turn_rate_radps` are the wheels' now."""
    mean_speed = 0.5 * grip * (state[WHEEL_SPEED] + speed_mps)
    mean_turn_rate = 0.5 * grip * (state[WHEEL_TURN_RATE] + turn_rate_radps)
    state[WHEEL_DISTANCE] += 0.5 * (state[WHEEL_SPEED] + speed_mps) * dt_s
    state[WHEEL_SPEED] = speed_mps
    state[WHEEL_TURN_RATE] = turn_rate_radps
    half_turn = 0.5 * mean_turn_rate * dt_s
    chord = mean_speed * dt_s
    if abs(half_turn) > 1e-9:
        chord *= math.sin(half_turn) / half_turn
    heading = state[THETA] + half_turn
    state[X] += chord * math.cos(heading)
    state[Y] += chord * math.sin(heading)
    state[THETA] += 2.0 * half_turn
    state[BODY_SPEED] = grip * speed_mps
    state[BODY_TURN_RATE] = grip * turn_rate_radps
    state[ARC_SPEED] = mean_speed
    state[ARC_TURN_RATE] = mean_turn_rate
    state[PATH_LENGTH] += abs(mean_speed) * dt_s
    state[BODY_DISTANCE] += mean_speed * dt_s


@kernel
def advance_wheels(state: Vector, plant: Vector, speed_mps: float, turn_rate_radps: float, grip: float, n_ticks: int) -> None:
    """`n_ticks` of a skid-steer or differential base under one command; `grip` is 1 − slip."""
    dt_s = plant[TICK]
    turn_step = plant[TURN_ACCELERATION] * dt_s
    for _ in range(n_ticks):
        state[SPEED_SETPOINT] = ramp(state[SPEED_SETPOINT], speed_mps, plant[ACCELERATION] * dt_s, plant[DECELERATION] * dt_s)
        state[TURN_SETPOINT] = ramp(state[TURN_SETPOINT], turn_rate_radps, turn_step, turn_step)
        speed = state[WHEEL_SPEED] + plant[LAG_SHARE] * (state[SPEED_SETPOINT] - state[WHEEL_SPEED])
        turn_rate = state[WHEEL_TURN_RATE] + plant[LAG_SHARE] * (state[TURN_SETPOINT] - state[WHEEL_TURN_RATE])
        state[WHEEL_HEADING] += 0.5 * (state[WHEEL_TURN_RATE] + turn_rate) * dt_s
        move_body(state, speed, turn_rate, grip, dt_s)


@kernel
def advance_car(state: Vector, plant: Vector, speed_mps: float, steering_percent: float, error: float, grip: float, n_ticks: int) -> None:
    """`n_ticks` of a car under one command: the servo goes to `steering_percent * (1 + error)`, and saturates at ±100 %."""
    dt_s = plant[TICK]
    servo_step = plant[STEERING_RATE] * dt_s
    servo_target = min(max(steering_percent * (1.0 + error), -100.0), 100.0)
    for _ in range(n_ticks):
        state[SPEED_SETPOINT] = ramp(state[SPEED_SETPOINT], speed_mps, plant[ACCELERATION] * dt_s, plant[DECELERATION] * dt_s)
        state[STEERING] += min(max(steering_percent - state[STEERING], -servo_step), servo_step)
        state[STEERING_SERVO] += min(max(servo_target - state[STEERING_SERVO], -servo_step), servo_step)
        speed = state[WHEEL_SPEED] + plant[LAG_SHARE] * (state[SPEED_SETPOINT] - state[WHEEL_SPEED])
        mean_speed = 0.5 * (state[WHEEL_SPEED] + speed)
        state[WHEEL_HEADING] += mean_speed * plant[CURVATURE_PER_PERCENT] * state[STEERING] * dt_s
        move_body(state, speed, speed * plant[CURVATURE_PER_PERCENT] * state[STEERING_SERVO], grip, dt_s)


def along_arc(pose: tuple[float, float, float], speed_mps: float, turn_rate_radps: float, dt_s: float) -> tuple[float, float, float]:
    """The pose after `dt_s` on an exact arc; any frame, `dt_s` may be negative."""
    x, y, theta = pose
    half_turn = 0.5 * turn_rate_radps * dt_s
    chord = speed_mps * dt_s * (math.sin(half_turn) / half_turn if abs(half_turn) > 1e-9 else 1.0)
    return (x + chord * math.cos(theta + half_turn), y + chord * math.sin(theta + half_turn), theta + 2.0 * half_turn)
