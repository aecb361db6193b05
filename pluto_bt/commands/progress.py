"""What a run shows of itself: one live line on a terminal, plain lines when piped, and a summary at the end."""

from __future__ import annotations

import math
import os
import shutil
from typing import IO, Any

from pluto_bt.blackboard.messages import Event
from pluto_bt.gateway.words import said_by
from pluto_bt.result import RunResult
from pluto_bt.runtime.clock import wall_ns
from pluto_bt.system import System
from pluto_bt.trees import Mission

LIVE_EVERY_NS = 100_000_000
PLAIN_EVERY_S = 60.0


def is_terminal(stream: IO[str]) -> bool:
    """Whether what is drawn there can be drawn over."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


class Progress:
    """Prints to a stream; knows whether that is a terminal."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream
        self._is_live = is_terminal(stream)
        self._begun_ns = 0
        self._shown_ns = 0
        self._next_plain_s = PLAIN_EVERY_S
        self._is_drawn = False

    def attach(self, mission: Mission) -> None:
        """Told once, before the run, which mission it will be."""

    def line(self, text: str) -> None:
        """One whole line, above the live one."""
        self._clear()
        print(text, file=self._stream, flush=True)

    def event(self, event: Event) -> None:
        """An event of the run."""
        mark = {"info": " ", "warning": "!", "error": "✗"}[event.level]
        self.line(f"[{event.stamp_s:8.1f} s] {mark} {said_by(event.source, event.text)}")

    def show(self, system: System) -> None:
        """Called every now and then while the run goes on."""
        now_ns = wall_ns()
        self._begun_ns = self._begun_ns or now_ns
        if self._is_live:
            if now_ns - self._shown_ns >= LIVE_EVERY_NS:
                self._shown_ns = now_ns
                self._draw(system, now_ns)
        elif system.clock.now_s() >= self._next_plain_s:
            self._next_plain_s = system.clock.now_s() + PLAIN_EVERY_S
            print(self._status(system, now_ns), file=self._stream, flush=True)

    def _status(self, system: System, now_ns: int) -> str:
        simulator, active = system.simulator, system.executive.core.active
        now_s = system.clock.now_s()
        wall_s = max((now_ns - self._begun_ns) / 1e9, 1e-3)
        state, leaf = ("idle", "") if active is None else (active.state, active.mission.active_leaf())
        clearance = "" if math.isinf(simulator.clearance_m) else f"  clear {simulator.clearance_m:.2f} m"
        return f"{now_s:8.1f} s  × {now_s / wall_s:<5.0f} {state}  {leaf}  {simulator.velocity[0]:+.2f} m/s{clearance}"

    def _draw(self, system: System, now_ns: int) -> None:
        self._clear()
        fits = shutil.get_terminal_size().columns - 1  # what a line may have so that it does not wrap
        print(self._status(system, now_ns)[:fits], end="", file=self._stream, flush=True)
        self._is_drawn = True

    def _clear(self) -> None:
        if self._is_drawn:
            print("\r\x1b[J", end="", file=self._stream)
            self._is_drawn = False

    def end(self, result: RunResult) -> None:
        """The summary."""
        self._clear()
        print(summary(result), file=self._stream, flush=True)


def summary(result: RunResult) -> str:
    """A run in a few lines."""
    speed = result.sim_time_s / result.wall_time_s if result.wall_time_s > 0 else 0.0
    head = result.result + (f" ({result.reason})" if result.reason else "") + (f": {result.text}" if result.text else "")
    lines = [
        head,
        f"  mission    {result.mission} in {result.world} with {result.platform}, seed {result.seed}",
        f"  time       {result.sim_time_s:.1f} s simulated in {result.wall_time_s:.2f} s (× {speed:.0f}), {result.ticks} ticks",
        f"  driven     {result.distance_m:.2f} m, collisions {result.collisions}, hit by others {result.hit_by}, "
        f"nearest {_metres(result.min_clearance_m)}",
    ]
    if result.final_pose is not None:
        lines.append(f"  ended at   {_pose(result.final_pose)}" + (f", believed {_pose(result.estimated_pose)}" if result.estimated_pose else ""))
    lines += [f"  contact    {_contact(contact)}" for contact in result.contacts[:5]]
    lines += [f"  contract   {one['name']}: {_kept(one)}" for one in result.contracts]
    lines.append(f"  trace      {result.trace_sha256[:16]}…")
    return "\n".join(lines)


def _kept(told: dict[str, Any]) -> str:
    """How a contract has stood, in a few words."""
    if not told["breaches"]:
        return f"{told['verdict']}{': ' + told['problem'] if told['problem'] else ''}"
    first, count = told["breaches"][0], len(told["breaches"])
    return f"broken at {first['broken_s']:.1f} s" + (f" and {count - 1} times more" if count > 1 else "")


def _metres(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f} m"


def _pose(pose: tuple[float, float, float]) -> str:
    return f"{pose[0]:.2f}, {pose[1]:.2f}, {math.degrees(pose[2]):.0f}°"


def _contact(contact: dict[str, object]) -> str:
    return f"with {contact['with_id']} at {contact['x_m']:.2f}, {contact['y_m']:.2f} after {contact['t_s']:.1f} s, {contact['speed_mps']:.2f} m/s"
