"""What counts as a number in the map and world files that people write."""

from __future__ import annotations

import re

MAX_METRES = 1e6  # of any coordinate; beyond, centimetres are lost in the rounding
NUMBER = re.compile(r"[-+]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eE][-+]?[0-9]{1,3})?")
