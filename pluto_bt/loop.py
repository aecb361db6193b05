"""Running a system: until the mission is over or something else ends it, then until the robot stands."""

from __future__ import annotations

import threading
from collections.abc import Callable

from estimation import levelled_scan
from pluto_bt.blackboard.codes import Avoidance, CommandType
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.resume import HELD
from pluto_bt.runtime.clock import NS, MonotonicClock, wait, wall_ns
from pluto_bt.runtime.collector import rarely_collecting
from pluto_bt.runtime.latch import OPERATOR_STOP
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.runtime.precedence import precedence
from pluto_bt.runtime.threads import Threads
from pluto_bt.runtime.watchdog import Hung, Watchdog
from pluto_bt.skills import approach, obstacles, path_following, plan_map, seen_space, wall_path
from pluto_bt.system import System
from pluto_bt.trees import Mission
from pluto_bt.trees.activity import PAUSED

STOP_WITHIN_S = 3.0
LOCKSTEP_LIMIT_S, THREADS_LIMIT_S = 10.0, 2.0
LOOK_EVERY_NS = NS // 2
LOOK_EVERY_S = 0.05


def rehearse(system: System, with_jobs: bool, with_walls: bool) -> None:
    """Drive half a second, so that every kernel is compiled before a watchdog looks. The system is in lockstep and is then thrown away.

    Args:
        with_jobs, with_walls: the jobs of motion, or wall follow, may be asked for, so their kernels too.
    """
    assert isinstance(system.scheduler, Lockstep)
    system.start_parts()
    system.scheduler.start()
    system.inboxes["motion"].post("mission", ActuatorState(0.0, 10 * Avoidance.BOTH + CommandType.GOTO, (1e3, 0.0), (0.3, 0.5)))
    system.scheduler.run_until(NS // 2)
    system.simulator.warm()
    if system.options.robot.devices.sonar is not None:
        approach.warm()
    if system.options.robot.devices.sonar is not None or system.options.robot.devices.laser is not None:
        obstacles.warm()
        seen_space.warm()
    if system.options.robot.devices.wrist is not None:
        levelled_scan.warm()
    if with_jobs:
        system.robot.surroundings.warm()
        plan_map.warm()
        path_following.warm()
    if with_walls:
        wall_path.warm()


class Loop:
    """One run of a system."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._interrupt = threading.Event()
        self.held = ""  # why the mission waits for an operator before its first tick
        self.told = ""  # what of an earlier run it goes on with
        self.wall_time_s = 0.0  # from the first step to the last

    def interrupt(self) -> None:
        """Ctrl-C: end the run after a controlled stop. Safe in a signal handler."""
        self._interrupt.set()

    def run(self, mission: Mission) -> None:
        """Run `mission` to its end, then bring the robot to rest. The outcome is in the guard and in the executive."""
        system = self._system
        system.executive.core.start(mission, HELD if self.held else "")
        if self.held:
            system.say("warning", HELD, "executive", self.held)
        elif self.told:
            system.say("info", "resumed", "executive", f"{self.told}; it goes on there")
        system.start_parts()
        if isinstance(system.clock, MonotonicClock):
            system.clock.restart()  # starting the gateway's process takes its time
        system.scheduler.start()
        begun_ns = wall_ns()
        try:
            with rarely_collecting():
                self._until(self._is_over)
                self._settle()
        finally:
            self.wall_time_s = (wall_ns() - begun_ns) / NS
            if isinstance(system.scheduler, Threads):
                system.scheduler.stop()
            system.executive.note_end(system.clock.now_s())
            system.stop_parts()
            system.executive.flush(system.clock.now_s())
            system.trace.close()

    def _until(self, is_over: Callable[[], bool]) -> None:
        scheduler = self._system.scheduler
        if isinstance(scheduler, Lockstep):
            self._lockstep_until(scheduler, is_over)
        else:
            self._threads_until(scheduler, is_over)

    def _lockstep_until(self, scheduler: Lockstep, is_over: Callable[[], bool]) -> None:
        system = self._system
        try:
            with Watchdog(lambda: scheduler.turns, LOCKSTEP_LIMIT_S):
                while not is_over():
                    scheduler.run_until(system.clock.now_ns() + LOOK_EVERY_NS, lambda: not is_over())
                    system.options.on_progress(system)
        except Hung:
            if scheduler.current is None:
                raise
            system.guard.hung(scheduler.current)

    def _threads_until(self, scheduler: Threads, is_over: Callable[[], bool]) -> None:
        system = self._system
        with precedence(wanted=scheduler.goes_first):  # else the chain would wait for whoever stops this thread while it has the interpreter
            while not is_over():
                wait(self._interrupt, LOOK_EVERY_S)
                system.options.on_progress(system)
                stuck = scheduler.stuck_part(THREADS_LIMIT_S)
                if stuck is not None and stuck.fault != "hang":
                    system.guard.hung(stuck)

    def _is_over(self) -> bool:
        system, guard = self._system, self._system.guard
        mission, limit_s = system.executive.core.mission, system.options.max_time_s
        if guard.ended is not None or (mission is not None and mission.is_over):
            return True
        if (self.held or limit_s is None) and (asked := self._asked_of_nobody()):
            guard.end(HELD, asked)
        elif self._interrupt.is_set():
            guard.end("interrupted", "interrupted: Ctrl-C, SIGTERM, or the terminal was closed")
        elif limit_s is not None and system.clock.now_s() >= limit_s:
            guard.end("max-time", f"the mission was still running after --max-time {limit_s:g} s")
        else:
            guard.look()
        return guard.ended is not None

    def _asked_of_nobody(self) -> str:
        """Why the mission waits for an operator where there is none, in virtual time without a gateway; "" else."""
        system = self._system
        stop = system.latch.hold(OPERATOR_STOP)
        if (stop is None and not self.held) or system.options.doors.take_orders or not isinstance(system.scheduler, Lockstep):
            return ""
        mission = system.executive.core.mission
        if self.held or stop is None or mission is None or mission.state != PAUSED:
            return self.held
        return f"{stop.text}, and nobody is there to let it go on; with --gateway or --realtime an operator can"

    def _settle(self) -> None:
        """Bring the robot to rest: stop every link, then let time pass until it stands."""
        system = self._system
        executive = system.part("executive")
        if executive is not None and executive.fault != "hang":
            system.executive.core.abort(system.guard.ended.reason if system.guard.ended else "stopped")
        system.stop_robot("supervision")
        limit_s = system.clock.now_s() + STOP_WITHIN_S
        self._interrupt.clear()
        self._until(lambda: system.clock.now_s() >= limit_s or self._is_at_rest())

    def _is_at_rest(self) -> bool:
        speed_mps, turn_rate_radps = self._system.simulator.velocity
        return abs(speed_mps) < 1e-3 and abs(turn_rate_radps) < 1e-3
