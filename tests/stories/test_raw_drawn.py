"""Raw commands, stops and module orders drawn at random, in drawn places with drawn faults: whatever is posted, the promises of the chain hold."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pluto_bt.runtime.latch import OPERATOR_STOP
from tests.raw_robot import RawRobot

WORLD = """<world name="drawn" seed="{seed}"><wall id="fence">-14,-9 14,-9 14,9 -14,9 -14,-9</wall>{parts}
  <robot platform="{platform}" x="-10" y="0" theta_deg="{theta_deg}"/> <script>{script}</script></world>"""
LISTED = ({0, -1, -10, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, -1, -10}, {0, -1, -2, 1, 2}, {0, -1, -10, 1, 3, 11, 12})  # element[0..3] of motion
FAULTS = [("laser", "fatal", ""), ("laser", "nan", ' for="4"'), ("sonar", "off", ' for="5"'), ("bumpers", "stuck", ' value="1" for="3"'),
          ("odometry", "off", ' for="1"'), ("base", "blocked", ' for="4"')]  # fmt: skip
STEPS = 40


class Drawn:
    """One robot and the hand that posts to it."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.rng = np.random.default_rng((seed, 8))
        self.done: list[str] = []
        g = self.rng
        parts = "".join(f'<circle id="c{i}" x="{x:.2f}" y="{y:.2f}" r="{r:.2f}"/>' for i, (x, y, r) in enumerate(self._discs(int(g.integers(2, 8)))))
        script = "".join(f'<at t="{g.uniform(5, 100):.1f}"><fault device="{d}" kind="{k}"{more}/></at>' for d, k, more in self._some_faults())
        platform = ("atrv2", "pioneer")[seed % 2]
        world = WORLD.format(seed=seed, parts=parts, platform=platform, theta_deg=int(g.integers(-180, 180)), script=script)
        self.robot = RawRobot(folder, world, seed)

    def act(self) -> None:
        """Do one thing, and let some time pass."""
        kinds: list[Callable[[], None]] = [self._simple, self._simple, self._job, self._job, self._module, self._stop, self._start_all]
        kinds[int(self.rng.integers(len(kinds)))]()

    def _discs(self, count: int) -> list[tuple[float, float, float]]:
        return [(float(self.rng.uniform(-7, 12)), float(self.rng.uniform(-8, 8)), float(self.rng.uniform(0.1, 0.6))) for _ in range(count)]

    def _some_faults(self) -> list[tuple[str, str, str]]:
        return [FAULTS[int(self.rng.integers(len(FAULTS)))] for _ in range(int(self.rng.integers(0, 3)))]

    def _point(self) -> tuple[float, float]:
        return float(self.rng.uniform(-13, 13)), float(self.rng.uniform(-8, 8))

    def _run(self, least_s: float, most_s: float) -> None:
        self.robot.run(float(self.rng.uniform(least_s, most_s)), self._looks_right)

    def _simple(self) -> None:
        g, r = self.rng, self.robot
        kind, to = int(g.integers(0, 3)), str(g.choice(["motion", "motion", "avoid", "drive"]))
        flags = 10 * int(g.integers(0, 4)) + kind
        velocity = (float(g.uniform(0.0 if kind == 2 else -0.6, 0.9)), float(g.uniform(-0.6, 0.6)))
        refused = r.post(flags, self._point() if kind == 2 else (0.0, float(g.uniform(-3, 3))), velocity, to=to)
        self.done.append(f"{r.now_s:.1f} {to} {flags} {refused}")
        self._run(0.3, 5.0)

    def _job(self) -> None:
        g, r = self.rng, self.robot
        flags = int(g.choice([42, 42, 43, 44, 45, 46, 47, -1]))
        sides = (float(g.uniform(-1, 8)), float(g.uniform(-1, 20))) if flags in (44, 46) else (0.0, 0.0)
        self.done.append(f"{r.now_s:.1f} motion {flags} {r.post(flags, self._point(), sides)}")
        self._run(0.5, 20.0)

    def _module(self) -> None:
        name, run = str(self.rng.choice(["motion", "avoid", "drive"])), bool(self.rng.random() < 0.6)
        self.robot.module(name, run)
        self.done.append(f"{self.robot.now_s:.1f} {name} {'starts' if run else 'stops'}")
        assert self.robot.system.is_running(name) == run, self.done

    def _start_all(self) -> None:
        for name in ("drive", "avoid", "motion"):
            self.robot.module(name, True)
        self.done.append(f"{self.robot.now_s:.1f} all started")
        assert -10 not in self.robot.status.element, self.done

    def _stop(self) -> None:
        r = self.robot
        r.system.operator_stop("operator")
        self.done.append(f"{r.now_s:.1f} stop")
        r.run(1.8, self._looks_right)
        r.system.latch.release(OPERATOR_STOP)
        r.run(1.0, self._looks_right)
        assert abs(r.velocity[0]) < 0.02 and abs(r.velocity[1]) < 0.03, ("moves after a stop, or by its release", self.done)

    def _looks_right(self) -> bool:
        r = self.robot
        assert all(code in listed for code, listed in zip(r.status.element, LISTED, strict=True)), (r.status, self.done)
        assert r.system.simulator.collisions == [], (r.status, self.done)
        assert [part.error for part in r.system.parts if part.failures] == [], self.done
        return False


@pytest.mark.parametrize("seed", [0, 3])
def test_whatever_is_posted_the_codes_are_listed_nothing_is_hit_and_a_stop_stops(tmp_path: Path, seed: int) -> None:
    drawn = Drawn(tmp_path, seed)
    for _ in range(STEPS):
        drawn.act()
