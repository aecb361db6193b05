"""The guard of a run: hears of failures, stops the robot, and decides what ends the run and with which words."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, NamedTuple

from pluto_bt.maps.script import FaultAction
from pluto_bt.runtime.clock import NS, MonotonicClock, wait
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.watchdog import Hung
from pluto_bt.source import PlutoError
from pluto_bt.trees.executive import MODULE_ERROR

if TYPE_CHECKING:
    from pluto_bt.system import System

BASE_LOST_AFTER_S = 2.0
MENDED_S = 1.5  # after so long a module that was started again is trusted, and the robot stands
SLOW_S = 0.5
FOR_EVER_S = 1e6


class End(NamedTuple):
    """What other than the mission ended a run."""

    result: str
    reason: str
    text: str


class Guard:
    """Implements `pluto_bt.runtime.supervision.Listener`."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._newest_raw = system.board.reader("ATRV2/Drive/Raw")
        self._mended_s: float | None = None  # when a critical module that had failed ran again, while the mission still waits
        self.ended: End | None = None

    def end(self, reason: str, text: str) -> None:
        """End the run; the first reason counts."""
        if self.ended is None:
            self.ended = End("STOPPED", reason, text)
            self._system.say("error", reason, "supervision", text)

    def part_failed(self, part: Part, error: BaseException, is_final: bool) -> None:
        """A module raised: tell it. A critical one: the mission pauses, the robot stands till it runs again; if it cannot be mended the run ends."""
        what = f'module "{part.module.name}" failed: {part.error}'
        self._system.say("error", MODULE_ERROR, part.module.name, what)
        if part.module.critical:
            self._system.executive.core.pause(MODULE_ERROR)
            self._system.stop_robot("supervision")
        if is_final:
            self.end(MODULE_ERROR, what)

    def part_restarted(self, part: Part) -> None:
        """A module runs again."""
        self._system.say("info", "module-restarted", part.module.name, f'module "{part.module.name}" was started again')
        if part.module.critical:
            self._mended_s = self._system.clock.now_s()

    def hung(self, part: Part) -> None:
        """`part` never returned: name it, or the leaf it is in, stop the robot and end the run."""
        core = self._system.executive.core
        active = core.ticking or core.active
        leaf = active.mission.current_leaf() if part.module.name == "executive" and active is not None else ""
        part.fault = "hang"
        self.end("hung", f'leaf "{leaf}" never returned' if leaf else f'module "{part.module.name}" never returned')
        self._system.stop_robot("supervision")

    def look(self) -> None:
        """End the run if the base has fallen silent; let the mission go on a while after the modules that failed run again."""
        raw, now_s = self._newest_raw(), self._system.clock.now_s()
        if now_s - (0.0 if raw is None else raw.written_s) > BASE_LOST_AFTER_S:
            self.end("base-lost", f"the base has sent no odometry for {BASE_LOST_AFTER_S:g} s")
        if self._mended_s is not None and now_s - self._mended_s >= MENDED_S:
            self._mended_s = None
            self._system.executive.core.resume_after(MODULE_ERROR, self._is_well)

    def _is_well(self) -> bool:
        """True if every critical module runs and nobody holds the robot; asked by the executive in the moment of going on."""
        return self._system.latch.held is None and all(part.state == "running" for part in self._system.parts if part.module.critical)

    # ------------------------------------------------------------------ faults that a world script asks for

    def software_fault(self, fault: FaultAction, begins: bool) -> None:
        """`module:NAME` or `leaf:NAME` fails, or works again."""
        kind, _, name = fault.device.partition(":")
        if kind == "leaf":
            wanted = fault.kind if begins else ""
            self._system.executive.core.order(lambda: self._leaf_fault(name, wanted))  # between two ticks, never within one
            return
        part = self._system.part(name)
        if part is None:
            self._system.say("warning", "unknown-module", "world", f'the world script names no module of this robot: "{name}"')
        elif fault.kind == "off":
            self._system.order_module(name, not begins)
        elif fault.kind == "slow":
            part.slow_ns = round((fault.delay_s or SLOW_S) * NS) if begins else 0
        else:
            part.fault = fault.kind if begins else ""
            if part.fault == "hang":
                self.hung(part)

    def _leaf_fault(self, name: str, kind: str) -> None:
        """A leaf raises, gives no status or never returns; "" = its own work again."""

        def step() -> Any:
            if kind == "hang":
                if isinstance(self._system.clock, MonotonicClock):
                    wait(threading.Event(), FOR_EVER_S)
                raise Hung(f'the world script lets leaf "{name}" hang')  # in virtual time nobody need wait for the watchdog
            raise PlutoError(f'the world script lets leaf "{name}" {"raise" if kind == "raise" else "return None"}')

        core = self._system.executive.core
        core.note("leaf-fault", text=f"{kind} {name}")
        trees = [activity.mission for activity in (core.active, core.job) if activity is not None]
        found = [tree.replace_step(name, step if kind else None) for tree in trees]  # in all of them, not only in the first
        if True not in found:
            self._system.say("warning", "unknown-leaf", "world", f'the world script names no leaf of this mission: "{name}"')
