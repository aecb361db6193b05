"""The rows of the sub-shells: `wrist point 30 10`, or `wrist` and then `point 30 10`."""

from __future__ import annotations

from pluto_bt.gateway.shell import asking, by_hand, raw
from pluto_bt.gateway.shell.arguments import choice, number, whole
from pluto_bt.gateway.shell.driving import node
from pluto_bt.gateway.shell.row import Row

LINKS = {"drive": "drive", "avoid": "avoidance", "motion": "motion"}  # module → its name on the wire and in topics
STATES = {  # sub-shell → the topics that its `state` shows
    "sick": ("sick/rwi181", "sick/scan", "sick/timing"),
    "wrist": ("wrist/state", "wrist/command"),
    "loc": ("Localization/Pose", "Localization/Check"),
    "dmu": ("dmu/raw", "dmu/state"),
    "imu": ("imu/state", "imu/alarms"),
    "compass": ("compass/state",),
    "gps": ("gps/state",),
    "sonar": ("ATRV2/Sonar",),
    "bumper": ("ATRV2/Bumper",),
    "battery": ("ATRV2/Battery",),
    "base": ("ATRV2/Drive/Raw", "ATRV2/Drive/Command"),
    "arm": ("arm/state",),
    "weather": ("weather/state",),
    "gas": ("gas/state",),
    "pose": ("pose/status",),
    "slam": ("slam/status",),
    "car": ("car/marker", "car/speed"),
}
MODULES = ("sick", "wrist", "dmu", "imu", "compass", "gps", "arm", "pose", "slam")  # sub-shells that are modules of the same name

X, Y, DEG = number("X", "m", low=-1e6, high=1e6), number("Y", "m", low=-1e6, high=1e6), number("DEG", "°")
MPS, TOP_MPS, DPS = number("MPS", "m/s"), number("MPS", "m/s", 0.3, 0.01, 2.0), number("DPS", "°/s, to the left positive")
FOR, FORCE = number("SECONDS", "s", 4.0, 0.0, 3600.0), number("FORCE", default=1.0, low=0.0)
B, H = number("B", "m", low=0.0), number("H", "m", low=0.0)
HOME = (number("X", "m", 0.0, -1e6, 1e6), number("Y", "m", 0.0, -1e6, 1e6), number("DEG", "°", 0.0))
PAN, TILT, RATE = number("PAN", "°, to the left positive"), number("TILT", "°, down positive"), number("DPS", "°/s", None, 0.1)
SWEEP = (number("PAN", "°", None, 0.0, 180.0), number("TILT", "°", None, 0.0, 90.0), whole("ROUNDS", None, 1, 1000))


def _link(shell: str, target: str) -> tuple[Row, ...]:
    """What every link of the command chain understands."""
    return (
        Row("velocity", (MPS, DPS, FOR), "cmdFlags T = 0: this speed and turn rate for so long", raw.velocity(target), True, shell),
        Row("heading", (MPS, DEG, FOR), "cmdFlags T = 1: this speed, holding this angle", raw.heading(target), True, shell),
        Row("release", (), "cmdFlags -1: stop its thread, so that the link below can be commanded", raw.release(target), True, shell),
        Row("state", (), "its status, and the command it accepted last", asking.state_of(f"{target}/status", f"{target}/command"), False, shell),
        Row("start", (), "start its thread again", asking.module("start", shell), False, shell),
    )


MODULE_ROWS: tuple[Row, ...] = (
    *_link("drive", LINKS["drive"]),
    Row("keys", (TOP_MPS,), "the arrow keys", by_hand.drive, True, "drive"),
    *_link("avoid", LINKS["avoid"]),
    Row("goto", (X, Y, TOP_MPS, FORCE), "cmdFlags T = 2; FORCE above 1 makes avoidance weaker", raw.goto("avoidance"), True, "avoid"),
    Row("wall", (TOP_MPS, FOR), "cmdFlags T = 3: along the wall on the left", raw.wall("avoidance"), True, "avoid"),
    *_link("motion", LINKS["motion"]),
    Row("rectangle", (B, H, *HOME), "cmdFlags 46: the rectangle and its home; B = 0 removes it", node("SetRectangle", "rectangle=2", "home=3"), True, "motion"),
    Row("resume", (), "cmdFlags 45: go on with the job that was stopped", node("Resume"), True, "motion"),
    *(Row("state", (), f"the newest of {', '.join(topics)}", asking.state_of(*topics), False, shell) for shell, topics in STATES.items()),
    *(Row("start", (), "start its thread", asking.module("start", shell), False, shell) for shell in MODULES),
    Row("point", (PAN, TILT, RATE), "point the laser", node("PointWrist", "pan_deg", "tilt_deg", "rate_dps"), True, "wrist"),
    Row("home", (), "point the laser straight ahead", node("PointWrist"), True, "wrist"),
    Row("sweep", SWEEP, "sweep the laser to both sides and down", node("SweepWrist", "pan_deg", "tilt_deg", "rounds"), True, "wrist"),
    Row("unfold", (), "unfold the arm", node("UnfoldArm"), True, "arm"),
    Row("fold", (), "fold the arm", node("UnfoldArm", folded="true"), True, "arm"),
    Row("get", (choice("INTERFACE", tuple("01234")),), "one of the five pose interfaces", asking.pose_interface, False, "loc"),
    Row("set", (X, Y, DEG), "tell the robot where it is", node("SetPose", "pose=3"), True, "loc"),
)
