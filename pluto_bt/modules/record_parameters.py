"""The parameters of the black box."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta


class RecordParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The table `[record]` of a platform file."""

    limit_mb: Annotated[float, Meta(ge=1.0, description="how large a black box may grow (MiB); then its oldest and bulkiest data go")] = 256.0
    thinned_period_s: Annotated[float, Meta(ge=0.0, description="time between two samples of a topic that no leaf reads")] = 1.0
