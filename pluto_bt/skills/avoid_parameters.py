"""Table [avoid] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from pluto_bt.maps.platform import NotNegative, Positive


class AvoidParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How avoidance sees, how it keeps clear, how its goto drives."""

    reach_m: Annotated[Positive, Meta(description="obstacles nearer than this are looked at (the manual's 3 m)")] = 3.0
    memory_s: Annotated[NotNegative, Meta(description="how long what stands outside the laser's field of view is remembered")] = 30.0
    walker_memory_s: Annotated[NotNegative, Meta(description="how long what walked out of the field of view is remembered")] = 2.0
    sonar_memory_s: Annotated[NotNegative, Meta(description="how long an echo is remembered where the laser is not asked")] = 8.0
    open_echo_memory_s: Annotated[NotNegative, Meta(description="how long an echo that the laser does not explain is remembered beside it")] = 1.0
    margin_m: Annotated[NotNegative, Meta(description="distance kept between the outline and what stands")] = 0.08
    moving_margin_m: Annotated[NotNegative, Meta(description="distance kept from what moves")] = 0.25
    laser_stale_s: Annotated[Positive, Meta(description="a scan taken longer ago than this is not trusted")] = 0.6
    laser_holes: Annotated[float, Meta(ge=0, le=1, description="share of beams without a number above which a scan is not trusted")] = 0.3
    sonar_stale_s: Annotated[Positive, Meta(description="echoes older than this are not trusted")] = 0.5
    pose_stale_s: Annotated[Positive, Meta(description="a pose older than this is not trusted")] = 0.5
    blind_speed_mps: Annotated[NotNegative, Meta(description="fastest backing where no sonar listens behind")] = 0.15
    period_s: Annotated[Positive, Meta(description="time between two steps, part of the reaction time that is reckoned with")] = 0.1
    goto_speed_mps: Annotated[Positive, Meta(description="speed of a goto whose command names none")] = 0.5
    goto_tolerance_m: Annotated[Positive, Meta(description="distance at which a goal counts as reached if the command names none")] = 0.3
    stuck_after_s: Annotated[Positive, Meta(description="a goto that comes no nearer to its goal for so long is stuck")] = 20.0
    blocked_after_s: Annotated[Positive, Meta(description="a goto that cannot move at all for so long is stuck")] = 8.0
    back_off_m: Annotated[NotNegative, Meta(description="how far a wedged goto backs over the ground it came from; 0 = never")] = 0.5
