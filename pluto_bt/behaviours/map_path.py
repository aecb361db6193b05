"""A path that one node plans and another follows."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from pluto_bt.behaviours.destinations import Destination
from pluto_bt.behaviours.pose_text import POSE_PARTS, header_of, member, pose_of_json, pose_of_parts, read_json

Array = NDArray[np.float64]
FRAME: Final = "map"


class MapPath:
    """Poses (n, 3): x m, y m, theta rad in the map, read-only. `ends_turned` = the last heading is to be taken up, else it only shows the way.

    Paths are equal if their poses are. In text points, `1,2;3,4`; or as Nav2's: `stamp;frame`, then `stamp;frame;x;y;z;qx;qy;qz;qw` for each
    pose; or `json:`.
    """

    TEXT_FORM: ClassVar = "points x,y with ';' between, or {key} of a path"
    ANY_ENTRY: ClassVar = True
    __slots__ = ("ends_turned", "frame", "poses", "stamp_ns")

    def __init__(self, poses: Any, stamp_ns: int = 0, frame: str = FRAME, *, ends_turned: bool = False) -> None:
        array = np.array(poses, dtype=np.float64).reshape(-1, 3)
        array.setflags(write=False)
        self.poses: Array = array
        self.stamp_ns, self.frame, self.ends_turned = stamp_ns, frame, ends_turned

    @classmethod
    def empty(cls) -> MapPath:
        """No poses."""
        return cls(())

    @classmethod
    def along(cls, points: Array, end_rad: float | None = None, stamp_ns: int = 0) -> MapPath:
        """A path through points (n, 2), each heading that of the way on; the last one `end_rad` if it is given."""
        if len(points) == 0:
            return cls.empty()
        steps = np.diff(points, axis=0)
        headings = np.arctan2(steps[:, 1], steps[:, 0]) if len(steps) else np.zeros(0)
        last = end_rad if end_rad is not None else headings[-1] if len(headings) else 0.0
        return cls(np.column_stack((points, np.append(headings, last))), stamp_ns, ends_turned=end_rad is not None)

    @classmethod
    def from_text(cls, text: str) -> MapPath:
        """Read any of the forms. Raises ValueError."""
        if text.startswith("json:"):
            tree = read_json(text)
            poses: list[tuple[int, str, float, float, float]] = [pose_of_json(one) for one in _listed(member(tree, "poses"))]
            stamp_ns, frame = header_of(tree)
        elif "," in text:
            return cls.along(np.array([_point(part) for part in text.split(";") if part.strip()]))
        else:
            parts = text.split(";")
            if len(parts) % POSE_PARTS != 2:
                raise ValueError(f"a path is stamp;frame and {POSE_PARTS} parts for each pose, not {len(parts)} parts")
            poses = [pose_of_parts(parts[i : i + POSE_PARTS]) for i in range(2, len(parts), POSE_PARTS)]
            stamp_ns, frame = int(float(parts[0])), parts[1].strip()
        return cls([(x, y, math.radians(theta)) for _, _, x, y, theta in poses], stamp_ns, frame, ends_turned=True)

    @classmethod
    def from_value(cls, value: object) -> MapPath:
        """A list of points that another node wrote. Raises ValueError."""
        if isinstance(value, (list, tuple)) and all(isinstance(one, tuple) and len(one) >= 2 for one in value):
            return cls.along(np.array([one[:2] for one in value], dtype=np.float64).reshape(-1, 2))
        raise ValueError("expected a path")

    def to_text(self) -> str:
        """Nav2's text, in millimetres."""
        poses = (f"0;{self.frame};{x:.3f};{y:.3f};0;0;0;{math.sin(theta / 2):.6f};{math.cos(theta / 2):.6f}" for x, y, theta in self.poses.tolist())
        return ";".join([f"{self.stamp_ns};{self.frame}", *poses])

    @property
    def points(self) -> Array:
        """(n, 2) metres."""
        return self.poses[:, :2]

    @property
    def end(self) -> tuple[float, float]:
        """The last point. Raises IndexError for an empty path."""
        return float(self.poses[-1, 0]), float(self.poses[-1, 1])

    @property
    def length_m(self) -> float:
        """From the first point to the last."""
        return self.left_m(0)

    def left_m(self, index: int) -> float:
        """From a pose to the end."""
        return float(np.hypot(*np.diff(self.points[index:], axis=0).T).sum()) if len(self) > 1 else 0.0

    def nearest(self, x_m: float, y_m: float, first: int = 0, last: int | None = None) -> int:
        """The index of the pose nearest to a point, of those in [first, last)."""
        points = self.points[first:last]
        return first + int(np.argmin(np.hypot(points[:, 0] - x_m, points[:, 1] - y_m)))

    def having(self, poses: Array, *, ends_turned: bool | None = None) -> MapPath:
        """Other poses under the same header."""
        return MapPath(poses, self.stamp_ns, self.frame, ends_turned=self.ends_turned if ends_turned is None else ends_turned)

    def destination(self, index: int) -> Destination:
        """A pose as a goal. Raises IndexError."""
        x, y, theta = self.poses[index].tolist()
        return Destination(x, y, math.degrees(theta), "", self.stamp_ns, self.frame)

    def __len__(self) -> int:
        return len(self.poses)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MapPath) and (self.poses is other.poses or np.array_equal(self.poses, other.poses))

    def __hash__(self) -> int:
        return hash(self.poses.tobytes())

    def __repr__(self) -> str:
        return f"<path of {len(self)} poses, {self.length_m:.1f} m>"


def _point(text: str) -> tuple[float, float]:
    place = Destination.from_text(text)
    if place.name or place.theta_deg is not None:
        raise ValueError(f'"{text}" is no point x,y')
    return place.x_m, place.y_m


def _listed(value: Any) -> Iterable[Any]:
    if not isinstance(value, list):
        raise ValueError("expected a list")
    return value
