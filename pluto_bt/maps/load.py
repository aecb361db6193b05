"""Reads a world from any of the three formats: ROS map (`.yaml`), ARNL map (`.map`), our own (`.xml`)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from pluto_bt.maps.arnl_map import FIRST_LINES, read_arnl_map
from pluto_bt.maps.ros_map import read_ros_map
from pluto_bt.maps.world import World
from pluto_bt.maps.world_xml import read_world_xml
from pluto_bt.source import Faults, Place, read_xml_file
from pluto_bt.source.text import read_bytes

IMAGE_SUFFIXES = (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".gif", ".tif", ".tiff")
_IMAGE_STARTS = (b"\x89PNG", b"P2", b"P5", b"BM", b"\xff\xd8\xff", b"GIF8")
_SUFFIXES = {".yaml": "ros", ".yml": "ros", ".map": "arnl", ".xml": "xml"}


def load_world(path: Path | str, shown_name: str | None = None, warnings: Faults | None = None) -> World:
    """The world that a file describes.

    Args:
        shown_name: the file's name as the user gave it, for faults; default the path.
        warnings: takes over what works but is probably not meant.
    Raises: InputError with every fault found.
    """
    faults = Faults()
    world = read_world(Path(path), shown_name or str(path), faults)
    if warnings is not None:
        warnings.extend(faults.in_order())
    faults.raise_errors()
    assert world is not None  # else there was an error
    return world


def read_world(path: Path, shown_name: str, faults: Faults) -> World | None:
    """The world that a file describes, or None and faults."""
    kind = _SUFFIXES.get(path.suffix.lower()) or _kind_by_content(path, shown_name, faults)
    if kind == "xml":
        root = read_xml_file(path, shown_name, faults)
        return None if root is None else read_world_xml(root, path, shown_name, faults, read_map)
    return read_map(path, shown_name, faults) if kind else None


def read_map(path: Path, shown_name: str, faults: Faults) -> World | None:
    """The static map that a file describes (ROS or ARNL), or None and faults."""
    kind = _SUFFIXES.get(path.suffix.lower()) or _kind_by_content(path, shown_name, faults)
    if kind == "ros":
        return read_ros_map(path, shown_name, faults)
    if kind == "arnl":
        arnl = read_arnl_map(path, shown_name, faults)
        return None if arnl is None else replace(arnl, files=(str(path),))
    if kind == "xml":
        expected = "a ROS map (.yaml) or an ARNL map (.map)"
        faults.error(Place(shown_name), "bad-value", "this is a world, not a map", expected=expected, found=path.suffix)
    return None


def _kind_by_content(path: Path, shown_name: str, faults: Faults) -> str:
    """Which format a file without a telling suffix has; "" and a fault if none."""
    data = read_bytes(path, shown_name, faults)
    if data is None:
        return ""
    start = data[:200].removeprefix(b"\xef\xbb\xbf").lstrip()
    if start.startswith(b"<"):
        return "xml"
    if start.startswith(tuple(line.encode() for line in FIRST_LINES)):
        return "arnl"
    expected = "our world (.xml), a ROS map (.yaml) or an ARNL map (.map)"
    if path.suffix.lower() in IMAGE_SUFFIXES or data.startswith(_IMAGE_STARTS):
        mend = "give the .yaml that says what the image means: image, resolution, origin"
        faults.error(Place(shown_name), "bare-image", "this is an image, not a world", expected=expected, found=path.suffix or "an image", mend=mend)
        return ""
    if b"image:" in data[:4096]:
        return "ros"
    found = path.suffix or repr(start[:20])[2:-1] or "nothing"
    faults.error(Place(shown_name), "unknown-format", "this is no world that can be read", expected=expected, found=found)
    return ""
