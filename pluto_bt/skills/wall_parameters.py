"""Table [wall] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from pluto_bt.maps.platform import NotNegative, Positive


class WallParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The camera that wall follow holds before the wall, and what counts as wall. For a wall on the right the camera is taken to the right."""

    camera_back_m: Annotated[float, Meta(description="how far behind the reference point the camera is held")] = 0.45
    camera_side_m: Annotated[float, Meta(description="how far to the left of it")] = 0.65
    distance_m: Annotated[Positive, Meta(description="distance between camera and wall if the command names none")] = 0.8
    opening_m: Annotated[Positive, Meta(description="doors and gaps that are narrower than this are passed by")] = 1.8
    fillet_m: Annotated[NotNegative, Meta(description="radius of the robot's path in inner corners")] = 0.1
    look_m: Annotated[Positive, Meta(description="a wall that is farther away is not found")] = 4.0
    lost_m: Annotated[Positive, Meta(description="what is suddenly so much farther away is another wall")] = 1.0
    stuck_after_s: Annotated[Positive, Meta(description="without progress along the wall for so long the robot is stuck")] = 40.0
