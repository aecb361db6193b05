"""Scenarios: a mission played in a scripted world, for tests that read as stories."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pluto_bt.behaviours.ports import text_of
from pluto_bt.blackboard.messages import Event
from pluto_bt.doors import Doors
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import Runner, make_runner
from pluto_bt.track import TrackPoint


@dataclass(frozen=True)
class Moment:
    """The truth at one time of a run."""

    t_s: float
    pose: tuple[float, float, float]

    def distance_to(self, x_m: float, y_m: float) -> float:
        """Metres from the robot to a point."""
        return math.hypot(self.pose[0] - x_m, self.pose[1] - y_m)


class Run:
    """A finished run. `run.result`, `run.reason`, `run.collisions`, `run.sim_time_s`, `run.blackboard`, … are those of `pluto run --json`."""

    def __init__(self, runner: Runner, events: list[Event]) -> None:
        self.runner = runner
        self.events = events

    def __getattr__(self, name: str) -> Any:
        return getattr(self.runner.result, name)

    def at(self, t_s: float) -> Moment:
        """Where the robot really was at `t_s`, between two points of the track by interpolation."""
        track = self.runner.system.track.points
        after = min(max(bisect.bisect_left([point.t_s for point in track], t_s), 1), len(track) - 1)
        return Moment(t_s, _between(track[after - 1], track[after], t_s))

    @property
    def track(self) -> list[TrackPoint]:
        """The true path, ten points a second."""
        return self.runner.system.track.points

    def said(self, code: str) -> list[str]:
        """The texts of all events with this code."""
        return [event.text for event in self.events if event.code == code]


def _between(a: TrackPoint, b: TrackPoint, t_s: float) -> tuple[float, float, float]:
    share = min(max((t_s - a.t_s) / (b.t_s - a.t_s), 0.0), 1.0) if b.t_s > a.t_s else 0.0
    x, y = (a.pose[i] + share * (b.pose[i] - a.pose[i]) for i in (0, 1))
    return (x, y, a.pose[2] + share * math.remainder(b.pose[2] - a.pose[2], math.tau))


class Play:
    """Runs scenarios; files are looked for beside `folder` too."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __call__(
        self,
        world: str | Path | None = None,
        *,
        mission: str | Path,
        map: str | Path | None = None,
        ports: Mapping[str, Any] | None = None,
        seed: int | None = None,
        platform: str | Path | None = None,
        start: str | None = None,
        tree: str | None = None,
        settings: Sequence[str] = (),
        realtime: bool = False,
        speed: float = 1.0,
        max_time_s: float | None = 600.0,
        nodes: Iterable[type] = (),
        gateway: str | None = None,
        web: str | None = None,
        groot: str | None = None,
        record: str | Path | None = None,
    ) -> Run:
        """Play one scenario to its end. Values of `ports` may be Python values or text as in `--port`.

        Raises: InputError with every fault of the files.
        """
        request = Request(
            mission=str(mission), world=_as_typed(world), map=_as_typed(map), start=start, platform=_as_typed(platform), tree=tree,
            seed=_as_typed(seed), set=tuple(settings),
            port=[f"{name}={text_of(value)}" for name, value in (ports or {}).items()],
        )  # fmt: skip
        events: list[Event] = []
        leaves = tuple(nodes)
        inputs = read_inputs(request, self._folder, leaves)
        runner = make_runner(
            inputs, nodes=leaves, on_event=events.append, realtime=realtime, speed=speed, max_time_s=max_time_s, record=record,
            doors=Doors.at(gateway=gateway, web=web, groot=groot),
        )  # fmt: skip
        runner.run()
        return Run(runner, events)


def _as_typed(given: object) -> str | None:
    """An argument as it would stand on the command line."""
    return None if given is None else str(given)
