"""THE table of faults that a world script can cause: which device fails in which way, and what each needs to be told.

`<fault device=… kind=… for=… …/>`: `for` (seconds, 0 or absent = for ever) always goes; the other attributes as the row says.
Checks, documentation and simulator go by this table.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FaultRow:
    """One way in which one device can fail. `needs` must be given, `takes` may be."""

    device: str
    kind: str
    needs: tuple[str, ...]
    takes: tuple[str, ...]
    doc: str


SENSORS = ("laser", "sonar", "bumpers", "odometry", "imu", "compass", "gps", "wrist", "marker", "speed")
BEAMS = ("laser", "sonar")  # devices whose reading is a row of ranges: `beams="first-last"` names the spoilt ones
NAMED = ("module", "leaf")  # written module:NAME, leaf:NAME
ATTRIBUTES = ("value", "rate", "delay", "beams")
UNITS = {  # of `value`
    "laser": "m", "sonar": "m", "bumpers": "0 open, 1 pressed", "odometry": "m driven", "imu": "rad/s", "compass": "rad", "gps": "m",
    "wrist": "rad pan", "marker": "m", "speed": "m/s",
}  # fmt: skip


def _on_sensors(kind: str, doc: str, needs: tuple[str, ...] = (), takes: tuple[str, ...] = (), *, without: tuple[str, ...] = ()) -> list[FaultRow]:
    """The same row for every sensor; those that measure ranges also take `beams` where single ranges can fail."""
    spoils_numbers = kind not in ("off", "frozen", "slow", "late", "drop", "hang")
    with_beams = (*takes, "beams") if spoils_numbers else takes
    return [FaultRow(device, kind, needs, with_beams if device in BEAMS else takes, doc) for device in SENSORS if device not in without]


FAULTS: tuple[FaultRow, ...] = (
    *_on_sensors("off", "no reading arrives"),
    *_on_sensors("hang", "the device stops answering: no reading arrives"),
    *_on_sensors("frozen", "the last reading arrives again and again, with its old stamp"),
    *_on_sensors("stuck", "new stamps, but the numbers stay as they were, or at `value`", takes=("value",)),
    *_on_sensors("nan", "every number is not-a-number (a bumper reads as pressed)"),
    *_on_sensors("garbage", "nonsense, different in every reading"),
    *_on_sensors("wrong", "`value` is added to the reading", needs=("value",), without=("bumpers",)),
    *_on_sensors("bias", "`value` is added to the reading", needs=("value",), without=("bumpers",)),
    *_on_sensors("jump", "from now on readings are off by `value`", needs=("value",), without=("bumpers",)),
    *_on_sensors("noise", "more noise: `value` is its standard deviation", needs=("value",), without=("bumpers",)),
    *_on_sensors("slow", "only `rate` readings arrive a second", needs=("rate",)),
    *_on_sensors("late", "readings arrive `delay` seconds late", needs=("delay",)),
    *_on_sensors("drop", "a share `rate` (0 to 1, all if absent) of the readings is lost", takes=("rate",)),
    FaultRow("laser", "fatal", (), (), "the laser reports a fatal error: −1 in every beam, for 20 s if `for` is absent"),
    FaultRow("wrist", "blocked", (), (), "the wrist does not move"),
    FaultRow("odometry", "slip", (), ("value",), "wheels slip: a share `value` (0 to 1, all if absent) of their motion is lost, yet counted"),
    FaultRow("base", "off", (), (), "the base takes no commands and sends no readings"),
    FaultRow("base", "hang", (), (), "as off"),
    FaultRow("base", "blocked", (), (), "the wheels are held: commands are taken, nothing moves"),
    FaultRow("base", "stuck", (), (), "as blocked"),
    FaultRow("base", "slip", (), ("value",), "as slip of odometry"),
    FaultRow("base", "frozen", (), (), "readings of odometry, sonar, bumpers and battery arrive again and again with old stamps"),
    FaultRow("base", "slow", ("rate",), (), "its readings arrive only `rate` times a second"),
    FaultRow("base", "late", ("delay",), (), "its readings arrive `delay` seconds late"),
    FaultRow("base", "drop", (), ("rate",), "a share `rate` (0 to 1, all if absent) of its readings is lost"),
    FaultRow("module", "off", (), (), "the module is stopped, and started again when the fault ends"),
    FaultRow("module", "raise", (), (), "every step raises an exception"),
    FaultRow("module", "hang", (), (), "the next step never returns: supervision ends the run"),
    FaultRow("module", "slow", (), ("delay",), "every step takes `delay` seconds (0.5 if absent) longer"),
    FaultRow("leaf", "raise", (), (), "update() raises an exception"),
    FaultRow("leaf", "hang", (), (), "update() never returns: supervision ends the run"),
    FaultRow("leaf", "wrong", (), (), "update() returns None"),
)
ROWS: dict[tuple[str, str], FaultRow] = {(row.device, row.kind): row for row in FAULTS}
KINDS: tuple[str, ...] = tuple(dict.fromkeys(row.kind for row in FAULTS))
DEVICES: tuple[str, ...] = tuple(dict.fromkeys(row.device for row in FAULTS))


def kinds_of(device: str) -> tuple[str, ...]:
    """The ways in which a device can fail, in the order of the table."""
    return tuple(row.kind for row in FAULTS if row.device == device)
