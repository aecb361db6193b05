"""Broken platform files: name → (text, the faults as "line:column code")."""

from __future__ import annotations

BODY = """\
name = "cart"
[body]
kinematics = "differential"
outline_m = [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]]
track_m = 0.4
"""
LIMITS = """\
[limits]
max_speed_mps = 0.5
max_turn_rate_dps = 60.0
acceleration_mps2 = 0.5
deceleration_mps2 = 0.5
turn_acceleration_dps2 = 90.0
"""
SOUND = BODY + LIMITS


def with_line(line: int, text: str) -> str:
    """The sound file with one line replaced."""
    lines = SOUND.splitlines()
    lines[line - 1] = text
    return "\n".join(lines) + "\n"


PLATFORMS = {
    "no TOML": ("name = \n", "1:8 toml-syntax"),
    "binary": ("\0\1\2", "1:1 toml-syntax"),
    "empty": ("", "0:0 missing-parameter 0:0 missing-parameter 0:0 missing-parameter"),
    "no body": ('name = "x"\n' + LIMITS, "0:0 missing-parameter"),
    "unknown table": (SOUND + "[wings]\n", "12:2 unknown-parameter"),
    "unknown key": (with_line(5, "track_m = 0.4\ntrak_m = 0.4"), "6:1 unknown-parameter"),
    "missing key": (with_line(5, ""), "2:2 missing-parameter"),
    "wrong type": (with_line(7, 'max_speed_mps = "fast"'), "7:1 bad-value"),
    "NaN": (with_line(7, "max_speed_mps = nan"), "7:1 bad-value"),
    "endless": (with_line(7, "max_speed_mps = inf"), "7:1 bad-value"),
    "below 0": (with_line(7, "max_speed_mps = -1.0"), "7:1 bad-value"),
    "table expected": ("limits = 3\n" + BODY, "1:1 bad-value"),
    "outline of two": (with_line(4, "outline_m = [[0.3, 0.2], [-0.3, 0.2]]"), "4:1 bad-value"),
    "outline crosses itself": (with_line(4, "outline_m = [[0.3, 0.2], [-0.3, -0.2], [-0.3, 0.2], [0.3, -0.2]]"), "4:1 self-crossing"),
    "outline endless": (with_line(4, "outline_m = [[inf, 0.2], [-0.3, 0.2], [-0.3, -0.2]]"), "4:1 bad-value"),
    "car that cannot turn": (with_line(3, 'kinematics = "ackermann"'), "4:1 missing-parameter"),
    "unknown kinematics": (with_line(3, 'kinematics = "hover"'), "3:1 bad-value"),
    "key twice": (with_line(5, "track_m = 0.4\ntrack_m = 0.5"), "6:1 duplicate-key"),
    "nested": ("a = " + "[" * 50_000, "1:37 too-deep"),
    "two at once": (with_line(7, "max_speed_mps = nan").replace("track_m", "trak_m"), "2:2 missing-parameter 5:1 unknown-parameter 7:1 bad-value"),
}  # fmt: skip
