"""What a platform file says of the robot's body and its devices: geometry, limits, noise. One file serves simulation and the real robot.

Each struct is one TOML table. The unit of a value is the ending of its name; angles that a person types end in `_deg`.
A device table that is absent means that the robot has no such device. Figures carry their source as a comment in the file.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

Positive = Annotated[float, Meta(gt=0)]
NotNegative = Annotated[float, Meta(ge=0)]
Point = tuple[float, float]


class Body(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The outline on the ground (robot frame, counter-clockwise, not crossing itself) and how the robot moves."""

    kinematics: Annotated[Literal["skid", "differential", "ackermann"], Meta(description="turns by skidding, by two wheels, or by steering")]
    outline_m: Annotated[tuple[Point, ...], Meta(min_length=3, description="corners of the outline, x forward, y left")]
    height_m: Annotated[Positive, Meta(description="obstacles hanging higher are passed under")] = 1.0
    track_m: Annotated[Positive, Meta(description="distance between left and right wheels")]
    wheel_base_m: Annotated[Positive, Meta(description="distance between the axles")] = 0.5
    effective_track_m: Annotated[NotNegative, Meta(description="track that turning behaves like when skidding; 0 = track_m")] = 0.0
    min_turn_radius_m: Annotated[NotNegative, Meta(description="ackermann: radius at min_turn_radius_percent steering")] = 0.0
    min_turn_radius_percent: Annotated[float, Meta(gt=0, le=100, description="ackermann: steering at which that radius is reached")] = 90.0


class Limits(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the motors can do; the commands are held within."""

    max_speed_mps: Annotated[Positive, Meta(description="highest forward speed, backwards the same")]
    max_turn_rate_dps: Annotated[Positive, Meta(description="highest turn rate")]
    acceleration_mps2: Annotated[Positive, Meta(description="when it gets faster")]
    deceleration_mps2: Annotated[Positive, Meta(description="when it gets slower")]
    turn_acceleration_dps2: Annotated[Positive, Meta(description="when the turn rate changes")]
    motor_latency_s: Annotated[NotNegative, Meta(description="from a command to the first change of speed")] = 0.05
    motor_time_constant_s: Annotated[NotNegative, Meta(description="lag of the wheels behind the command")] = 0.05


class Odometry(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Wheel encoders."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 50.0
    counts_per_m: Annotated[Positive, Meta(description="encoder counts of one metre")] = 100000.0
    distance_scale_noise: Annotated[NotNegative, Meta(description="standard deviation of the scale error, drawn once a run")] = 0.0
    turn_scale_noise: Annotated[NotNegative, Meta(description="standard deviation of the turn scale error, drawn once a run")] = 0.0
    distance_noise: Annotated[NotNegative, Meta(description="standard deviation per square root of a metre, in metres")] = 0.0
    turn_noise: Annotated[NotNegative, Meta(description="standard deviation per square root of a radian, in radians")] = 0.0


class Laser(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A SICK LMS on the wrist. (x, y, z) is the laser at pan 0, tilt 0 in the robot frame."""

    x_m: Annotated[float, Meta(description="place ahead of the reference point")]
    y_m: Annotated[float, Meta(description="place to the left")] = 0.0
    z_m: Annotated[Positive, Meta(description="height of the scan above the ground")] = 0.6
    beams: Annotated[int, Meta(ge=3, le=4096, description="rays of one scan, the first at the right")] = 361
    field_deg: Annotated[float, Meta(gt=0, le=360, description="field of view")] = 180.0
    rate_hz: Annotated[Positive, Meta(description="scans a second")] = 5.0
    max_range_m: Annotated[Positive, Meta(description="a beam that meets nothing reads this")] = 80.0
    resolution_m: Annotated[NotNegative, Meta(description="ranges are whole multiples of it; 0 = exact")] = 0.01
    noise_m: Annotated[NotNegative, Meta(description="standard deviation of a range")] = 0.0
    dropout_rate: Annotated[float, Meta(ge=0, le=1, description="share of beams that return nothing")] = 0.0
    dazzle_rate: Annotated[float, Meta(ge=0, le=1, description="share of beams that return a too short range")] = 0.0
    arrival_delay_s: Annotated[NotNegative, Meta(description="from mid-scan to the arrival of the whole scan")] = 0.19


class Transducer(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One sonar: where it sits and where it looks."""

    x_m: Annotated[float, Meta(description="place ahead of the reference point")]
    y_m: Annotated[float, Meta(description="place to the left")]
    theta_deg: Annotated[float, Meta(description="where it looks, 0 = ahead, 90 = left")]


class Sonar(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A ring of Polaroid-type transducers."""

    transducers: Annotated[tuple[Transducer, ...], Meta(min_length=1, max_length=64, description="one table each, in the order of the readings")]
    rate_hz: Annotated[Positive, Meta(description="sweeps of all transducers a second")] = 10.0
    z_m: Annotated[Positive, Meta(description="height above the ground")] = 0.39
    cone_deg: Annotated[float, Meta(gt=0, le=90, description="full opening angle")] = 25.0
    min_range_m: Annotated[NotNegative, Meta(description="no echo reads shorter")] = 0.15
    max_range_m: Annotated[Positive, Meta(description="no echo at all reads this")] = 8.0
    noise_m: Annotated[NotNegative, Meta(description="standard deviation of a range")] = 0.0
    dropout_rate: Annotated[float, Meta(ge=0, le=1, description="share of echoes that are lost")] = 0.0


class Bumpers(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Front and back panels."""

    depth_m: Annotated[Positive, Meta(description="how far before the outline a panel feels contact")] = 0.02


class Inertial(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A gyro with bias and drift; `absolute` sensors also know theta (3DM-GX1)."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 50.0
    absolute: Annotated[bool, Meta(description="true: it knows the heading of the map as well")] = False
    bias_dps: Annotated[NotNegative, Meta(description="standard deviation of the constant bias, drawn once a run")] = 0.0
    noise_dps: Annotated[NotNegative, Meta(description="standard deviation of a turn rate")] = 0.0
    drift_dps_per_sqrt_s: Annotated[NotNegative, Meta(description="random walk of the bias")] = 0.0
    angle_noise_deg: Annotated[NotNegative, Meta(description="noise of absolute angles, from reading to reading")] = 0.0
    angle_wander_deg: Annotated[NotNegative, Meta(description="standard deviation of the slowly changing error of absolute angles")] = 0.0
    angle_wander_s: Annotated[Positive, Meta(description="time in which that error changes")] = 10.0
    acceleration_noise_mps2: Annotated[NotNegative, Meta(description="standard deviation of an acceleration")] = 0.0


class Compass(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Magnetic compass; worlds give local anomalies."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 10.0
    noise_deg: Annotated[NotNegative, Meta(description="standard deviation of the heading")] = 0.0


class Gps(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """GPS receiver; worlds give shadows."""

    rate_hz: Annotated[Positive, Meta(description="fixes a second")] = 1.0
    noise_m: Annotated[NotNegative, Meta(description="standard deviation from fix to fix")] = 0.0
    wander_m: Annotated[NotNegative, Meta(description="slowly changing error")] = 0.0


class Wrist(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Pan-tilt unit under the laser."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 20.0
    pan_limit_deg: Annotated[Positive, Meta(description="farthest to either side")] = 57.3
    tilt_limit_deg: Annotated[Positive, Meta(description="farthest up or down")] = 57.3
    max_rate_dps: Annotated[Positive, Meta(description="fastest turn of an axis")] = 60.0
    max_acceleration_dps2: Annotated[Positive, Meta(description="quickest change of that")] = 120.0


class Arm(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An arm that can be unfolded."""

    unfold_s: Annotated[Positive, Meta(description="time to unfold it, and to fold it again")] = 4.0


class MarkerCamera(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Camera that sees markers on the ceiling and reports the car's position."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 3.0
    range_m: Annotated[Positive, Meta(description="farthest marker that is seen")] = 3.0
    noise_m: Annotated[NotNegative, Meta(description="standard deviation of the position")] = 0.0
    angle_noise_deg: Annotated[NotNegative, Meta(description="standard deviation of the heading")] = 0.0
    delay_s: Annotated[NotNegative, Meta(description="from the picture to its reading")] = 0.2
    outlier_rate: Annotated[float, Meta(ge=0, le=1, description="share of readings that are nonsense")] = 0.0


class WheelSpeed(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Unsigned wheel speed."""

    rate_hz: Annotated[Positive, Meta(description="readings a second")] = 5.0
    noise_mps: Annotated[NotNegative, Meta(description="standard deviation of the speed")] = 0.0
    resolution_mps: Annotated[NotNegative, Meta(description="speeds are whole multiples of it; 0 = exact")] = 0.01


class Steering(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Ackermann steering servo."""

    noise_percent: Annotated[NotNegative, Meta(description="standard deviation of what the servo makes of a new command, percent of it")] = 0.0
    rate_percent_per_s: Annotated[Positive, Meta(description="how fast the servo turns")] = 400.0


class Battery(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Main battery."""

    full_v: Annotated[Positive, Meta(description="voltage at the start")] = 26.0
    empty_v: Annotated[Positive, Meta(description="voltage when empty")] = 22.0
    hours: Annotated[Positive, Meta(description="from full to empty when driving")] = 5.0


class Devices(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The devices the robot has; an absent table is an absent device."""

    odometry: Odometry = Odometry()
    battery: Battery = Battery()
    laser: Laser | None = None
    sonar: Sonar | None = None
    bumpers: Bumpers | None = None
    dmu: Inertial | None = None
    imu: Inertial | None = None
    compass: Compass | None = None
    gps: Gps | None = None
    wrist: Wrist | None = None
    arm: Arm | None = None
    marker: MarkerCamera | None = None
    speed: WheelSpeed | None = None
    steering: Steering | None = None


class Platform(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The robot as a body with devices. The tables of the modules (drive, avoid, …) in the same file are declared by their modules."""

    name: Annotated[str, Meta(description="name of the platform")]
    body: Body
    limits: Limits
    devices: Devices = Devices()
