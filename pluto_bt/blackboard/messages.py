"""What stands on the blackboard: frozen, stamped messages. Metres, radians, seconds of the run's clock; x forward, y left, z up.

Every message has `stamp_s`: the time its content was true, not the time it was written. Arrays are read-only float64.
"""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Pair = tuple[float, float]


class Message(msgspec.Struct, frozen=True, gc=False):
    """Root of all messages."""

    stamp_s: float


class ActuatorState(Message, frozen=True, gc=False):
    """Pluto's `ActuatorState`: a command to a link of the chain, or the state of a drive or of the wrist.

    position, velocity and acceleration are (linear, angular) for the chain (goto: x, y in `position`), (pan, tilt) for the wrist.
    `force[0]` weighs goal against avoidance in a goto.
    """

    flags: int = 0
    position: Pair = (0.0, 0.0)
    velocity: Pair = (0.0, 0.0)
    acceleration: Pair = (0.0, 0.0)
    force: tuple[float, ...] = (0.0,)


class FVectorState(Message, frozen=True, gc=False):
    """Pluto's `FVectorState`: the status of a link. `reason` and `text` say in words what the codes say in numbers."""

    data: tuple[float, ...] = (0.0, 0.0)
    element: tuple[int, ...] = (0,)
    reason: str = ""
    text: str = ""


class Pose(Message, frozen=True, gc=False):
    """A pose (x, y, z, theta, phi, psi) with covariance of (x, y, theta), row by row. Interfaces 0, 2 and 3."""

    pose: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    covariance: tuple[float, ...] = (0.0,) * 9
    setter: int = 0


class LaserPose(Message, frozen=True, gc=False):
    """The pose of the laser when a scan was taken, wrist pan and tilt appended: 8 numbers. Interfaces 1 and 4."""

    pose: tuple[float, float, float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    covariance: tuple[float, ...] = (0.0,) * 9
    setter: int = 0


class LaserScan(Message, frozen=True, gc=False):
    """One scan in the laser frame. `ranges_m` (n,): range_max_m and above = no return; −1 in every beam after a fatal error."""

    angle_min_rad: float
    angle_step_rad: float
    ranges_m: FloatArray
    count: int = 0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, LaserScan):
            return NotImplemented
        mine = (self.stamp_s, self.angle_min_rad, self.angle_step_rad, self.count)
        return mine == (other.stamp_s, other.angle_min_rad, other.angle_step_rad, other.count) and np.array_equal(self.ranges_m, other.ranges_m)

    __hash__ = None  # type: ignore[assignment]  # arrays do not hash


class ScanTiming(Message, frozen=True, gc=False):
    """The third sick interface: when the scan was taken and how many points it has."""

    count: int = 0


class SonarState(Message, frozen=True, gc=False):
    """One range a transducer, in the order of the platform file; the transducer's maximum = no echo."""

    ranges_m: tuple[float, ...] = ()


class BumperState(Message, frozen=True, gc=False):
    """True = pressed."""

    front: bool = False
    back: bool = False


class BatteryState(Message, frozen=True, gc=False):
    """Voltage of the main battery."""

    voltage_v: float = 0.0


class ImuState(Message, frozen=True, gc=False):
    """Orientation, rates and accelerations of an inertial sensor, z up. For `dmu/state` theta is integrated since the start."""

    theta_rad: float = 0.0
    phi_rad: float = 0.0
    psi_rad: float = 0.0
    turn_rates_radps: tuple[float, float, float] = (0.0, 0.0, 0.0)
    accelerations_mps2: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bias_radps: float = 0.0
    bias_known: bool = False


class AlarmState(Message, frozen=True, gc=False):
    """A robot in trouble: wheels turn and the body does not (stasis), wheels are commanded and stand still, it leans too far.

    The first two stay until they are read; `tilt_rad` is the angle from the vertical now, `stasis_count` how near the next stasis is.
    """

    stasis: bool = False
    wheels_stuck: bool = False
    tilted: bool = False
    tilt_rad: float = 0.0
    stasis_count: int = 0


class CompassState(Message, frozen=True, gc=False):
    """Magnetic heading in the map frame (counter-clockwise from x)."""

    heading_rad: float = 0.0


class GpsState(Message, frozen=True, gc=False):
    """Position in the map frame; quality 2 and more than 5 satellites for sub-metre accuracy, quality 0 = no fix."""

    x_m: float = 0.0
    y_m: float = 0.0
    satellites: int = 0
    quality: int = 0


class WeatherState(Message, frozen=True, gc=False):
    """Air around the robot; the wind's direction is where it comes from, in the map frame."""

    temperature_c: float = 0.0
    humidity_percent: float = 0.0
    wind_mps: float = 0.0
    wind_from_rad: float = 0.0


class GasState(Message, frozen=True, gc=False):
    """Concentrations, in parts per million, in the order of the sensor's channels."""

    concentrations_ppm: tuple[float, ...] = ()


class MarkerState(Message, frozen=True, gc=False):
    """A position from a camera marker, in the map frame, and what the gate said of it ("" = accepted).

    `is_elsewhere`: the last markers tell of another place than was reckoned, and can be right.
    """

    marker: int = 0
    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0
    quality: float = 0.0
    refused: str = ""
    accepted_count: int = 0
    is_elsewhere: bool = False


class SpeedState(Message, frozen=True, gc=False):
    """Wheel speed of the car, unsigned."""

    speed_mps: float = 0.0


class Event(Message, frozen=True, gc=False):
    """A line for operators. `level` is `info`, `warning` or `error`; `code` a documented word."""

    level: str = "info"
    code: str = ""
    source: str = ""
    text: str = ""


class MissionState(Message, frozen=True, gc=False):
    """State of the mission: idle, running, paused, stopping, succeeded, failed, aborted; `step` is the active leaf's path."""

    name: str = ""
    run: int = 0
    state: str = "idle"
    reason: str = ""
    step: str = ""
    ticks: int = 0


class JobState(Message, frozen=True, gc=False):
    """How a job of motion (42 to 45) stands: running, succeeded or failed; `moveto` and `motion` are `element[2..3]` of motion's status."""

    number: int = 0
    state: str = "running"
    moveto: int = 0
    motion: int = 1
    reason: str = ""
    text: str = ""


class PathState(Message, frozen=True, gc=False):
    """A path that is followed, in the map frame: x y x y …; one point = a goal without a planned way; empty = none."""

    points_m: tuple[float, ...] = ()


class RectangleState(Message, frozen=True, gc=False):
    """The rectangle that the jobs of motion never leave: it is 2 * base_m wide and begins at `home` (x m, y m, theta rad); base_m 0 = none."""

    base_m: float = 0.0
    height_m: float = 0.0
    home: tuple[float, float, float] = (0.0, 0.0, 0.0)


class LocalMapState(Message, frozen=True, gc=False):
    """The local map of a job, frame of dead reckoning: cell (i, j) of `cells` at i * columns + j begins at (x_m + i * cell_m, y_m + j * cell_m).

    A cell is 0 = not known, 1 = free, 2 = covered (explored), 3 = something stands there, 4 = low obstacle or hole.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    cell_m: float = 0.25
    rows: int = 0
    columns: int = 0
    cells: bytes = b""
    covered_m2: float = 0.0


class NodeState(msgspec.Struct, frozen=True, gc=False):
    """One node of the tree as others see it: `status` is IDLE, RUNNING, SUCCESS, FAILURE or SKIPPED (told in this very tick).

    `kind` is the type's name, such as Sequence or GoTo; `depth` counts from 1; `since_s` is mission time.
    """

    path: str
    kind: str
    name: str
    depth: int
    status: str
    feedback: str
    since_s: float


class TreeState(Message, frozen=True, gc=False):
    """The whole tree after a tick, depth first."""

    tick: int = 0
    nodes: tuple[NodeState, ...] = ()


class WorldState(Message, frozen=True, gc=False):
    """Simulation only: the truth, for summaries and tests, never for the robot."""

    pose_map_robot: tuple[float, float, float] = (0.0, 0.0, 0.0)
    velocity: Pair = (0.0, 0.0)
    clearance_m: float = 0.0
    collisions: int = 0
    hit_by: int = 0


class Flag(Message, frozen=True, gc=False):
    """A value that a world script sets; text as written in the script."""

    value: str = ""


class ModuleState(msgspec.Struct, frozen=True, gc=False):
    """One row of `modules`; `age_s` = since its last step when this was told."""

    name: str
    group: str
    state: str
    steps: int
    failures: int
    overruns: int
    worst_ms: float
    text: str = ""
    age_s: float = 0.0


class ModulesState(Message, frozen=True, gc=False):
    """All modules of the run, in start order."""

    modules: tuple[ModuleState, ...] = ()


def read_only(values: Any) -> FloatArray:
    """The values as a float64 array that nobody can change."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    array.setflags(write=False)
    return array
