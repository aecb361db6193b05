"""One robot as a whole: THE table of modules, and the `System` that makes them, joins them and runs a mission.

Everything that runs is a row of MODULES; equal due times run in this order: the world and the devices, then the pose, then the chain from
below, so that a status reaches the top in one go; a command wakes each link on its way down. There is no module state: several systems fit one process.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pluto_bt.blackboard import TOPICS, Blackboard, Inbox, Sample
from pluto_bt.blackboard.codes import Avoidance, CommandType
from pluto_bt.blackboard.messages import ActuatorState, Event
from pluto_bt.gateway.listen import Address
from pluto_bt.maps.world import FaultAction, World
from pluto_bt.modules.context import Context
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.modules.robot_link import RobotLink
from pluto_bt.runtime.clock import NS, MonotonicClock, VirtualClock, wait, wall_ns
from pluto_bt.runtime.latch import OPERATOR_STOP, SafetyLatch
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.table import Module, in_start_order
from pluto_bt.runtime.threads import Threads
from pluto_bt.runtime.trace import Trace
from pluto_bt.runtime.watchdog import Hung, Watchdog
from pluto_bt.source import PlutoError
from pluto_bt.trees import Mission, load_mission

# fmt: off
MODULES: tuple[Module, ...] = (
    #      name         factory "module:Class"                    period  group         more
    Module("world",     "pluto_bt.modules.world:World",           0.02,   "io",         critical=True,                                  budget_ms=5.0),
    Module("base",      "pluto_bt.modules.base:Base",             0.02,   "io",         critical=True, wakes=("inbox:base",),          budget_ms=2.0),
    Module("sick",      "pluto_bt.modules.sick:Sick",             0.02,   "io",         device="laser",                                 budget_ms=2.0),
    Module("dmu",       "pluto_bt.modules.dmu:Dmu",               0.02,   "io",         device="dmu",                                   budget_ms=1.0),
    Module("imu",       "pluto_bt.modules.imu:Imu",               0.02,   "io",         device="imu",                                   budget_ms=1.0),
    Module("compass",   "pluto_bt.modules.compass:Compass",       0.1,    "io",         device="compass",                               budget_ms=1.0),
    Module("gps",       "pluto_bt.modules.gps:Gps",               0.5,    "io",         device="gps",                                   budget_ms=1.0),
    Module("wrist",     "pluto_bt.modules.wrist:Wrist",           0.05,   "io",         device="wrist", wakes=("inbox:wrist",),         budget_ms=1.0),
    Module("speed",     "pluto_bt.modules.speed:Speed",           0.1,    "io",         device="speed",                                 budget_ms=1.0),
    Module("marker",    "pluto_bt.modules.marker:Marker",         0.1,    "io",         device="marker", needs=("local",),              budget_ms=1.0),
    Module("local",     "pluto_bt.modules.local:Local",           0.0,    "estimation", critical=True, needs=("base",),                 budget_ms=2.0,
           wakes=("ATRV2/Drive/Raw", "sick/timing", "Localization/Post_Pose")),
    Module("filter",    "pluto_bt.modules.filter:Filter",         0.05,   "chain",      critical=True, needs=("base", "local"), wakes=("inbox:filter",), budget_ms=5.0),
    Module("drive",     "pluto_bt.modules.drive:Drive",           0.05,   "chain",      critical=True, needs=("filter",), wakes=("inbox:drive",), budget_ms=2.0),
    Module("avoid",     "pluto_bt.modules.avoid:Avoid",           0.1,    "chain",      critical=True, needs=("drive",), wakes=("inbox:avoid",), budget_ms=10.0),
    Module("motion",    "pluto_bt.modules.motion:Motion",         0.1,    "chain",      critical=True, needs=("avoid",), wakes=("inbox:motion",), budget_ms=5.0),
    Module("executive", "pluto_bt.modules.executive:Executive",   0.1,    "mission",    needs=("motion",),                              budget_ms=20.0),
    Module("gateway",   "pluto_bt.modules.gateway:Gateway",       0.05,   "gateway",    needs=("executive",), device="gateway",             budget_ms=20.0),
)
# fmt: on

INBOXES = {"base": "filter", "filter": "drive", "drive": "avoid", "avoid": "motion", "motion": "", "wrist": ""}  # link -> the link above, which owns its inbox
STOP_WITHIN_S = 3.0
LOCKSTEP_LIMIT_S, THREADS_LIMIT_S = 10.0, 2.0
BASE_LOST_AFTER_S = 2.0


@dataclass
class Options:
    """What a run is made of."""

    world: World
    robot: RobotFile
    map: World | None = None
    start: tuple[float, float, float] | None = None
    seed: int = 0
    max_time_s: float | None = None
    trace_path: Path | None = None
    has_gateway: bool = False
    gateway: Address | None = None
    load: Callable[[str], Mission] = load_mission
    on_event: Callable[[Event], None] = lambda event: None
    on_progress: Callable[[System], None] = lambda system: None


@dataclass
class TrackPoint:
    """Where the robot really was."""

    t_s: float
    pose: tuple[float, float, float]


@dataclass
class Track:
    """The true path of a run at 10 Hz, thinned by half whenever it gets long, so that a day of driving stays small."""

    points: list[TrackPoint] = field(default_factory=list)
    every: int = 1
    seen: int = 0
    limit: int = 20_000

    def add(self, t_s: float, pose: tuple[float, float, float]) -> None:
        """Take the next point of the path."""
        if self.seen % self.every == 0:
            self.points.append(TrackPoint(t_s, pose))
            if len(self.points) >= self.limit:
                self.points = self.points[::2]
                self.every *= 2
        self.seen += 1


class System:
    """One robot in one world."""

    def __init__(self, options: Options, clock: VirtualClock | MonotonicClock, modules: tuple[Module, ...] = MODULES) -> None:
        from sim.simulator import Simulator

        self.options = options
        self.clock = clock
        self.board = Blackboard(TOPICS)
        self.trace = Trace(options.trace_path)
        self.track = Track()
        self.simulator = Simulator(options.world, options.robot, options.seed, options.start)
        self.simulator.on_software_fault = self._on_software_fault
        self.ended: tuple[str, str, str] | None = None  # (result, reason, text) when something other than the mission ends the run
        self.wall_time_s = 0.0  # from the first step to the last
        self._interrupt = threading.Event()
        self._parts: dict[str, Part] = {}
        self.latch = SafetyLatch()
        self.inboxes = {link: Inbox(link, self._owner_rule(link, above)) for link, above in INBOXES.items()}
        self.context = self._make_context()
        has = {*self.simulator.devices, *(("gateway",) if options.has_gateway else ())}
        self._make_parts([row for row in modules if not row.device or row.device in has])
        self._join()

    # ------------------------------------------------------------------ making

    def _make_context(self) -> Context:
        context = Context(
            board=self.board, clock=self.clock, platform=self.options.robot, inboxes=self.inboxes, devices=self.simulator.devices,
            map=self.options.map or self.options.world, say=self.say, is_running=self.is_running, start_pose=self.simulator.pose,
            order_module=self.order_module, silent_s=self.silent_s, latch=self.latch, joined=self,
        )  # fmt: skip
        self.robot = RobotLink(context)
        return context

    def _make_parts(self, rows: list[Module]) -> None:
        made: dict[str, Any] = {row.name: row.load()(self.context) for row in in_start_order(rows)}
        self._parts = {row.name: Part(row, made[row.name], number, self) for number, row in enumerate(rows)}
        self.executive = made["executive"]
        self.executive.on_event = self.options.on_event

    def _join(self) -> None:
        parts = tuple(self._parts.values())
        self.scheduler = Threads(parts, self.clock) if isinstance(self.clock, MonotonicClock) else Lockstep(parts, self.clock)
        for part in parts:
            for source in part.module.wakes:
                _, _, name = source.rpartition("inbox:")
                wake = self.scheduler.waker(part.row)
                if "inbox:" in source:
                    self.inboxes[name].on_post(wake)
                else:
                    self.board.on_change(source, wake)
        for topic in self.board.topics:
            if topic.type is ActuatorState and topic.name.lower().endswith("/command"):
                self.board.on_change(topic.name, self._trace_command(topic.name))
        self.board.on_change("world/state", self._follow)

    def _owner_rule(self, link: str, above: str) -> Callable[[str], bool]:
        """Who may post to an inbox: the link above while it runs; else whoever is no link (the mission, the lease holder).

        While the safety latch holds nobody may; but the filter still tells the base to stand still, and the wrist moves nobody.
        """

        def is_owner(source: str) -> bool:
            if self.latch.held is not None and link not in ("base", "wrist"):
                return False
            return source == above if above and (self.is_running(above) or link == "base") else source not in INBOXES

        return is_owner

    def _trace_command(self, name: str) -> Callable[[], None]:
        newest = self.board.reader(name)

        def line() -> None:
            sample = newest()
            if sample is not None and isinstance(sample.value, ActuatorState):
                command = sample.value
                self.trace.line({"t": self.clock.now_ns(), "command": name, "flags": command.flags, "position": command.position,
                                 "velocity": command.velocity})  # fmt: skip

        return line

    def _follow(self) -> None:
        self.track.add(self.simulator.time_s, self.simulator.pose)

    # ------------------------------------------------------------------ what others ask

    @property
    def parts(self) -> tuple[Part, ...]:
        """Every module at work, in table order."""
        return tuple(self._parts.values())

    def is_running(self, name: str) -> bool:
        """True if the module's thread runs."""
        part = self._parts.get(name)
        return part is None or part.is_running

    def silent_s(self, name: str) -> float:
        """Seconds since the module of that name finished a step; 0 for one that is stopped or not there."""
        part = self._parts.get(name)
        return 0.0 if part is None or not part.is_running else (self.clock.now_ns() - part.stepped_ns) / NS

    def say(self, level: str, code: str, source: str, text: str) -> None:
        """A line for operators."""
        if self._parts:
            self.executive.say(level, code, source, text)

    def newest(self, topic: str) -> Sample | None:
        """The newest sample of a topic."""
        return self.board.newest(topic)

    def module(self, name: str) -> Part:
        """A part by name. Raises KeyError."""
        return self._parts[name]

    def order_module(self, name: str, run: bool) -> None:
        """Start a module, after all that it needs; or stop it. Raises KeyError if there is none of that name."""
        part = self._parts[name]
        for need in part.module.needs if run else ():
            if need in self._parts and not self._parts[need].is_running:
                self.order_module(need, True)
        part.order(run)
        self.scheduler.waker(part.row)()

    def stop_robot(self, source: str) -> None:
        """Zero velocity at once, on every link."""
        now_s = self.clock.now_s()
        for link in ("base", "filter", "drive", "avoid", "motion"):
            self.inboxes[link].stop(source, now_s)

    def operator_stop(self, source: str) -> None:
        """Zero velocity at once, latched until somebody commands anew; a running mission pauses. Thread-safe."""
        self.latch.set(OPERATOR_STOP, f"{source} stopped the robot")
        self.stop_robot(source)
        self.executive.core.pause(OPERATOR_STOP)

    def operator_resume(self) -> None:
        """Take the operator's stop back, and let a paused mission go on; an emergency stop goes on holding. Thread-safe."""
        self.latch.release(OPERATOR_STOP)
        self.executive.core.resume()

    def interrupt(self) -> None:
        """Ctrl-C: end the run after a controlled stop. Safe in a signal handler."""
        self._interrupt.set()

    # ------------------------------------------------------------------ supervision

    def part_failed(self, part: Part, error: BaseException, is_final: bool) -> None:
        """A module raised: tell it; if it is critical stop the robot; if it cannot be mended end the run."""
        what = f'module "{part.module.name}" failed: {part.error}'
        self.say("error", "module-error", part.module.name, what)
        if part.module.critical:
            self.stop_robot("supervision")
        if is_final:
            self._end("STOPPED", "module-error", what)

    def part_restarted(self, part: Part) -> None:
        """A module runs again."""
        self.say("info", "module-restarted", part.module.name, f'module "{part.module.name}" was started again')

    def _on_software_fault(self, fault: FaultAction, begins: bool) -> None:
        kind, _, name = fault.device.partition(":")
        if kind == "leaf":
            self._leaf_fault(name, fault.kind if begins else "")
            return
        part = self._parts.get(name)
        if part is None:
            self.say("warning", "unknown-module", "world", f'the world script names no module of this robot: "{name}"')
        elif fault.kind == "off":
            self.order_module(name, not begins)
        elif fault.kind == "slow":
            part.slow_ns = round((fault.delay_s or 0.5) * NS) if begins else 0
        else:
            part.fault = fault.kind if begins else ""
            if begins and fault.kind == "hang":
                self._hung(part)

    def _leaf_fault(self, name: str, kind: str) -> None:
        """A leaf raises, gives no status or never returns, as the world script says; "" = its own work again."""

        def step() -> Any:
            if kind == "hang":
                if isinstance(self.scheduler, Threads):
                    wait(threading.Event(), 1e6)
                raise Hung(f'the world script lets leaf "{name}" hang')  # in virtual time nobody need wait for the watchdog
            raise PlutoError(f'the world script lets leaf "{name}" {"raise" if kind == "raise" else "return None"}')

        active = self.executive.core.active
        if active is None or not active.mission.replace_step(name, step if kind else None):
            self.say("warning", "unknown-leaf", "world", f'the world script names no leaf of this mission: "{name}"')

    def _hung(self, part: Part) -> None:
        """`part` never returned: name it, or the leaf it is in, stop the robot and end the run."""
        active = self.executive.core.active
        leaf = active.mission.current_leaf() if part.module.name == "executive" and active is not None else ""
        what = f'leaf "{leaf}" never returned' if leaf else f'module "{part.module.name}" never returned'
        part.fault = "hang"
        self._end("STOPPED", "hung", what)
        self.stop_robot("supervision")

    def _end(self, result: str, reason: str, text: str) -> None:
        if self.ended is None:
            self.ended = (result, reason, text)
            self.say("error", reason, "supervision", text)

    # ------------------------------------------------------------------ running

    def rehearse(self) -> None:
        """Drive half a second, so that every kernel is compiled before a watchdog looks. For a system in lockstep that is then thrown away."""
        assert isinstance(self.scheduler, Lockstep)
        self._start()
        self.inboxes["motion"].post("mission", ActuatorState(0.0, 10 * Avoidance.BOTH + CommandType.GOTO, (1e3, 0.0), (0.3, 0.5)))
        self.scheduler.run_until(NS // 2)

    def _start(self) -> None:
        now_ns = self.clock.now_ns()
        for row in in_start_order([part.module for part in self._parts.values()]):
            self._parts[row.name].start(now_ns)
        self.scheduler.start()

    def run(self, mission: Mission) -> None:
        """Run `mission` to its end, then bring the robot to rest. The outcome is in `ended` and in the executive."""
        self.executive.core.start(mission)
        self._start()
        begun_ns = wall_ns()
        try:
            self._until(self._is_over)
            self._settle()
        finally:
            self.wall_time_s = (wall_ns() - begun_ns) / NS
            if isinstance(self.scheduler, Threads):
                self.scheduler.stop()
            for part in reversed(self._parts.values()):
                if not part.fault:
                    part.stop()
            self.executive.flush(self.clock.now_s())
            self.trace.close()

    def _until(self, is_over: Callable[[], bool]) -> None:
        if isinstance(self.scheduler, Lockstep):
            self._lockstep_until(self.scheduler, is_over)
        else:
            self._threads_until(self.scheduler, is_over)

    def _lockstep_until(self, scheduler: Lockstep, is_over: Callable[[], bool]) -> None:
        try:
            with Watchdog(lambda: scheduler.turns, LOCKSTEP_LIMIT_S):
                while not is_over():
                    scheduler.run_until(self.clock.now_ns() + NS // 2, lambda: not is_over())
                    self.options.on_progress(self)
        except Hung:
            if scheduler.current is None:
                raise
            self._hung(scheduler.current)

    def _threads_until(self, scheduler: Threads, is_over: Callable[[], bool]) -> None:
        while not is_over():
            wait(self._interrupt, 0.05)
            self.options.on_progress(self)
            stuck = scheduler.stuck_part(THREADS_LIMIT_S)
            if stuck is not None and stuck.fault != "hang":
                self._hung(stuck)

    def _is_over(self) -> bool:
        mission = self.executive.core.mission
        if self.ended is not None or (mission is not None and mission.is_over):
            return True
        if self._interrupt.is_set():
            self._end("STOPPED", "interrupted", "interrupted by Ctrl-C")
        elif self.options.max_time_s is not None and self.clock.now_s() >= self.options.max_time_s:
            self._end("STOPPED", "max-time", f"the mission was still running after --max-time {self.options.max_time_s:g} s")
        elif self._base_is_lost():
            self._end("STOPPED", "base-lost", f"the base has sent no odometry for {BASE_LOST_AFTER_S:g} s")
        return self.ended is not None

    def _base_is_lost(self) -> bool:
        raw = self.board.newest("ATRV2/Drive/Raw")
        return self.clock.now_s() - (0.0 if raw is None else raw.written_s) > BASE_LOST_AFTER_S

    def _settle(self) -> None:
        """Bring the robot to rest: stop every link, then let time pass until it stands."""
        if self._parts["executive"].fault != "hang":
            self.executive.core.abort(self.ended[1] if self.ended else "stopped")
        self.stop_robot("supervision")
        limit_s = self.clock.now_s() + STOP_WITHIN_S
        self._interrupt.clear()
        self._until(lambda: self.clock.now_s() >= limit_s or self._is_at_rest())

    def _is_at_rest(self) -> bool:
        speed_mps, turn_rate_radps = self.simulator.velocity
        return abs(speed_mps) < 1e-3 and abs(turn_rate_radps) < 1e-3
