"""Table [filter] of a platform file."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from pluto_bt.maps.platform import NotNegative, Positive


class FilterParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the stop filter sees, how near it lets the robot come, and how old its readings may be."""

    enabled: Annotated[bool, Meta(description="false lets every finite command through; latch and age of commands still hold")] = True
    margin_m: Annotated[NotNegative, Meta(description="distance kept from what is seen, beyond the bumpers' depth and 1 cm, at a standstill")] = 0.01
    margin_s: Annotated[NotNegative, Meta(description="and so many metres more for each m/s of the outline, up to 0.1 m")] = 0.1
    creep_mps: Annotated[NotNegative, Meta(description="how fast the outline may move into what was never seen")] = 0.045
    assumed_clear_m: Annotated[NotNegative, Meta(description="who starts the robot has left it so much room on all sides")] = 0.3
    free_memory_s: Annotated[Positive, Meta(description="how long what was seen to be free counts as known")] = 60.0
    obstacle_memory_s: Annotated[Positive, Meta(description="how long an obstacle is remembered that is not looked at any more")] = 30.0
    fleeting_memory_s: Annotated[Positive, Meta(description="the same for an echo where the sonar had just heard nothing")] = 3.0
    walker_memory_s: Annotated[NotNegative, Meta(description="how long who walked out of view is reckoned with")] = 30.0
    starter_s: Annotated[NotNegative, Meta(description="so long after its start somebody is about: who started it")] = 0.0
    walker_gap_s: Annotated[Positive, Meta(description="nobody walked in where it was seen to be free so short a time ago")] = 0.5
    stranger_gap_s: Annotated[Positive, Meta(description="the same for somebody whom no sensor found, while others walk about")] = 0.6
    hear_m: Annotated[Positive, Meta(description="echoes farther than this are not used")] = 2.5
    laser_stale_s: Annotated[NotNegative, Meta(description="older scans mean zero velocity; 0 = the laser's delay and 1.25 periods")] = 0.0
    laser_holes: Annotated[float, Meta(ge=0, le=1, description="share of beams without a usable number above which a scan is not trusted")] = 0.25
    without_laser_mps: Annotated[NotNegative, Meta(description="speed while the laser cannot be trusted")] = 0.0
    sonar_stale_s: Annotated[Positive, Meta(description="older echoes do not count")] = 0.35
    without_sonar_mps: Annotated[NotNegative, Meta(description="speed while the sonar cannot be trusted")] = 0.3
    bumper_stale_s: Annotated[Positive, Meta(description="older bumper readings mean zero velocity")] = 0.35
    odometry_stale_s: Annotated[Positive, Meta(description="older odometry, or an older pose, means zero velocity")] = 0.25
    wheels_still_s: Annotated[Positive, Meta(description="wheels told to turn whose encoders stand still so long are stopped")] = 0.3
    retry_s: Annotated[Positive, Meta(description="after so long at rest the wheels may try again")] = 1.0
    command_stale_s: Annotated[Positive, Meta(description="without a command for so long the velocity is zero")] = 0.22
    executive_silent_s: Annotated[Positive, Meta(description="without a step of the executive for so long the velocity is zero")] = 0.23
    area_margin_m: Annotated[
        NotNegative, Meta(description="who has no range sensors keeps his middle so far from the edge of the mapped area; 0: it may be cut on an arc")
    ] = 0.0
    period_s: Annotated[Positive, Meta(description="time between two steps, part of the reaction time that is reckoned with")] = 0.05
