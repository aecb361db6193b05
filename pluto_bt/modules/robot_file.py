"""The robot file: one TOML file a platform, with the body, the devices and a table of parameters for each module."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from pluto_bt.gateway.limits import Limits
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.polygons import crossing, is_flat
from pluto_bt.modules.alarms import AlarmsParameters
from pluto_bt.modules.calibration import read_calibration
from pluto_bt.modules.dmu import DmuParameters
from pluto_bt.modules.local import LocalParameters
from pluto_bt.modules.marker import MarkerParameters
from pluto_bt.modules.record_parameters import RecordParameters
from pluto_bt.modules.resume_parameters import ResumeParameters
from pluto_bt.runtime.parameters import build, override
from pluto_bt.skills.avoid import AvoidParameters
from pluto_bt.skills.drive import DriveParameters
from pluto_bt.skills.filter_parameters import FilterParameters
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.wall_parameters import WallParameters
from pluto_bt.source import Faults, InputError, Place, did_you_mean
from pluto_bt.source.text import read_text
from pluto_bt.source.toml_reader import MAX_TOML_BYTES, read_toml

SHIPPED = ("atrv2", "car", "jbot", "pioneer")


class RobotFile(Platform, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A platform with the parameters of its modules; each struct is declared by the part that uses it."""

    drive: DriveParameters = DriveParameters()
    avoid: AvoidParameters = AvoidParameters()
    wall: WallParameters = WallParameters()
    motion: MotionParameters = MotionParameters()
    plan: PlanParameters = PlanParameters()
    filter: FilterParameters = FilterParameters()

    local: LocalParameters = LocalParameters()
    dmu: DmuParameters = DmuParameters()
    alarms: AlarmsParameters = AlarmsParameters()
    marker: MarkerParameters = MarkerParameters()
    record: RecordParameters = RecordParameters()
    resume: ResumeParameters = ResumeParameters()
    gateway: Limits = Limits()


def load_robot_file(name: str, settings: Sequence[str] = (), named_at: Place | None = None, overlay: Path | None = None) -> RobotFile:
    """The robot file of a shipped platform or at a path, with `--set` settings applied.

    Args:
        named_at: where a file that does not exist is told, if not by its own name.
        overlay: a file (`--params`) whose tables are laid over the platform's, before the settings; it need not exist yet.
    Raises: InputError with every fault of the file and of the settings.
    """
    faults = Faults()
    text = _text_of(name, named_at or Place(name), faults)
    table: dict[str, Any] = {}
    robot: RobotFile | None = None
    if text is None:
        override(table, settings, RobotFile, faults)  # their faults are told, too
    else:
        table, locate = read_toml(text, name if name.endswith(".toml") else f"{name}.toml", faults)
        laid: dict[tuple[str, ...], Place] = {} if overlay is None else _lay_over(table, overlay, faults)
        is_read = not faults.has_errors
        set_at = override(table, settings, RobotFile, faults)
        if is_read:
            robot = build(RobotFile, table, lambda path: set_at.get(path) or laid.get(path) or locate(path), faults)
        if robot is not None:
            _check_body(robot, locate(("body", "outline_m")), faults)
            key = ("drive", "calibration_file")
            robot = _with_calibration(robot, name, set_at.get(key) or locate(key), faults)
    faults.raise_errors()
    assert robot is not None  # build gives None only together with a fault
    return robot


def overlay_names(path: Path) -> frozenset[str]:
    """The dotted names that a `--params` file sets; none if it is not there."""
    return frozenset(".".join(names) for names in _lay_over({}, path, Faults()))


def _lay_over(table: dict[str, Any], path: Path, faults: Faults) -> dict[tuple[str, ...], Place]:
    """Write the values of a `--params` file into `table`; where each one stands."""
    if not path.exists():
        if not path.parent.is_dir():
            faults.error(Place(f"--params {path}"), "no-folder", "there is no such folder", mend=f"mkdir -p {path.parent}")
        return {}
    over, locate = read_toml(path, str(path), faults)
    places: dict[tuple[str, ...], Place] = {}
    waiting: list[tuple[tuple[str, ...], dict[str, Any], dict[str, Any]]] = [((), table, over)]
    while waiting:
        above, into, values = waiting.pop()
        for key, value in values.items():
            here = (*above, key)
            inner = into.get(key)
            if isinstance(value, dict) and isinstance(inner, dict | None):
                waiting.append((here, into.setdefault(key, {}), value))
            else:
                into[key] = value
                places[here] = locate(here)
    return places


def _text_of(name: str, named_at: Place, faults: Faults) -> str | None:
    """The file's text, or None and a fault."""
    if name in SHIPPED:
        return (resources.files("pluto_bt") / "platforms" / f"{name}.toml").read_text(encoding="utf-8")
    if not name.endswith(".toml"):
        faults.error(named_at, "unknown-platform", f'no platform "{name}"', expected=f"one of {', '.join(SHIPPED)}, or a .toml file",
                     found=name or "nothing", mend=did_you_mean(name, SHIPPED))  # fmt: skip
        return None
    reading = Faults()
    text = read_text(name, name, reading, max_bytes=MAX_TOML_BYTES)
    for fault in reading.in_order():
        place = Place(fault.file, fault.line, fault.column, fault.source_line) if fault.line else named_at
        faults.error(place, fault.code, fault.message, expected=fault.expected, found=fault.found, mend=fault.mend)
    return text


def _with_calibration(robot: RobotFile, name: str, place: Place, faults: Faults) -> RobotFile:
    """The robot with the path of its calibration file, looked for as given, then beside the platform file; a bad file is a fault."""
    given = robot.drive.calibration_file
    if not given:
        return robot
    path = next((path for path in (Path(given), Path(name).parent / given) if path.is_file()), None)
    if path is None:
        faults.error(place, "no-file", f'there is no calibration file "{given}"', expected="a TOML file with counts_per_m and effective_track_m",
                     mend="the path is taken from the working folder, then from that of the platform file")  # fmt: skip
        return robot
    try:
        read_calibration(path, str(path))
    except InputError as error:
        faults.extend(error.faults)
    return replace(robot, drive=replace(robot.drive, calibration_file=str(path)))


def _check_body(robot: RobotFile, place: Place, faults: Faults) -> None:
    """What single values cannot tell: the outline is a polygon round the origin; an ackermann robot knows its turning radius."""
    outline = np.array(robot.body.outline_m)
    if crossing(outline) is not None:
        faults.error(place, "self-crossing", "body.outline_m crosses itself", mend="list the corners in order round the robot")
    elif is_flat(outline):
        faults.error(place, "no-area", "body.outline_m encloses no area")
    if robot.body.kinematics == "ackermann" and robot.body.min_turn_radius_m <= 0:
        faults.error(place, "missing-parameter", "an ackermann body needs min_turn_radius_m", expected="metres, > 0", found="0",
                     mend="add min_turn_radius_m = … to [body]")  # fmt: skip


__all__ = ["SHIPPED", "InputError", "RobotFile", "load_robot_file"]
