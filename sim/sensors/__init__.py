"""The simulated sensors, one small file each. A sensor has `period_ns` and `sample(now_s) -> Record | None`; it reads the truth it was given."""
