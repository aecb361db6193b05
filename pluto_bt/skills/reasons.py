"""The words with which the chain says why the robot does not move as commanded: `FVectorState.reason` is one of them, or ""."""

from __future__ import annotations

BAD_COMMAND = "bad-command"
BUMPER = "bumper"
BUMPER_STALE = "bumper-stale"
CHAIN_STOPPED = "chain-stopped"
COMMAND_TIMEOUT = "command-timeout"
ESTOP = "estop"
EXECUTIVE_SILENT = "executive-silent"
GYRO_STALE = "gyro-stale"
HINDERED = "hindered"
LASER = "laser"
LASER_FATAL = "laser-fatal"
LASER_STALE = "laser-stale"
LOST = "lost"
MARKER_STALE = "marker-stale"
NO_DEVICE = "no-device"
NO_POSE = "no-pose"
NO_WALL = "no-wall"
NOTHING_TO_RESUME = "nothing-to-resume"
ODOMETRY_FROZEN = "odometry-frozen"
ODOMETRY_STALE = "odometry-stale"
OPERATOR_STOP = "operator-stop"
OUTSIDE_MAP = "outside-map"
OUTSIDE_RECTANGLE = "outside-rectangle"
SONAR = "sonar"
SONAR_STALE = "sonar-stale"
SPEED_STALE = "speed-stale"
STOPPED = "stopped"
STUCK = "stuck"
UNSEEN = "unseen"
WALL_LOST = "wall-lost"
WALKER = "walker"
WRIST_STALE = "wrist-stale"

PLACELESS = (LOST, NO_POSE, GYRO_STALE, SPEED_STALE)  # words of localisation: the pose must not be believed

CHAIN_REASONS: dict[str, str] = {
    BAD_COMMAND: "the link does not know these cmdFlags, or a number of the command is missing or not finite; zero velocity",
    BUMPER: "a bumper is or was pressed; back off, release it, then send a new command",
    BUMPER_STALE: "the bumpers are missing or too old; nothing else feels what is lower than every sensor",
    CHAIN_STOPPED: "a link farther down the chain does not run: nothing reaches the base",
    COMMAND_TIMEOUT: "no new command came in time; a controlled stop",
    ESTOP: "the emergency stop is latched; release it, then command anew",
    EXECUTIVE_SILENT: "the executive has stopped working; nothing moves without it",
    GYRO_STALE: "the gyro says nothing, and nothing else tells where the car points",
    HINDERED: "the car is told to drive and its wheels stand still",
    LASER: "the laser sees an obstacle in the way; slower or stopped until it is clear",
    LASER_FATAL: "the laser has had a fatal error and is rebooting (about 20 s)",
    LASER_STALE: "the laser is asked for and delivers nothing that can be trusted: old, frozen, or full of holes",
    LOST: "the laser sees another place than wheels and gyro tell of: nobody knows where the robot is; post a pose",
    MARKER_STALE: "no marker has passed for long: the car's place is reckoned from wheels and gyro alone, and grows uncertain; it drives on",
    NO_DEVICE: "the job needs a device that the platform does not have",
    NO_POSE: "the command needs Localization/Pose, and there is none or it is too old",
    NO_WALL: "wall follow sees no wall within reach, or none with room beside it",
    NOTHING_TO_RESUME: "45: nothing was stopped, and no rectangle is set",
    OUTSIDE_RECTANGLE: "the goal or the start is outside the rectangle",
    ODOMETRY_FROZEN: "the wheels are told to turn and the encoders stand still: blocked wheels or dead encoders",
    ODOMETRY_STALE: "the base's odometry is missing or too old",
    OPERATOR_STOP: "an operator stopped the robot; resume the mission or send a new command",
    OUTSIDE_MAP: "the motion would leave the mapped area",
    SONAR: "a sonar hears an obstacle in the way; slower or stopped until it is clear",
    SONAR_STALE: "the sonar is asked for and delivers nothing that can be trusted",
    SPEED_STALE: "the wheel speed sensor says nothing, and nothing else tells how far the car has driven",
    STOPPED: "stop was commanded, or the link's thread is stopped",
    STUCK: "goto makes no progress towards the goal, or wall follow none along the wall",
    UNSEEN: "the way leads where nothing was ever seen; there the robot creeps",
    WALL_LOST: "the wall that was followed is not there any more",
    WALKER: "somebody walks near the way, or may do so out of view; the robot creeps there, or waits",
    WRIST_STALE: "the wrist says nothing, so nobody knows where the laser looks",
}
