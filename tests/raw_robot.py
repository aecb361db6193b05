"""A whole simulated robot that a test commands by hand, as the gateway does: raw commands to any link, modules, stops."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from pluto_bt.blackboard.messages import ActuatorState, FVectorState, Pair
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import Runner, make_runner
from pluto_bt.runtime.clock import NS

WAIT = '<root BTCPP_format="4"><BehaviorTree ID="wait"><Sleep msec="100000000"/></BehaviorTree></root>'
STATUS = {"motion": "motion/status", "avoid": "avoidance/status", "drive": "drive/status"}
NONE: Pair = (0.0, 0.0)


class RawRobot:
    """Its mission only waits. `codes` are the different (element[2], element[3]) that motion has shown since the last order, `links` the
    different (element[0], element[1])."""

    def __init__(self, folder: Path, world: str, seed: int = 1) -> None:
        (folder / "wait.xml").write_text(WAIT, encoding="utf-8")
        (folder / "world.xml").write_text(world, encoding="utf-8")
        inputs = read_inputs(Request(str(folder / "wait.xml"), world=str(folder / "world.xml"), seed=str(seed)))
        self.runner: Runner = make_runner(inputs)
        self.system = self.runner.system
        self.codes: list[tuple[int, ...]] = []
        self.links: list[tuple[int, ...]] = []
        self.deepest = math.inf  # how far inside the rectangle the robot really was at the worst
        self.system.board.on_change("motion/status", self._note)
        self.system.executive.core.start(self.runner.mission)
        self.system.start_parts()
        self.system.scheduler.start()
        self.system.scheduler.run_until(NS // 2)

    @property
    def now_s(self) -> float:
        return self.system.clock.now_s()

    @property
    def status(self) -> FVectorState:
        return self.status_of("motion")

    def status_of(self, link: str) -> FVectorState:
        """The newest status of motion, avoid or drive."""
        sample = self.system.board.newest(STATUS[link])
        assert sample is not None and isinstance(sample.value, FVectorState)
        return sample.value

    @property
    def pose(self) -> tuple[float, float, float]:
        """The true one."""
        return self.system.simulator.pose

    @property
    def velocity(self) -> Pair:
        """The true one."""
        return self.system.simulator.velocity

    def post(self, flags: int, position: Pair = NONE, velocity: Pair = NONE, force: tuple[float, ...] = (0.0,), to: str = "motion") -> str:
        """Post to a link; gives "" or why it is refused. The codes shown so far are forgotten."""
        self.codes.clear()
        self.links.clear()
        return self.system.inboxes[to].post("operator", ActuatorState(self.now_s, flags, position, velocity, NONE, force))

    def order(self, flags: int, position: Pair = NONE, velocity: Pair = NONE, force: tuple[float, ...] = (0.0,)) -> None:
        """Post to motion, which must take it."""
        assert self.post(flags, position, velocity, force) == ""

    def module(self, name: str, run: bool) -> None:
        """Start or stop a module, and let it happen."""
        self.system.order_module(name, run)
        self.run(0.2)

    def run(self, seconds: float, until: Any = lambda: False) -> bool:
        """Let time pass; True as soon as `until` holds."""
        end_ns = self.system.clock.now_ns() + round(seconds * NS)
        while self.system.clock.now_ns() < end_ns:
            self.system.scheduler.run_until(self.system.clock.now_ns() + NS // 10)
            rectangle = self.system._parts["motion"].component._skill.rectangle
            if rectangle is not None:
                self.deepest = min(self.deepest, rectangle.depth_m(*self.pose[:2]))
            if until():
                return True
        return False

    def is_at_rest(self) -> bool:
        """No job is at work."""
        return self.status.element[3] in (0, -1)

    def _note(self) -> None:
        element = self.status.element
        for shown, code in ((self.codes, element[2:]), (self.links, element[:2])):
            if not shown or shown[-1] != code:
                shown.append(code)
