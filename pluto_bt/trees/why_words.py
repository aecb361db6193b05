"""What the words of the chain speak of when `why` looks for a first cause: which device, how low down it stands, and what mends it."""

from __future__ import annotations

from typing import Final

from pluto_bt.behaviours.reasons import REASONS
from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.skills import reasons
from pluto_bt.skills.reasons import CHAIN_REASONS

ODOMETRY: Final = "ATRV2/Drive/Raw"
WHEEL_SLIP: Final = "wheel-slip"
OF_SENSOR: Final = {  # word -> (what it speaks of, its topic)
    reasons.LASER_STALE: ("laser", "sick/scan"), reasons.LASER_FATAL: ("laser", "sick/scan"), reasons.LASER: ("laser", "sick/scan"),
    reasons.WRIST_STALE: ("wrist", "wrist/state"), reasons.SONAR_STALE: ("sonar", "ATRV2/Sonar"), reasons.SONAR: ("sonar", "ATRV2/Sonar"),
    reasons.BUMPER: ("bumpers", "ATRV2/Bumper"), reasons.BUMPER_STALE: ("bumpers", "ATRV2/Bumper"),
    reasons.ODOMETRY_STALE: ("odometry", ODOMETRY), reasons.ODOMETRY_FROZEN: ("wheels", ODOMETRY),
    reasons.NO_POSE: ("localisation", "Localization/Pose"), reasons.LOST: ("localisation", "Localization/Pose"),
    reasons.WALKER: ("people", ""), reasons.NO_WALL: ("laser", "sick/scan"), reasons.WALL_LOST: ("laser", "sick/scan"),
    WHEEL_SLIP: ("wheels", ""), reasons.GYRO_STALE: ("gyro", "dmu/state"), reasons.SPEED_STALE: ("wheel speed", "car/speed"),
    "tilted": ("orientation", "imu/alarms"), reasons.HINDERED: ("wheels", "car/speed"),
    reasons.OUTSIDE_MAP: ("map", ""), reasons.UNSEEN: ("filter", ""),
}  # fmt: skip
WRITERS: Final = {topic.name: topic.writer for topic in TOPICS}
BROKEN: Final = (  # devices
    reasons.LASER_FATAL, reasons.LASER_STALE, reasons.WRIST_STALE, reasons.SONAR_STALE, reasons.ODOMETRY_STALE, reasons.ODOMETRY_FROZEN,
    reasons.BUMPER, reasons.BUMPER_STALE, reasons.GYRO_STALE, reasons.SPEED_STALE,
)  # fmt: skip
OF_THE_BASE: Final = (reasons.ODOMETRY_STALE, reasons.NO_POSE, reasons.SONAR_STALE, reasons.BUMPER_STALE, "base-lost")  # while odometry is stale
OF_CODE: Final[dict[int | None, str]] = {
    LinkStatus.LASER_FATAL: reasons.LASER_FATAL, LinkStatus.LASER_SLOW_STOP: reasons.LASER, LinkStatus.FRONT_BUMPER: reasons.BUMPER,
    LinkStatus.BACK_BUMPER: reasons.BUMPER, LinkStatus.COMMAND_TIMEOUT: reasons.COMMAND_TIMEOUT,
}  # fmt: skip
OF_WAITING: Final = {  # the type of a node that waits -> what ends it
    "Sleep": "wait, or give it a shorter msec", "Delay": "wait, or give it a shorter delay_msec",
    "WaitValueUpdate": "write the entry that it waits for", "Precondition": "make its condition true, or let `else` be something else",
}  # fmt: skip
CURES: Final = {
    reasons.LASER: "clear the way, or wait until what stands there has gone",
    reasons.SONAR: "clear the way, or wait until what stands there has gone",
    WHEEL_SLIP: "look at the ground under the wheels; push the robot, or drive it out by hand",
    "paused": "`pluto shell resume`",
}  # fmt: skip


def rank(word: str) -> int:
    """Broken devices before wheels that stand, those before obstacles, and all before words that only say how it ended."""
    if word in BROKEN:
        return 0
    if word in (reasons.NO_POSE, reasons.LOST, WHEEL_SLIP, "tilted", reasons.HINDERED, reasons.OUTSIDE_MAP):
        return 1
    return 2 if word in OF_SENSOR else 3


def meaning(word: str) -> str:
    """What a word of OF_SENSOR means, in a sentence."""
    return CHAIN_REASONS.get(word) or REASONS[word].meaning


def cure(word: str) -> str:
    """What would unblock it; "" if nothing is known."""
    return REASONS[word].cure if word in REASONS else CURES.get(word, "")
