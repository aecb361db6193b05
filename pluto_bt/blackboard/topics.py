"""THE table of topics: name, type, writer, period, stale-after, meaning. Everything else about topics is derived from it.

Names are those of the sources (Pluto manual; DESIGN.md, section 9). A topic has one writer, a row of `pluto_bt.system.MODULES`
(or `gateway`). `period_s` 0 = written on change; `stale_after_s` 0 = never too old.
"""

from __future__ import annotations

from dataclasses import dataclass

from pluto_bt.blackboard.messages import (
    ActuatorState,
    AlarmState,
    BatteryState,
    BumperState,
    CompassState,
    Event,
    Flag,
    FVectorState,
    GasState,
    GpsState,
    ImuState,
    JobState,
    LaserPose,
    LaserScan,
    LocalMapState,
    MarkerState,
    Message,
    MissionState,
    ModulesState,
    PathState,
    Pose,
    RectangleState,
    ScanTiming,
    SonarState,
    SpeedState,
    TreeState,
    WeatherState,
    WorldState,
)


@dataclass(frozen=True, slots=True)
class Topic:
    """One row of the table."""

    name: str
    type: type[Message]
    writer: str
    period_s: float
    stale_after_s: float
    doc: str
    history: int = 1


LATER_WRITERS = ("weather", "gas", "pose", "slam")  # the sources name their topics; the modules come later, and until then nobody writes

# fmt: off
TOPICS: tuple[Topic, ...] = (
    #     name                                 type           writer      period  stale  doc
    Topic("ATRV2/Drive/Raw",                   ActuatorState, "base",      0.02,  0.2,  "odometry of the base: position = distance driven (m), heading (rad); velocity = real velocities", history=64),
    Topic("ATRV2/Drive/Command",               ActuatorState, "base",      0.0,   0.0,  "the velocity command the base accepted last"),
    Topic("ATRV2/Sonar",                       SonarState,    "base",      0.1,   0.5,  "sonar ranges"),
    Topic("ATRV2/Bumper",                      BumperState,   "base",      0.1,   0.5,  "bumper panels"),
    Topic("ATRV2/Battery",                     BatteryState,  "base",      1.0,   5.0,  "battery"),
    Topic("sick/rwi181",                       LaserScan,     "sick",      0.2,   0.6,  "first sick interface: 181 points, stamped at arrival"),
    Topic("sick/scan",                         LaserScan,     "sick",      0.2,   0.8,  "second sick interface: every point, stamped mid-scan", history=8),
    Topic("sick/timing",                       ScanTiming,    "sick",      0.2,   0.8,  "third sick interface: stamp and number of points"),
    Topic("dmu/raw",                           ImuState,      "dmu",       0.02,  0.2,  "inertial sensor as measured, z up"),
    Topic("dmu/state",                         ImuState,      "dmu",       0.02,  0.2,  "filtered; theta = rotation since the start, bias removed", history=64),
    Topic("imu/state",                         ImuState,      "imu",       0.02,  0.2,  "orientation sensor (3DM-GX1): absolute angles"),
    Topic("imu/alarms",                        AlarmState,    "alarms",    0.05,  0.3,  "stasis, stuck wheels (both until read), tilt"),
    Topic("compass/state",                     CompassState,  "compass",   0.1,   1.0,  "magnetic compass"),
    Topic("wrist/command",                     ActuatorState, "wrist",     0.0,   0.0,  "the wrist command accepted last; velocity and acceleration must both be > 0 to move"),
    Topic("wrist/state",                       ActuatorState, "wrist",     0.05,  0.5,  "pan and tilt", history=32),
    Topic("arm/state",                         ActuatorState, "arm",       0.1,   0.5,  "the arm: position[0] = how far unfolded, 0 to 1"),
    Topic("gps/state",                         GpsState,      "gps",       1.0,   3.0,  "GPS position in the map frame"),
    Topic("weather/state",                     WeatherState,  "weather",   1.0,   10.0, "weather sensor"),
    Topic("gas/state",                         GasState,      "gas",       1.0,   10.0, "gas sensor"),
    Topic("pose/status",                       FVectorState,  "pose",      0.2,   1.0,  "pose module: element[0] = 1 while it runs, [1] = points of the wall it found; data = gamma, rho, covariance"),
    Topic("slam/status",                       FVectorState,  "slam",      0.2,   1.0,  "slam module: element[0] = 1 while it runs, [1] = -1 while it saves the map"),
    Topic("car/marker",                        MarkerState,   "marker",    0.3,   5.0,  "camera markers and the gate's verdict"),
    Topic("car/speed",                         SpeedState,    "speed",     0.2,   1.0,  "wheel speed, unsigned"),
    Topic("Localization/Dead-Reckoning",       Pose,          "local",     0.02,  0.2,  "interface 0: dead reckoning since the start, never jumps", history=64),
    Topic("Localization/Laser_Dead-Reckoning", LaserPose,     "local",     0.2,   0.8,  "interface 1: pose of the laser at the latest scan; covariance since the scan before"),
    Topic("Localization/Post_Pose",            Pose,          "local",     0.0,   0.0,  "interface 2: the improved pose accepted last; setter < 0 = robot pose, else laser pose"),
    Topic("Localization/Pose",                 Pose,          "local",     0.02,  0.2,  "interface 3: 0 adjusted by 2", history=64),
    Topic("Localization/Laser_Pose",           LaserPose,     "local",     0.2,   0.8,  "interface 4: 1 adjusted by 2"),
    Topic("Localization/Check",                FVectorState,  "local",     0.0,   0.0,  "do wheels, gyro and laser agree? element[0] = 0 they do, 1 one is corrected, 2 lost, 3 a sensor or all markers are silent; data = share of the wheels' way believed, drift taken off the gyro (rad/s), share of the scan that fits"),
    Topic("filter/status",                     FVectorState,  "filter",    0.05,  0.3,  "verdict of the stop filter: element[0], why, and the velocities let through"),
    Topic("drive/command",                     ActuatorState, "drive",     0.0,   0.0,  "the command the drive accepted last"),
    Topic("drive/status",                      FVectorState,  "drive",     0.05,  0.3,  "status of the drive: element[0]; data = velocities in force"),
    Topic("avoidance/command",                 ActuatorState, "avoid",     0.0,   0.0,  "the command avoidance accepted last"),
    Topic("avoidance/status",                  FVectorState,  "avoid",     0.1,   0.5,  "status of avoidance: element[0..1]"),
    Topic("motion/command",                    ActuatorState, "motion",    0.0,   0.0,  "the command motion accepted last"),
    Topic("motion/status",                     FVectorState,  "motion",    0.1,   0.5,  "status of motion: element[0..3]"),
    Topic("motion/job",                        JobState,      "executive", 0.0,   0.0,  "the job of motion (42 to 45) that the executive runs"),
    Topic("motion/rectangle",                  RectangleState, "motion",   0.0,   0.0,  "the rectangle that the jobs of motion never leave"),
    Topic("map/path",                          PathState,     "executive", 0.0,   0.0,  "the path of the map that the mission follows"),
    Topic("map/local",                         LocalMapState, "executive", 0.0,   0.0,  "what a job has seen and covered around the robot"),
    Topic("mission/state",                     MissionState,  "executive", 0.0,   0.0,  "the mission"),
    Topic("tree",                              TreeState,     "executive", 0.0,   0.0,  "the tree after each tick"),
    Topic("events",                            Event,         "executive", 0.0,   0.0,  "lines for operators", history=256),
    Topic("operator/word",                     Flag,          "gateway",   0.0,   0.0,  "what an operator tells the mission by <set>, for missions that wait for a word"),
    Topic("modules",                           ModulesState,  "executive", 1.0,   0.0,  "every module with its state"),
    Topic("world/state",                       WorldState,    "world",     0.0,   0.0,  "simulation: the truth"),
    Topic("world/alarm",                       Flag,          "world",     0.0,   0.0,  "simulation: a flag that world scripts set"),
)
# fmt: on
