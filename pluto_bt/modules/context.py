"""What a module is given when it is made: the blackboard, the inboxes, the parameters, the devices. Nothing is global."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from drivers.records import Record
from pluto_bt.blackboard import Blackboard, Inbox
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.runtime import Clock


class Device(Protocol):
    """A device, real or simulated."""

    def read(self) -> list[Record]:
        """What arrived since the last call, oldest first; never blocks."""


@dataclass
class Context:
    """Everything a module may reach.

    Attributes:
        platform: the robot file; module tables are attributes of it too (`platform.drive`, `platform.avoid`, …).
        inboxes: by link name: base, drive, avoid, motion, wrist.
        devices: by name as in `sim.Simulator.devices`.
        map: the a-priori map: the world's own unless `--map` says otherwise.
        say: (level, code, source, text) → a line in `events`.
        is_running: whether the module of that name is started (a stopped one shows −10).
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
    extras: dict[str, Any] = field(default_factory=dict)
