"""The shipped platform files: one TOML a robot, with the source of every figure. The tables are declared in `pluto_bt.maps.platform`."""
