"""A fan of beams from one point, and which of them can see a thing.

The fan lies in the laser's plane; the plane is tilted about the laser's lateral axis, and everything is then done with the shadow
of the fan on the ground: each beam has a level direction, a slope (rise per level metre) and a stretch (level metres per metre of range).
In a regular fan the beams that meet a thing have consecutive indices, found from the directions of its two ends.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.kernel import inline_kernel, kernel

Table = NDArray[np.float64]

# rows of the table of a fan
COS, SIN, DIRECTION_X, DIRECTION_Y, SLOPE, STRETCH, HEAD = range(7)
# entries of the row HEAD; BEAMS_PER_RAD 0 marks a fan that is not regular
FIRST_RAD, LAST_RAD, BEAMS_PER_RAD, TILT_RAD, COS_TILT = range(5)

MARGIN_RAD = 3e-5  # beams this far beside a thing are tried too: covers `rough_azimuth`, irregularity and rounding
LEAST_COS_TILT = 1e-3  # nearer to the vertical, indices no longer follow from directions: all beams are tried
VERTICAL = 1e-12  # the least stretch: a vertical beam is taken for one that leans by this


def fan_of(angles_rad: NDArray[np.float64]) -> Table:
    """The table of a fan at tilt 0. Any angles serve; equally spaced, rising ones are fast."""
    n_beams = len(angles_rad)
    fan = np.zeros((7, max(n_beams, 5)))
    fan[COS, :n_beams] = fan[DIRECTION_X, :n_beams] = np.cos(angles_rad)
    fan[SIN, :n_beams] = fan[DIRECTION_Y, :n_beams] = np.sin(angles_rad)
    fan[STRETCH] = 1.0
    fan[HEAD, COS_TILT] = 1.0
    if n_beams > 1 and angles_rad[-1] > angles_rad[0]:
        first_rad, last_rad = float(angles_rad[0]), float(angles_rad[-1])
        even = np.linspace(first_rad, last_rad, n_beams)
        if float(np.abs(angles_rad - even).max()) < MARGIN_RAD / 3:
            fan[HEAD, :3] = first_rad, last_rad, (n_beams - 1) / (last_rad - first_rad)
    return fan


@kernel
def aim_fan(fan: Table, n_beams: int, tilt_rad: float) -> None:
    """Tilt the plane of the fan; tilt > 0 turns the forward beam down."""
    cos, sin = math.cos(tilt_rad), math.sin(tilt_rad)
    for i in range(n_beams):
        forward, left = fan[COS, i] * cos, fan[SIN, i]
        stretch = 1.0 if tilt_rad == 0.0 else max(math.sqrt(forward * forward + left * left), VERTICAL)
        fan[STRETCH, i] = stretch
        fan[DIRECTION_X, i] = forward / stretch
        fan[DIRECTION_Y, i] = left / stretch
        fan[SLOPE, i] = -fan[COS, i] * sin / stretch
    fan[HEAD, TILT_RAD] = tilt_rad
    fan[HEAD, COS_TILT] = cos


@inline_kernel
def rough_azimuth(x: float, y: float) -> float:
    """atan2(y, x) within 1.2e-5 rad, several times faster. Ref: Abramowitz and Stegun, 4.4.49."""
    ax, ay = abs(x), abs(y)
    ratio = min(ax, ay) / max(ax, ay) if ax + ay > 0.0 else 0.0
    square = ratio * ratio
    angle = ratio * (0.9998660 + square * (-0.3302995 + square * (0.1801410 + square * (-0.0851330 + square * 0.0208351))))
    if ay > ax:
        angle = 0.5 * math.pi - angle
    if x < 0.0:
        angle = math.pi - angle
    return -angle if y < 0.0 else angle


@inline_kernel
def sight(fan: Table, x1: float, y1: float, x2: float, y2: float) -> tuple[float, float]:
    """The angles (low, high) between which beams can meet what lies between two points, seen from the laser; all if it stands on the laser.

    `low` is the least that does not end before the fan; the same interval, one turn on, may meet the fan again.
    """
    first_rad, cos_tilt = fan[HEAD, FIRST_RAD], fan[HEAD, COS_TILT]
    y1 *= cos_tilt  # from the azimuth on the ground to the angle in the tilted plane
    y2 *= cos_tilt
    cross, dot = x1 * y2 - x2 * y1, x1 * x2 + y1 * y2
    on_the_laser = dot <= 0.0 and cross * cross <= 1e-8 * (x1 * x1 + y1 * y1) * (x2 * x2 + y2 * y2)
    if on_the_laser or fan[HEAD, BEAMS_PER_RAD] == 0.0 or cos_tilt < LEAST_COS_TILT:
        return first_rad - MARGIN_RAD, fan[HEAD, LAST_RAD] + MARGIN_RAD
    low = rough_azimuth(x1, y1)
    width = rough_azimuth(x2, y2) - low
    if width > math.pi:
        width -= 2.0 * math.pi
    elif width < -math.pi:
        width += 2.0 * math.pi
    if width < 0.0:
        low, width = low + width, -width
    low -= MARGIN_RAD
    width += 2.0 * MARGIN_RAD
    low += 2.0 * math.pi * math.ceil((first_rad - low - width) / (2.0 * math.pi))
    return low, low + width


@inline_kernel
def beams_within(fan: Table, n_beams: int, low_rad: float, high_rad: float) -> tuple[int, int]:
    """The beams between two angles as a range (first, end)."""
    first_rad, per_rad = fan[HEAD, FIRST_RAD], fan[HEAD, BEAMS_PER_RAD]
    if per_rad == 0.0:
        return 0, n_beams
    return max(0, math.ceil((low_rad - first_rad) * per_rad)), min(n_beams, math.floor((high_rad - first_rad) * per_rad) + 1)
