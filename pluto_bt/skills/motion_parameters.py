"""Table [motion] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from pluto_bt.maps.platform import NotNegative, Positive


class MotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How motion sees, which paths it takes, how it explores and investigates."""

    max_rectangle_m: Annotated[Positive, Meta(description="a rectangle with a longer side is refused")] = 10_000.0
    speed_mps: Annotated[Positive, Meta(description="speed of a job whose command names none")] = 0.5
    path_half_width_m: Annotated[Positive, Meta(description="a path is open if so much is free on either side: 1.5 m outdoors (manual)")] = 1.5
    wide_half_width_m: Annotated[Positive, Meta(description="farther from the sides the middle of the street matters no more")] = 5.0
    side_gap_m: Annotated[NotNegative, Meta(description="the narrowest way that is tried leaves so much on either side of the outline")] = 0.25
    look_m: Annotated[Positive, Meta(description="ranges farther than this are not entered into the map")] = 20.0
    join_m: Annotated[NotNegative, Meta(description="neighbouring beams that end nearer to each other than this see one wall")] = 1.0
    near_goal_m: Annotated[Positive, Meta(description="from this distance on, with a free way, moveto is a simple goto")] = 4.0
    tolerance_m: Annotated[Positive, Meta(description="distance at which a goal counts as reached")] = 0.3
    edge_m: Annotated[NotNegative, Meta(description="paths keep so far inside the rectangle")] = 0.5
    home_depth_m: Annotated[NotNegative, Meta(description="home lies on the edge: explore comes home to so far inside of it")] = 0.2
    opening_m: Annotated[Positive, Meta(description="a side that lies so much deeper than before is an opening")] = 4.0
    ground_look_m: Annotated[Positive, Meta(description="how far a scan that looks down is believed about the ground")] = 6.0
    ground_step_m: Annotated[Positive, Meta(description="smallest step up or down that is an obstacle")] = 0.05
    ground_memory_s: Annotated[Positive, Meta(description="how long low obstacles and holes are remembered")] = 120.0
    coverage_m: Annotated[Positive, Meta(description="explore counts as explored what was seen from so near")] = 5.0
    largest_object_m: Annotated[Positive, Meta(description="what is larger is no object to investigate")] = 4.0
    object_reach_m: Annotated[Positive, Meta(description="objects farther away are not looked for")] = 15.0
    circle_radius_m: Annotated[Positive, Meta(description="radius of investigate if the command names none")] = 2.5
