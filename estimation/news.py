"""What the cross-check of gyro, wheels and laser has to say: a word and a sentence."""

from __future__ import annotations

from typing import NamedTuple

GYRO_DRIFT, GYRO_REFUSED, WHEEL_SLIP, WHEELS_GRIP = "gyro-drift", "gyro-refused", "wheel-slip", "wheels-grip"
LOST, FOUND = "lost", "found"


class News(NamedTuple):
    """A new finding; `word` is one of the above."""

    word: str
    text: str
