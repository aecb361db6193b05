"""When it is sane to go on after a crash."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta


class ResumeParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[resume]` of a platform file."""

    max_age_s: Annotated[float, Meta(ge=0.0, description="so old a journal may be for the mission to go on")] = 600.0
    max_distance_m: Annotated[float, Meta(ge=0.0, description="so far the robot may be from where it was left")] = 1.0
    max_turn_deg: Annotated[float, Meta(ge=0.0, description="so far it may have been turned meanwhile")] = 30.0
