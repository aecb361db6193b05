"""What a run is made of: what the command line, a test or a benchmark asks of the `System`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pluto_bt.blackboard.messages import Event
from pluto_bt.doors import CLOSED, Doors
from pluto_bt.maps.world import World
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.runtime.clock import StepClock
from pluto_bt.trees import Mission, load_mission
from pluto_bt.trees.checks import load_checked

if TYPE_CHECKING:
    from pluto_bt.record.entries import Run
    from pluto_bt.system import System


class RecordRequest(NamedTuple):
    """What the recorder is to write where: the run, and the files it is made of."""

    path: Path
    run: Run
    files: dict[str, bytes]


@dataclass
class Options:
    """What a run is made of."""

    world: World
    robot: RobotFile
    params_path: Path | None = None
    map: World | None = None
    start: tuple[float, float, float] | None = None
    seed: int = 0
    max_time_s: float | None = None
    trace_path: Path | None = None
    doors: Doors = CLOSED
    record: RecordRequest | None = None
    own_clock: StepClock | None = None
    load: Callable[..., Mission] = load_mission
    load_checked: Callable[[str, Mapping[str, str]], Mission] = load_checked  # what somebody asks for while it runs
    on_event: Callable[[Event], None] = lambda event: None
    on_progress: Callable[[System], None] = lambda system: None
    on_compiling: Callable[[], None] = lambda: None  # told before the run, if kernels must be compiled first

    @property
    def asked_modules(self) -> set[str]:
        """The modules that are there because somebody asked for them, or because of what is fixed to the robot and is no device of the simulator."""
        asked = {
            "gateway": self.doors.take_orders, "recorder": self.record is not None, "groot": self.doors.groot is not None,
            "ssh": self.doors.ssh is not None,
            "arm": self.robot.devices.arm is not None,
        }  # fmt: skip
        return {name for name, is_asked in asked.items() if is_asked}
