"""The laser scans of a black box, each with the place where localisation had the laser at that moment."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from pluto_bt.blackboard import Sample
from pluto_bt.blackboard.messages import LaserPose, LaserScan

SCAN, LASER = "sick/scan", "Localization/Laser_Pose"
LEVEL_RAD: Final = math.radians(1.0)
SAME_S: Final = 1e-6  # two stamps of one moment


def placed(scans: Sequence[Sample], lasers: Sequence[Sample]) -> list[tuple[LaserScan, LaserPose | None]]:
    """Samples of SCAN with those of LASER; None where no place of that moment was recorded."""
    places = {_moment(sample.value): sample.value for sample in lasers if isinstance(sample.value, LaserPose)}
    return [(sample.value, places.get(_moment(sample.value))) for sample in scans if isinstance(sample.value, LaserScan)]


def is_level(laser: LaserPose) -> bool:
    """True if its beams run along the ground, the right way up: one that looks down would draw walls where the ground is."""
    return max(abs(math.remainder(angle, math.tau)) for angle in laser.pose[4:6]) <= LEVEL_RAD


def _moment(value: LaserScan | LaserPose) -> int:
    return round(value.stamp_s / SAME_S)
