"""The whole robot in lockstep without a mission: raw commands in at any link, the truth out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.run_options import Options
from pluto_bt.runtime.clock import NS, VirtualClock
from pluto_bt.system import System

CHAIN = ("motion", "avoid", "drive", "filter")


class WholeRobot:
    """`level`: the link that takes the commands; those above it are stopped."""

    def __init__(
        self, world: World, platform: str, start: tuple[float, float, float], seed: int = 0, level: str = "drive", settings: Sequence[str] = ()
    ) -> None:
        self.system = System(Options(world=world, robot=load_robot_file(platform, settings), start=start, seed=seed), VirtualClock())
        self.system.start_parts()
        self.system.scheduler.start()
        for link in CHAIN[: CHAIN.index(level)]:
            self.system.order_module(link, False)
        self.level = level
        self.run(0.7)  # the gyro learns its bias, the first scan arrives

    @property
    def now_s(self) -> float:
        return self.system.clock.now_s()

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
        """Let time pass."""
        self.system.scheduler.run_until(self.system.clock.now_ns() + round(seconds * NS), lambda: not until())  # type: ignore[union-attr]

    def order(self, speed_mps: float, turn_rate_radps: float, flags: int = 0) -> str:
        command = ActuatorState(self.now_s, flags, (0.0, 0.0), (float(speed_mps), float(turn_rate_radps)))
        return self.system.inboxes[self.level].post("tester", command)

    def drive(self, speed_mps: float, turn_rate_radps: float, seconds: float) -> None:
        """Command and let time pass; at the level of the filter commands must come again and again."""
        if self.level == "drive":
            self.order(speed_mps, turn_rate_radps)
            self.run(seconds)
            return
        for _ in range(round(seconds / 0.05)):
            self.order(speed_mps, turn_rate_radps)
            self.run(0.05)

    def value(self, topic: str) -> Any:
        sample = self.system.board.newest(topic)
        return None if sample is None else sample.value

    @property
    def verdict(self) -> Any:
        return self.value("filter/status")

    @property
    def commanded(self) -> tuple[float, float]:
        """What the base was told last."""
        sample = self.value("ATRV2/Drive/Command")
        return (0.0, 0.0) if sample is None else sample.velocity


def cluttered(rng: np.random.Generator, free_m: float) -> World:
    """A fenced square with posts, crates and walls that stick out; the middle is free for `free_m`."""
    shapes = [Shape("fence", "wall", np.array([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0), (-5.0, -5.0)]))]
    while len(shapes) < 22:
        x, y, size = rng.uniform(-4.5, 4.5), rng.uniform(-4.5, 4.5), rng.uniform(0.05, 0.5)
        kind, name = ("circle", "polygon", "wall")[rng.integers(3)], f"s{len(shapes)}"
        if np.hypot(x, y) < free_m + 1.5 * size:
            continue
        turn = rng.uniform(0.0, np.pi)
        along, across = size * np.array([np.cos(turn), np.sin(turn)]), 0.5 * size * np.array([-np.sin(turn), np.cos(turn)])
        at = np.array([x, y])
        if kind == "circle":
            shapes.append(Shape(name, "circle", at.reshape(1, 2), size))
        elif kind == "polygon":
            shapes.append(Shape(name, "polygon", np.array([at + along, at + across, at - along, at - across])))
        else:
            shapes.append(Shape(name, "wall", np.array([at + along, at - along])))
    return World("clutter", shapes=tuple(shapes))
