"""How long the fuzz tests look: some seconds with the same cases each time, or FUZZ_FACTOR times as long with new ones."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

FACTOR = int(os.environ.get("FUZZ_FACTOR", "1"))


def effort(examples: int) -> settings:
    """Settings for a test with so many examples in the usual run."""
    return settings(max_examples=examples * FACTOR, deadline=None, derandomize=FACTOR == 1, suppress_health_check=[HealthCheck.too_slow])
