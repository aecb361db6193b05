"""When it is sane to go on after a crash."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

Limit = Annotated[float, Meta(ge=0.0)]


class ResumeParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[resume]` of a platform file: how old a journal may be, and how far the robot may be from where it was left."""

    max_age_s: Limit = 600.0
    max_distance_m: Limit = 1.0
    max_turn_deg: Limit = 30.0
