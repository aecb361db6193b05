"""Poses as the text of ROS messages: nine parts with ';' between (stamp in ns, frame, position, quaternion), or JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any, Final

from pluto_bt.maps.numbers import MAX_METRES

POSE_PARTS: Final = 9


def yaw_deg(x: float, y: float, z: float, w: float) -> float:
    """The heading of a quaternion."""
    return math.degrees(math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))


def pose_of_parts(parts: Sequence[str]) -> tuple[int, str, float, float, float]:
    """Stamp in ns, frame, x, y, heading in degrees of the nine parts of a pose. Raises ValueError."""
    if len(parts) != POSE_PARTS:
        raise ValueError(f"a pose has {POSE_PARTS} parts, not {len(parts)}")
    x, y, _, qx, qy, qz, qw = (finite(part) for part in parts[2:])
    return int(finite(parts[0])), parts[1].strip(), metres(x), metres(y), yaw_deg(qx, qy, qz, qw)


def pose_of_json(tree: Any) -> tuple[int, str, float, float, float]:
    """The same of a PoseStamped in JSON. Raises ValueError."""
    pose = member(tree, "pose")
    position, turn = member(pose, "position"), member(pose, "orientation")
    x, y = (metres(member(position, axis)) for axis in "xy")
    return (*header_of(tree), x, y, yaw_deg(*(finite(member(turn, part)) for part in "xyzw")))


def read_json(text: str) -> Any:
    """What stands behind `json:`. Raises ValueError."""
    try:
        return json.loads(text[5:])
    except RecursionError:
        raise ValueError("it is nested too deeply") from None


def header_of(tree: Any) -> tuple[int, str]:
    """Stamp in ns and frame of a message; zero and "" where it has none. Raises ValueError."""
    header = tree.get("header", {}) if isinstance(tree, dict) else {}
    stamp = header.get("stamp", {}) if isinstance(header, dict) else {}
    frame = header.get("frame_id", "") if isinstance(header, dict) else ""
    sec, nanosec = (stamp.get(part, 0) for part in ("sec", "nanosec")) if isinstance(stamp, dict) else (0, 0)
    return int(finite(sec)) * 10**9 + int(finite(nanosec)), str(frame)


def member(tree: Any, name: str) -> Any:
    """What an object of the JSON has under a name. Raises ValueError."""
    if not isinstance(tree, dict) or name not in tree:
        raise ValueError(f'the JSON has no "{name}" where one is needed')
    return tree[name]


def finite(part: object) -> float:
    """A number, also as text. Raises ValueError."""
    value = float(part) if isinstance(part, (int, float, str)) else math.nan
    if not math.isfinite(value):
        raise ValueError(f"{part} is no finite number")
    return value


def metres(part: object) -> float:
    """A coordinate that a world can have. Raises ValueError."""
    value = finite(part)
    if abs(value) > MAX_METRES:
        raise ValueError(f"no place is beyond {MAX_METRES:g} m, and {part} is")
    return value
