"""Which parameters can be changed while the robot runs, and what must hold between two of them.

The parts that take a change have a method `tune`. What stops the robot (table [filter], ages of readings, time-outs) is not here: it is
set before the robot moves. Nor is what the size of a grid or the time of a step follows from.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import msgspec

LIVE: dict[str, tuple[str, ...]] = {
    "drive": ("max_speed_mps", "max_turn_rate_dps", "acceleration_mps2", "deceleration_mps2", "sonar_margin_m", "blind_speed_mps"),
    "avoid": (
        "memory_s", "walker_memory_s", "margin_m", "moving_margin_m", "blind_speed_mps", "goto_speed_mps", "goto_tolerance_m",
        "stuck_after_s", "blocked_after_s", "back_off_m",
    ),
    "wall": ("camera_back_m", "camera_side_m", "distance_m", "opening_m", "fillet_m", "look_m", "lost_m", "stuck_after_s"),
    "motion": (
        "max_rectangle_m", "speed_mps", "near_goal_m", "tolerance_m", "edge_m", "opening_m", "largest_object_m", "object_reach_m", "circle_radius_m",
    ),
    "plan": ("room_m", "ahead_m", "stuck_after_s"),
}  # fmt: skip
NAMES = frozenset(f"{table}.{name}" for table, names in LIVE.items() for name in names)


class Rule(NamedTuple):
    """`low` must not be above `high`."""

    low: str
    high: str
    why: str


RULES = (
    Rule("drive.max_speed_mps", "limits.max_speed_mps", "the motors do no more"),
    Rule("drive.max_turn_rate_dps", "limits.max_turn_rate_dps", "the motors do no more"),
    Rule("drive.acceleration_mps2", "limits.acceleration_mps2", "the motors do no more"),
    Rule("drive.deceleration_mps2", "limits.deceleration_mps2", "the motors do no more"),
    Rule("avoid.goto_speed_mps", "limits.max_speed_mps", "the motors do no more"),
    Rule("motion.speed_mps", "limits.max_speed_mps", "the motors do no more"),
    Rule("avoid.margin_m", "avoid.moving_margin_m", "what moves needs at least the room of what stands"),
    Rule("avoid.blocked_after_s", "avoid.stuck_after_s", "who cannot move comes no nearer either"),
    Rule("motion.tolerance_m", "motion.near_goal_m", "a goal that is reached is near"),
    Rule("plan.gap_m", "plan.room_m", "a way that is taken only in need is the narrower one"),
    Rule("plan.room_m", "plan.wide_m", "a wide way is the wider one"),
    Rule("wall.lost_m", "wall.look_m", "what is lost is still looked for"),
)


def value_of(robot: msgspec.Struct, name: str) -> Any:
    """The value of a dotted name; None below a table that is absent."""
    found: Any = robot
    for part in name.split("."):
        found = getattr(found, part, None)
    return found


def broken_rules(robot: msgspec.Struct, changed: frozenset[str]) -> list[Rule]:
    """The rules that a changed parameter has broken."""
    return [rule for rule in RULES if changed & {rule.low, rule.high} and value_of(robot, rule.low) > value_of(robot, rule.high)]
