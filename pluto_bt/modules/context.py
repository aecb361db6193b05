"""What a module is given when it is made: the blackboard, the inboxes, the parameters, the devices. Nothing is global."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeVar

import msgspec

from drivers.records import Record
from pluto_bt.blackboard import Blackboard, Inbox
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.modules.job_box import JobBox
from pluto_bt.modules.notebook import Notebook
from pluto_bt.modules.post_box import PostBox
from pluto_bt.runtime import Clock
from pluto_bt.runtime.clock import StepClock
from pluto_bt.runtime.latch import SafetyLatch

if TYPE_CHECKING:
    from pluto_bt.system import System

T = TypeVar("T", bound=msgspec.Struct)


class Device(Protocol):
    """A device, real or simulated."""

    def read(self) -> list[Record]:
        """What arrived since the last call, oldest first; never blocks."""


@dataclass
class Context:
    """Everything a module may reach.

    Attributes:
        platform: the robot file.
        inboxes: by link name: base, filter, drive, avoid, motion, wrist.
        devices: by name as in `sim.Simulator.devices`.
        map: the a-priori map: the world's own unless `--map` says otherwise.
        say: (level, code, source, text) → a line in `events`.
        is_running: whether the module of that name is started (a stopped one shows −10).
        silent_s: seconds since the module of that name finished a step; 0 for one that is stopped or not there.
        latch: while it holds, nothing moves.
        posts: where improved poses wait for `local`.
        jobs: where motion orders the jobs 42 to 45 from the executive.
        order_module: (name, run) → start or stop a module.
        own_clock: the clock of trees where `clock` itself flows.
        black_box: what waits to be written to the black box; None = this run is not recorded.
    """

    board: Blackboard
    clock: Clock
    platform: Platform
    inboxes: Mapping[str, Inbox]
    devices: Mapping[str, Device]
    map: World | None
    say: Callable[[str, str, str, str], None]
    is_running: Callable[[str], bool]
    start_pose: tuple[float, float, float] = (0.0, 0.0, 0.0)
    silent_s: Callable[[str], float] = lambda name: 0.0
    latch: SafetyLatch = field(default_factory=SafetyLatch)
    posts: PostBox = field(default_factory=PostBox)
    jobs: JobBox = field(default_factory=JobBox)
    order_module: Callable[[str, bool], None] = lambda name, run: None
    joined: System | None = None
    own_clock: StepClock | None = None
    black_box: Notebook | None = None

    @property
    def mission_clock(self) -> Clock:
        """The time that trees live in; it stands still while a tick lasts."""
        return self.own_clock or self.clock

    def parameters(self, kind: type[T]) -> T:
        """The table of the robot file that `kind` declares; its defaults where the file has none."""
        tables = (getattr(self.platform, field) for field in self.platform.__struct_fields__)
        return next((table for table in tables if type(table) is kind), None) or kind()

    @property
    def system(self) -> System:
        """The system that this module is part of. Raises RuntimeError where a test joined none."""
        if self.joined is None:
            raise RuntimeError("this module needs a system around it")
        return self.joined
