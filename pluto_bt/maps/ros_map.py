"""ROS maps: `map.yaml` and its image, with the meaning that nav2_map_server (and map_server before it) gives to them.

Darkness p = 1 − grey/white (grey/white with `negate`). Modes:
    trinary  p > occupied_thresh: obstacle; p < free_thresh: free; else unknown
    scale    the same, but between the thresholds a cell is merely costly, so free here; a transparent pixel is unknown
    raw      the grey value 0 … 100 is the cell itself: 100 is an obstacle, above 100 is unknown
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pluto_bt.maps.grey_image import GreyImage, read_grey_image
from pluto_bt.maps.world import OccupancyGrid, World
from pluto_bt.source import Faults, did_you_mean
from pluto_bt.source.key_places import KeyPlaces
from pluto_bt.source.text import read_bytes
from pluto_bt.source.yaml_reader import read_yaml

KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")
MODES = ("trinary", "scale", "raw")
MIN_RESOLUTION_M = 1e-4
ROWS_AT_ONCE = 64
MAX_METRES = 1e6  # of any coordinate; beyond, centimetres are lost in the rounding


def read_ros_map(path: Path, shown_name: str, faults: Faults) -> World | None:
    """The map as a world that has nothing but a grid, or None and faults."""
    reading = Faults()
    values, places = read_yaml(path, shown_name, reading)
    faults.extend(reading.in_order())
    if reading.has_errors:
        return None
    fields = _MapFields(values, places, faults)
    fields.warn_of_unknown_keys()
    resolution_m = fields.number("resolution", None, 0.0, MAX_METRES)
    if resolution_m < MIN_RESOLUTION_M:
        what = "resolution must be greater than 0" if resolution_m == 0.0 else "the pixels are too small"
        fields.fault("resolution", what, f"metres per pixel, at least {MIN_RESOLUTION_M:g}, for example 0.05")
    origin = fields.origin()
    occupied, free = fields.number("occupied_thresh", 0.65, 0.0, 1.0), fields.number("free_thresh", 0.25, 0.0, 1.0)
    if free > occupied:
        fields.fault("free_thresh", "free_thresh is greater than occupied_thresh", f"at most {occupied:g}")
    mode, negate = fields.mode(), fields.number("negate", 0.0, 0.0, 1.0) != 0.0
    image = fields.image(path, shown_name)
    if image is None or fields.has_errors:
        return None
    grid = OccupancyGrid(*cells(_lowest_first(image), mode, negate, occupied, free), resolution_m, origin)
    return World(name=Path(shown_name).stem, file=shown_name, grid=grid, files=(str(path), str(path.parent / str(values["image"]))))


def cells(
    image: GreyImage, mode: str, negate: bool, occupied_thresh: float, free_thresh: float
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """(obstacle, unknown) of every pixel, 0 or 1; a table of all grey values does the arithmetic once."""
    shade = np.arange(image.white + 1) / image.white
    if mode == "raw":
        value = np.rint(shade * 255.0)
        obstacle, unknown = value == 100.0, value > 100.0
    else:
        dark = shade if negate else 1.0 - shade
        obstacle = dark > occupied_thresh
        unknown = ~obstacle & ~(dark < free_thresh) if mode == "trinary" else np.zeros_like(obstacle)
    is_obstacle, is_unknown = _looked_up(obstacle, image.grey), _looked_up(unknown, image.grey)
    if mode == "scale" and image.is_opaque is not None:
        is_obstacle &= image.is_opaque
        is_unknown |= ~image.is_opaque
    is_obstacle.setflags(write=False)
    is_unknown.setflags(write=False)
    return is_obstacle, is_unknown


def _looked_up(table: NDArray[np.bool_], grey: NDArray[Any]) -> NDArray[np.uint8]:
    """`table[grey]` as 0 or 1, some rows at a time: indexing widens the index to eight bytes a pixel."""
    values, found = table.astype(np.uint8), np.zeros(grey.shape, np.uint8)
    for first in range(0, len(grey), ROWS_AT_ONCE):
        found[first : first + ROWS_AT_ONCE] = values[grey[first : first + ROWS_AT_ONCE]]
    return found


def _lowest_first(image: GreyImage) -> GreyImage:
    """Row 0 of an image is the top, row 0 of a grid the lowest y."""
    return GreyImage(image.grey[::-1], image.white, None if image.is_opaque is None else image.is_opaque[::-1])


class _MapFields:
    """The values of a map file, each checked when it is asked for."""

    def __init__(self, values: dict[str, Any], places: KeyPlaces, faults: Faults) -> None:
        self._values, self._places, self._faults = values, places, faults
        self.has_errors = False

    def fault(self, key: str, message: str, expected: str, mend: str = "", index: str = "") -> None:
        """Note an error at the value of `key`."""
        self.has_errors = True
        path = (key, index) if index else (key,)
        found = self._values.get(key, "nothing")
        self._faults.error(self._places.value(path), "bad-value", message, expected=expected, found=str(found), mend=mend)

    def _missing(self, key: str, expected: str) -> None:
        self.has_errors = True
        place = self._places.first()
        self._faults.error(place, "missing-key", f'key "{key}" is missing', expected=f"{key}: {expected}", found="nothing", mend=f"add {key}")

    def warn_of_unknown_keys(self) -> None:
        """Other programs add keys of their own, so an unknown one is a warning only."""
        expected = f"one of: {', '.join(KEYS)}"
        for key in self._values:
            if key not in KEYS:
                what, mend = f'unknown key "{key}"', did_you_mean(key, KEYS)
                self._faults.warning(self._places((key,)), "unknown-key", what, expected=expected, found=key, mend=mend)

    def number(self, key: str, default: float | None, low: float, high: float) -> float:
        """A number from `low` to `high`; NaN after a fault."""
        if key not in self._values:
            if default is None:
                self._missing(key, "a number")
                return math.nan
            return default
        number = _as_number(self._values[key])
        if number is None or not low <= number <= high:
            self.fault(key, f"{key} must be a number from {low:g} to {high:g}", "a finite number in this range")
            return math.nan
        return number

    def origin(self) -> tuple[float, float, float]:
        """x m, y m, yaw rad of the lower left corner."""
        if "origin" not in self._values:
            self._missing("origin", "[x, y, yaw]")
            return (0.0, 0.0, 0.0)
        value = self._values["origin"]
        if not isinstance(value, list) or len(value) != 3:
            self.fault("origin", "origin must be a list of three numbers", "[x, y, yaw]")
            return (0.0, 0.0, 0.0)
        numbers = [_as_number(item) for item in value]
        for i, number in enumerate(numbers):
            if number is None or not abs(number) <= MAX_METRES:
                self.fault("origin", f"number {i + 1} of origin is no finite number", "[x, y, yaw]", index=str(i))
        x, y, yaw = (number or 0.0 for number in numbers)
        return (x, y, yaw)

    def mode(self) -> str:
        """How grey values become cells."""
        mode = str(self._values.get("mode", "trinary")).lower()
        if mode not in MODES:
            self.fault("mode", "unknown mode", f"one of: {', '.join(MODES)}", did_you_mean(mode, MODES))
        return mode

    def image(self, path: Path, shown_name: str) -> GreyImage | None:
        """The image, looked for beside the map file."""
        if "image" not in self._values:
            self._missing("image", "a file name")
            return None
        name = self._values["image"]
        if not isinstance(name, str) or not name:
            self.fault("image", "image must name a file", "image: map.pgm")
            return None
        reading = Faults()
        data = read_bytes(path.parent / name, os.path.join(os.path.dirname(shown_name), name), reading)
        place = self._places.value(("image",))
        for fault in reading.in_order():  # the place to mend is where the map file names it
            self._faults.error(place, fault.code, fault.message, expected=fault.expected, found=fault.found, mend=fault.mend)
        return None if data is None else read_grey_image(data, name, place, self._faults)


def _as_number(value: Any) -> float | None:
    """A finite number; YAML 1.1 takes 5e-2 for text, map_server does not."""
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            return None
    if not isinstance(value, (int, float)):  # True counts as 1, as for map_server
        return None
    return float(value) if abs(value) < 1e300 and value == value else None
