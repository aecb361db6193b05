"""What a run came to: the object of `--json` (DESIGN.md, section 4)."""

from __future__ import annotations

from collections import deque
from typing import Any

import msgspec

EXIT_CODES = {"SUCCESS": 0, "FAILURE": 1, "STOPPED": 1, "REFUSED": 2}
SUPERVISION = ("leaf-error", "module-error", "hung", "base-lost")
INTERRUPTED = "interrupted"


class RunResult(msgspec.Struct, kw_only=True):
    """The outcome of one run. Poses are [x m, y m, theta rad] in the map frame.

    Attributes:
        result: SUCCESS, FAILURE, STOPPED or REFUSED.
        reason: why, in one word; empty on SUCCESS.
        sim_time_s: how long the run lasted by its own clock.
        wall_time_s: from the first to the last step.
        ticks: of the mission's tree.
        distance_m: the way that the robot really drove.
        collisions: contacts of the outline with a speed of its own towards them of more than 0.05 m/s.
        hit_by: the other contacts: who walked into the robot, and what it touched itself at 0.05 m/s or slower.
        min_clearance_m: the least distance of the outline from anything solid; null if there is nothing.
        final_pose: where the robot really stood at the end.
        estimated_pose: where it believed to stand.
        trace_sha256: of the trace (`--trace`); equal for equal runs.
        leaves: path of each leaf -> its last status.
        blackboard: the mission's root entries at the end.
        faults: of the files; of a run that was not refused, its warnings.
        contracts: how each contract of the mission has stood.
        contacts: each collision and hit: when, where, with what.
        text: the reason in a sentence.
        seed: of all randomness.
        mission: its file.
        world: its name.
        platform: the robot's name.
    """

    result: str
    reason: str = ""
    sim_time_s: float = 0.0
    wall_time_s: float = 0.0
    ticks: int = 0
    distance_m: float = 0.0
    collisions: int = 0
    hit_by: int = 0
    min_clearance_m: float | None = None
    final_pose: tuple[float, float, float] | None = None
    estimated_pose: tuple[float, float, float] | None = None
    trace_sha256: str = ""
    leaves: dict[str, str] = {}
    blackboard: dict[str, Any] = {}
    faults: list[dict[str, str | int]] = []
    contracts: list[dict[str, Any]] = []
    contacts: list[dict[str, Any]] = []
    text: str = ""
    seed: int = 0
    mission: str = ""
    world: str = ""
    platform: str = ""

    @property
    def exit_code(self) -> int:
        """The exit code of `pluto run`."""
        if self.result == "STOPPED" and self.reason == INTERRUPTED:  # a leaf of a user's may fail with any word
            return 130
        if self.result == "STOPPED" and self.reason in SUPERVISION:
            return 3
        return EXIT_CODES[self.result]

    def as_json(self) -> str:
        """One line of JSON; queues stand as lists, other blackboard values that JSON does not know as text."""
        return msgspec.json.encode(self, enc_hook=lambda value: list(value) if isinstance(value, deque) else str(value)).decode()
