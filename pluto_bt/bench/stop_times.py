"""From a cause to a command of zero at the base, in simulated time: 99.9th percentiles over many trials at random moments.

One robot circles in a hall; again and again something happens to it, it stops, all is well again, and it drives on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pluto_bt.bench.killed import killed_times_s
from pluto_bt.bench.row import BenchRow
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.maps.script import At, FaultAction
from pluto_bt.maps.world import Shape, World
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.run_options import Options
from pluto_bt.runtime.clock import NS, VirtualClock
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.system import System

TRIALS = 1000
TRIAL_S, JITTER_S, FAULT_S, FIRST_S = 1.7, 0.3, 0.6, 2.0
ORDER_EVERY_S = 0.5
TWIST = (0.4, 0.25)
STEP_S = 0.01
CLIENT = "bench"


@dataclass(frozen=True)
class Cause:
    """What happens, and the longest time until zero is commanded: a fault of a device or of a module, or a deed."""

    name: str
    limit_s: float
    fault: FaultAction | None = None
    module: str = ""
    begin: Callable[[GatewayPort], None] | None = None
    end: Callable[[GatewayPort], None] = lambda port: None


def _laser(kind: str, beams: tuple[int, int] | None = None) -> FaultAction:
    return FaultAction("laser", kind, for_s=FAULT_S, beams=beams)


CAUSES = (
    Cause("operator stop", 0.1, begin=lambda port: port.stop(CLIENT)),
    Cause("e-stop", 0.1, begin=lambda port: port.estop(CLIENT, "bench"), end=lambda port: port.release_estop(CLIENT)),
    Cause("laser frozen: old scans again and again", 0.5, _laser("frozen")),
    Cause("laser stuck: new stamps, old content", 0.5, _laser("stuck")),
    Cause("laser NaN", 0.5, _laser("nan")),
    Cause("laser NaN in half the beams", 0.5, _laser("nan", (0, 180))),
    Cause("odometry frozen: old readings again and again", 0.5, FaultAction("odometry", "frozen", for_s=FAULT_S)),
    Cause("odometry stuck: new stamps, old counts", 0.5, FaultAction("odometry", "stuck", for_s=FAULT_S)),
    Cause("executive hung", 0.3, module="executive"),
    Cause("drive hung", 0.3, module="drive"),
)


def hall(script: tuple[At, ...] = (), kerb: bool = False) -> World:
    """Walls and posts round the circle; a kerb, lower than any sensor looks, for the bumper."""
    shapes = [Shape("hall", "wall", np.array([(-6.0, -5.0), (7.0, -5.0), (7.0, 8.0), (-6.0, 8.0), (-6.0, -5.0)]))]
    shapes += [Shape(f"post{i}", "circle", np.array([[5.0 * np.cos(i), 2.0 + 4.5 * np.sin(i)]]), 0.1) for i in range(6)]
    if kerb:
        shapes.append(Shape("kerb", "polygon", np.array([(2.0, -4.0), (2.3, -4.0), (2.3, 4.0), (2.0, 4.0)]), 0.0, 0.1))
    return World("hall", shapes=tuple(shapes), script=script)


class Circling:
    """The robot with motion and avoid stopped, so that raw commands reach the drive."""

    def __init__(self, world: World, seed: int) -> None:
        self.system = System(Options(world=world, robot=load_robot_file("atrv2"), start=(0.0, 0.0, 0.0), seed=seed), VirtualClock())
        self.system.start_parts()
        self.system.scheduler.start()
        for link in ("motion", "avoid"):
            self.system.order_module(link, False)
        self.port = GatewayPort(self.system.context)
        self.run_to(0.2)  # they stop at their next step

    @property
    def now_s(self) -> float:
        """Simulated seconds."""
        return self.system.clock.now_s()

    @property
    def commanded(self) -> tuple[float, ...]:
        """What the base was told last."""
        sample = self.system.board.newest("ATRV2/Drive/Command")
        return sample.value.velocity if sample is not None and isinstance(sample.value, ActuatorState) else (0.0, 0.0)

    def run_to(self, at_s: float, until: Callable[[], bool] | None = None) -> None:
        """Let time pass, to the nanosecond, or until something holds (looked at every 10 ms)."""
        assert isinstance(self.system.scheduler, Lockstep)
        step_ns = round(at_s * NS) if until is None else round(STEP_S * NS)
        while self.now_s < at_s - 1e-9 and not (until is not None and until()):
            self.system.scheduler.run_until(min(round(at_s * NS), self.system.clock.now_ns() + step_ns))

    def circle_to(self, at_s: float) -> None:
        """Drive on, with a new command every now and then."""
        while self.now_s < at_s - 1e-9:
            self.port.post_command("drive", ActuatorState(self.now_s, 0, (0.0, 0.0), TWIST), CLIENT)
            self.run_to(min(at_s, self.now_s + ORDER_EVERY_S))

    def is_told_to_stand(self) -> bool:
        """Whether the base was told zero."""
        return self.commanded == (0.0, 0.0)


def stop_times_s(cause: Cause, trials: int, seed: int) -> list[float]:
    """Seconds from the cause to a zero command, one for each trial; infinite if it never came. A robot that stood already is a fault of the trial."""
    rng = np.random.default_rng(seed)
    at_s = [round(FIRST_S + TRIAL_S * k + float(rng.uniform(0.0, JITTER_S)), 2) for k in range(trials)]
    script = tuple(At(t_s, (cause.fault,)) for t_s in at_s) if cause.fault is not None else ()
    robot = Circling(hall(script), seed)
    return [_trial(robot, cause, t_s) for t_s in at_s]


def _trial(robot: Circling, cause: Cause, at_s: float) -> float:
    robot.circle_to(at_s)
    if robot.is_told_to_stand():
        raise RuntimeError(f'"{cause.name}" at {at_s} s: the robot does not drive, {robot.system.board.newest("filter/status")}')
    part = robot.system.part(cause.module)
    if part is not None:
        part.fault = "hang"  # without the supervision that a world's script would wake
    if cause.begin is not None:
        cause.begin(robot.port)
    robot.run_to(at_s + FAULT_S, robot.is_told_to_stand)
    took_s = robot.now_s - at_s if robot.is_told_to_stand() else np.inf
    robot.run_to(at_s + FAULT_S)
    if part is not None:
        part.fault = ""
    cause.end(robot.port)
    robot.run_to(robot.now_s + 0.2)
    if cause.begin is not None and not robot.is_told_to_stand():
        return float(np.inf)  # it moved without a command
    return float(took_s)


def bumper_times_s(trials: int, seed: int) -> list[float]:
    """Seconds from the last moment before a panel was pressed to a zero command: against a kerb, at random speeds, again and again."""
    rng, robot, times = np.random.default_rng(seed), Circling(hall(kerb=True), seed), list[float]()
    bumpers = load_robot_file("atrv2").devices.bumpers
    assert bumpers is not None
    robot.run_to(1.0)
    while len(times) < trials:
        _order(robot, float(rng.uniform(0.1, 0.6)))
        robot.run_to(robot.now_s + 8.0, lambda: robot.system.simulator.clearance_m <= bumpers.depth_m)
        pressed_s = robot.now_s - STEP_S
        robot.run_to(robot.now_s + FAULT_S, robot.is_told_to_stand)
        times.append(robot.now_s - pressed_s if robot.is_told_to_stand() else np.inf)
        robot.run_to(robot.now_s + 1.0)
        _order(robot, -0.2)
        robot.run_to(robot.now_s + float(rng.uniform(1.5, 2.5)))
    return times


def _order(robot: Circling, speed_mps: float) -> None:
    robot.port.post_command("drive", ActuatorState(robot.now_s, 0, (0.0, 0.0), (speed_mps, 0.0)), CLIENT)


def row_of(name: str, times_s: list[float], limit_s: float) -> BenchRow:
    """The 99.9th percentile, and the mean beside it."""
    value = float(np.quantile(times_s, 0.999, method="higher"))
    return BenchRow(name, value, "s", f"<= {limit_s:g}", f"{len(times_s)} trials, mean {float(np.mean(times_s)):.3f} s")


def run(trials: int = TRIALS) -> list[BenchRow]:
    """All causes."""
    rows = [row_of("bumper", bumper_times_s(trials, 1), 0.1)]
    rows += [row_of(cause.name, stop_times_s(cause, trials, 1), cause.limit_s) for cause in CAUSES]
    return [*rows, row_of("software killed: SIGKILL, the base by itself", killed_times_s(trials, 1), 0.3)]
