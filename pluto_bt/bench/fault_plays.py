"""What can go wrong with sensors, wheels and base, and a patrol that is watched while it does: used by `pluto bench faults` and by the tests.

A `Play` notes every velocity command of the base and how long the robot stands without anybody saying why.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pluto_bt.behaviours.reasons import REASONS
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.inputs.reading import Inputs
from pluto_bt.maps.script import Action, Carry, FaultAction, Put
from pluto_bt.runner import Runner, make_runner

STILL_MPS, STILL_RADPS = 0.01, 0.02
UNTOLD_S = 1.5  # a robot may stand so long between two commands without a word
EXIT_CODES = {"SUCCESS": 0, "FAILURE": 1, "STOPPED": 3}
Where = tuple[float, float, float]  # x m, y m, theta rad

# name → what happens, for so many seconds (0 = for ever); a carried robot is set down at `where`
CAUSES: dict[str, Callable[[float, Where], Action]] = {
    "laser off": lambda for_s, where: FaultAction("laser", "off", for_s),
    "laser frozen": lambda for_s, where: FaultAction("laser", "frozen", for_s),
    "laser stuck": lambda for_s, where: FaultAction("laser", "stuck", for_s),
    "laser NaN": lambda for_s, where: FaultAction("laser", "nan", for_s),
    "half the beams": lambda for_s, where: FaultAction("laser", "nan", for_s, beams=(0, 180)),
    "laser 2 Hz": lambda for_s, where: FaultAction("laser", "slow", for_s, rate=2.0),
    "laser 400 ms late": lambda for_s, where: FaultAction("laser", "late", for_s, delay_s=0.4),
    "laser fatal": lambda for_s, where: FaultAction("laser", "fatal", 20.0),
    "sonar stuck at 8 m": lambda for_s, where: FaultAction("sonar", "stuck", for_s, value=8.0),
    "sonar stuck at 0": lambda for_s, where: FaultAction("sonar", "stuck", for_s, value=0.0),
    "bumper stuck": lambda for_s, where: FaultAction("bumpers", "stuck", for_s, value=1.0),
    "odometry frozen": lambda for_s, where: FaultAction("odometry", "frozen", for_s),
    "odometry stuck": lambda for_s, where: FaultAction("odometry", "stuck", for_s),
    "wheel slip": lambda for_s, where: FaultAction("base", "slip", for_s, value=1.0),
    "a little slip": lambda for_s, where: FaultAction("base", "slip", for_s, value=0.3),
    "gyro jump": lambda for_s, where: FaultAction("imu", "jump", for_s, value=0.3),
    "small gyro jump": lambda for_s, where: FaultAction("imu", "jump", for_s, value=-0.03),
    "odometry jump": lambda for_s, where: FaultAction("odometry", "jump", for_s, value=2.0),
    "base blocked": lambda for_s, where: FaultAction("base", "blocked", for_s),
    "kidnapped": lambda for_s, where: Carry(*where),
    "wrist off by 17 deg": lambda for_s, where: FaultAction("wrist", "jump", for_s, value=0.3),
    "a crate in the way": lambda for_s, where: Put("surprise", where[0], where[1]),
}  # fmt: skip


class Play:
    """One run of a mission.

    Attributes:
        commands: (t s, speed m/s, turn rate rad/s) each time the base is told something new.
        untold_s: the longest time that it was told to stand while the mission drove, without a reason in `motion/status`.
        words: every reason that `motion/status` gave, in order of first appearance.
    """

    def __init__(
        self, inputs: Inputs, max_time_s: float, before: Callable[[Runner], None] = lambda runner: None, record: Path | None = None
    ) -> None:
        """`before`: something to arrange before the run begins. `record`: where the black box goes."""
        self.events: list[Any] = []
        self.runner: Runner = make_runner(inputs, max_time_s=max_time_s, on_event=self.events.append, record=record)
        self.commands: list[tuple[float, float, float]] = []
        self.words: dict[str, float] = {}
        self.codes: dict[int, float] = {}
        self.untold_s = 0.0
        self._stood_s: float | None = None
        board = self.runner.system.board
        board.on_change("ATRV2/Drive/Command", self._note_command)
        board.on_change("motion/status", self._note_status)
        before(self.runner)
        self.result = self.runner.run()

    def _note_command(self) -> None:
        sample = self.runner.system.board.newest("ATRV2/Drive/Command")
        if sample is not None and isinstance(sample.value, ActuatorState):
            self.commands.append((self.runner.system.clock.now_s(), *sample.value.velocity))

    def _note_status(self) -> None:
        sample, now_s = self.runner.system.board.newest("motion/status"), self.runner.system.clock.now_s()
        if sample is None or not isinstance(sample.value, FVectorState):
            return
        status = sample.value
        self.codes.setdefault(status.element[0], now_s)
        if status.reason:
            self.words.setdefault(status.reason, now_s)
        wants_to_move = status.element[1] == -1  # a goto is running
        stands = abs(status.data[0]) < STILL_MPS and abs(status.data[1]) < STILL_RADPS
        if not (wants_to_move and stands) or status.reason or status.text:
            self._stood_s = None
            return
        self._stood_s = now_s if self._stood_s is None else self._stood_s
        self.untold_s = max(self.untold_s, now_s - self._stood_s)

    def zero_after_s(self, from_s: float) -> float:
        """Seconds from a moment until the base was first told to stand; infinite if it never was."""
        return next((t - from_s for t, v, w in self.commands if t >= from_s and v == w == 0.0), math.inf)

    def error_m(self) -> float:
        """How far the robot is from where it believes to be."""
        believed = self.result.estimated_pose
        return math.inf if believed is None else math.dist(believed[:2], self.runner.system.simulator.pose[:2])

    def complaints(self, most_error_m: float) -> list[str]:
        """What must never be, whatever breaks; empty if all is well."""
        result, found = self.result, list[str]()
        if result.collisions:
            found.append(f"{result.collisions} collisions")
        if result.result != "SUCCESS" and result.reason not in REASONS:
            found.append(f'"{result.reason}" is no documented reason')
        if result.result != "SUCCESS" and not result.text:
            found.append("nobody says why it ended")
        if result.result == "SUCCESS" and self.error_m() > most_error_m:
            found.append(f"it claims success {self.error_m():.2f} m from where it is")
        if EXIT_CODES.get(result.result) != result.exit_code and result.reason != "max-time":
            found.append(f"exit code {result.exit_code} for {result.result}")
        if self.untold_s > UNTOLD_S:
            found.append(f"it stood for {self.untold_s:.1f} s without a word")
        if any(abs(rate) > 1e-3 for rate in self.runner.system.simulator.velocity):
            found.append("it still moves after the end")
        return found
