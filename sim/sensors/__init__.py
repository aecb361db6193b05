"""The simulated sensors, one small file each. A sensor has `period_ns`, `delay_s` and `sample(now_s) -> Record`; it reads the truth it was given."""
