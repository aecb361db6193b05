"""Table [plan] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from pluto_bt.maps.platform import NotNegative, Positive


class PlanParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How ways are planned on the map and followed."""

    gap_m: Annotated[NotNegative, Meta(description="the narrowest way that is planned leaves so much on either side of the outline")] = 0.15
    room_m: Annotated[NotNegative, Meta(description="a way with less than this beside the outline is taken only to save a long detour")] = 0.35
    wide_m: Annotated[NotNegative, Meta(description="more than this beside the outline is no better")] = 1.0
    ahead_m: Annotated[Positive, Meta(description="the robot is steered to a point so far ahead on its way")] = 2.0
    seen_cell_m: Annotated[Positive, Meta(description="side of a cell of the memory of what stands in the way")] = 0.1
    stuck_after_s: Annotated[Positive, Meta(description="who has not come on along his way for so long is stuck")] = 12.0
