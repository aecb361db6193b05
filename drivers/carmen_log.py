"""Logs of CARMEN as robots and SLAM benchmarks leave them: lines of text with odometry and level laser scans.

    ODOM x y theta tv rv accel  ipc_time host logger_time
    FLASER n r1 … rn  x y theta  odom_x odom_y odom_theta  ipc_time host logger_time
    ROBOTLASER1 type start_angle field_of_view resolution max_range accuracy remission n r1 … rn m e1 … em
                laser_x laser_y laser_theta  x y theta  tv rv  front_margin side_margin turn_axis  ipc_time host logger_time

Metres, radians, seconds. The first pose of a FLASER is where the laser was, corrected if the log was; the second is raw odometry.
The order of the lines is the order in time; stamps of old logs may run backwards. Words that are not known here are passed over.
Source: CARMEN 0.7.4-beta, logger/readlog.c and the heads of its logs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final, NamedTuple

Pose = tuple[float, float, float]
TAIL: Final = 3  # ipc_time host logger_time
MOST_BEAMS: Final = 100_000


class Odometry(NamedTuple):
    """Where the wheels say that the robot is, and how fast it drives (m/s, rad/s)."""

    t_s: float
    pose: Pose
    velocity: tuple[float, float]


class Scan(NamedTuple):
    """A level scan: beam i points to `angle_min_rad + i * angle_step_rad`, counter-clockwise from the laser's own x axis."""

    t_s: float
    angle_min_rad: float
    angle_step_rad: float
    ranges_m: tuple[float, ...]
    laser: Pose
    robot: Pose


class BadLine(NamedTuple):
    """A line that begins as one of ours and does not go on so; `number` counts from 1."""

    number: int
    expected: str
    found: str


def read_log(lines: Iterable[str]) -> Iterator[Odometry | Scan | BadLine]:
    """What the lines say, in order."""
    for number, line in enumerate(lines, 1):
        words = line.split()
        read = _READERS.get(words[0]) if words else None
        if read is not None:
            try:
                yield read(words[1:])
            except IndexError:
                yield BadLine(number, f"{words[0]} with {_FORMS[words[0]]}", f"{len(words) - 1} words")
            except (ValueError, OverflowError) as error:
                yield BadLine(number, f"{words[0]} with {_FORMS[words[0]]}", str(error))


def _odometry(words: Sequence[str]) -> Odometry:
    x_m, y_m, theta_rad, tv, rv, _ = _numbers(words[: -TAIL], 6)
    return Odometry(_time(words), (x_m, y_m, theta_rad), (tv, rv))


def _flaser(words: Sequence[str]) -> Scan:
    count = _count(words[0])
    numbers = _numbers(words[1:-TAIL], count + 6)
    step_rad = math.pi / (count if count % 2 == 0 else count - 1)  # 180 beams: -90° + i · 1°; 181 beams: the last one at +90°
    return Scan(_time(words), -math.pi / 2, step_rad, numbers[:count], _pose(numbers[count:]), _pose(numbers[count + 3 :]))


def _robotlaser(words: Sequence[str]) -> Scan:
    count = _count(words[7])
    extra = _count(words[8 + count], least=0)
    numbers = _numbers(words[8 : 8 + count], count)
    poses = _numbers(words[9 + count + extra : -TAIL], 11)
    return Scan(_time(words), float(words[1]), float(words[3]), numbers, _pose(poses), _pose(poses[3:]))


def _numbers(words: Sequence[str], count: int) -> tuple[float, ...]:
    if len(words) != count:
        raise ValueError(f"{len(words)} numbers in place of {count}")
    numbers = tuple(map(float, words))
    if not all(map(math.isfinite, numbers)):
        raise ValueError("a number that is not finite")
    return numbers


def _count(word: str, least: int = 2) -> int:
    count = int(word)
    if not least <= count <= MOST_BEAMS:
        raise ValueError(f"{count} beams")
    return count


def _pose(numbers: Sequence[float]) -> Pose:
    return numbers[0], numbers[1], numbers[2]


def _time(words: Sequence[str]) -> float:
    return _numbers(words[-TAIL : -TAIL + 1], 1)[0]


_READERS: Final[dict[str, Callable[[Sequence[str]], Odometry | Scan]]] = {"ODOM": _odometry, "FLASER": _flaser, "ROBOTLASER1": _robotlaser}
_FORMS: Final = {
    "ODOM": "x y theta tv rv accel, time, host, time",
    "FLASER": "n, n ranges, two poses, time, host, time",
    "ROBOTLASER1": "7 words, n, n ranges, m, m remissions, two poses, 5 numbers, time, host, time",
}
