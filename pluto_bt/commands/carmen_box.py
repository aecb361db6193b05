"""A log of CARMEN as a recording from outside, so that every command that reads topics reads it."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from drivers.carmen_log import BadLine, Odometry, Pose, Scan, read_log
from pluto_bt import __version__
from pluto_bt.blackboard import Sample
from pluto_bt.blackboard import messages as m
from pluto_bt.record.watched import WatchedWriter
from pluto_bt.source import Faults, Place

ENDINGS: Final = (".log", ".clf", ".log.gz", ".clf.gz")


def is_carmen(name: str) -> bool:
    """By its ending."""
    return name.lower().endswith(ENDINGS)


def packed(name: str, to: Path, faults: Faults) -> bool:
    """Write the log as MCAP; False and a fault if it cannot be read or says nothing. Lines that make no sense are warnings."""
    writer, clock, count = WatchedWriter(to, Path(name).name, __version__), _Clock(), 0
    try:
        for record in read_log(_lines(name)):
            if isinstance(record, BadLine):
                place, what = Place(name, record.number, 1), "this line of the log makes no sense"
                faults.warning(place, "bad-line", what, expected=record.expected, found=record.found)
            else:
                count += 1
                _write(writer, record, clock.at(record.t_s), count)
    except (OSError, EOFError, zlib.error) as error:
        found = getattr(error, "strerror", None) or str(error)
        faults.error(Place(name), "no-such-file", f'cannot read "{name}"', expected="a log of CARMEN", found=found)
        return False
    finally:
        writer.finish()
    if not count:
        expected = "lines that begin with ODOM, FLASER or ROBOTLASER1"
        faults.error(Place(name), "not-carmen", f'"{name}" is no log of CARMEN', expected=expected, found="none")
    return count > 0


class _Clock:
    """Seconds since the first line; a stamp that runs backwards is the time of the line before."""

    def __init__(self) -> None:
        self._begin_s: float | None = None
        self._now_s = 0.0

    def at(self, stamp_s: float) -> float:
        self._begin_s = stamp_s if self._begin_s is None else self._begin_s
        self._now_s = max(self._now_s, stamp_s - self._begin_s)
        return self._now_s


def _lines(name: str) -> Iterator[str]:
    opened = gzip.open if name.lower().endswith(".gz") else open
    with opened(name, "rt", encoding="utf-8", errors="replace") as file:
        yield from file


def _write(writer: WatchedWriter, record: Odometry | Scan, t_s: float, seq: int) -> None:
    if isinstance(record, Odometry):
        told: dict[str, m.Message] = {
            "Localization/Dead-Reckoning": _pose(t_s, record.pose),
            "ATRV2/Drive/Raw": m.ActuatorState(t_s, velocity=record.velocity),
        }
    else:
        x_m, y_m, theta_rad = record.laser
        told = {
            "sick/scan": m.LaserScan(t_s, record.angle_min_rad, record.angle_step_rad, m.read_only(record.ranges_m), len(record.ranges_m)),
            "Localization/Laser_Pose": m.LaserPose(t_s, (x_m, y_m, 0.0, theta_rad, 0.0, 0.0, 0.0, 0.0)),
            "Localization/Pose": _pose(t_s, record.laser),
        }
    for topic, value in told.items():
        writer.take(topic, Sample(value, seq, t_s))


def _pose(t_s: float, pose: Pose) -> m.Pose:
    return m.Pose(t_s, (pose[0], pose[1], 0.0, math.remainder(pose[2], math.tau), 0.0, 0.0))
