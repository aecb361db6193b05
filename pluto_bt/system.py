"""One robot as a whole: THE table of modules, and the `System` that makes them and joins them. `pluto_bt.loop` runs it.

Everything that runs is a row of MODULES; equal due times run in this order: the world and the devices, then the pose, then the chain from
below, so that a status reaches the top in one go; a command wakes each link on its way down. There is no module state: several systems fit one process.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from pluto_bt.blackboard import TOPICS, Blackboard, Inbox
from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.guard import Guard
from pluto_bt.modules.context import Context
from pluto_bt.modules.notebook import Notebook
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.modules.robot_link import RobotLink
from pluto_bt.run_options import Options
from pluto_bt.runtime.clock import NS, MonotonicClock, VirtualClock
from pluto_bt.runtime.latch import OPERATOR_STOP, SafetyLatch
from pluto_bt.runtime.lockstep import Lockstep
from pluto_bt.runtime.supervision import Part
from pluto_bt.runtime.table import Module, in_start_order
from pluto_bt.runtime.threads import Threads
from pluto_bt.runtime.trace import Trace
from pluto_bt.track import Track

if TYPE_CHECKING:
    from pluto_bt.modules.recorder import Recorder

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
    Module("arm",       "pluto_bt.modules.arm:Arm",               0.1,    "io",         device="arm",                                   budget_ms=1.0),
    Module("speed",     "pluto_bt.modules.speed:Speed",           0.1,    "io",         device="speed",                                 budget_ms=1.0),
    Module("marker",    "pluto_bt.modules.marker:Marker",         0.1,    "io",         device="marker", needs=("local",),              budget_ms=1.0),
    Module("local",     "pluto_bt.modules.local:Local",           0.0,    "estimation", critical=True, needs=("base",),                 budget_ms=2.0,
           wakes=("ATRV2/Drive/Raw", "sick/timing")),
    Module("alarms",    "pluto_bt.modules.alarms:Alarms",         0.05,   "estimation", needs=("base",),                                budget_ms=1.0),
    Module("filter",    "pluto_bt.modules.filter:Filter",         0.05,   "chain",      critical=True, needs=("base", "local"), wakes=("inbox:filter",), budget_ms=5.0),
    Module("drive",     "pluto_bt.modules.drive:Drive",           0.05,   "chain",      critical=True, needs=("filter",), wakes=("inbox:drive",), budget_ms=2.0),
    Module("avoid",     "pluto_bt.modules.avoid:Avoid",           0.1,    "chain",      critical=True, needs=("drive",), wakes=("inbox:avoid",), budget_ms=10.0),
    Module("motion",    "pluto_bt.modules.motion:Motion",         0.1,    "chain",      critical=True, needs=("avoid",), wakes=("inbox:motion", "inbox:job"), budget_ms=5.0),
    Module("executive", "pluto_bt.modules.executive:Executive",   0.1,    "mission",    critical=True, needs=("motion",),               budget_ms=20.0),
    Module("gateway",   "pluto_bt.modules.gateway:Gateway",       0.02,   "gateway",    needs=("executive",), device="gateway",             budget_ms=20.0),
    Module("groot",     "pluto_bt.modules.groot:Groot",           1.0,    "gateway",    needs=("executive",), device="groot",               budget_ms=1.0),
    Module("ssh",       "pluto_bt.modules.ssh:Ssh",               0.5,    "gateway",    needs=("gateway",), device="ssh",                     budget_ms=1.0),
    Module("recorder",  "pluto_bt.modules.recorder:Recorder",     0.5,    "recorder",   needs=("executive",), device="recorder",            budget_ms=20.0),
)
# fmt: on

INBOXES = {  # link -> the link above, which owns its inbox
    "base": "filter", "filter": "drive", "drive": "avoid", "avoid": "motion", "motion": "", "job": "", "wrist": "", "arm": "", "alarms": "",
}  # fmt: skip


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
        self.guard = Guard(self)
        self.simulator.on_software_fault = self.guard.software_fault
        self._parts: dict[str, Part] = {}
        self.latch = SafetyLatch()
        self.inboxes = {link: Inbox(link, self._owner_rule(link, above)) for link, above in INBOXES.items()}
        self.context = self._make_context()
        has = {*self.simulator.devices, *options.asked_modules}
        self._make_parts([row for row in modules if not row.device or row.device in has])
        self._join()

    # ------------------------------------------------------------------ making

    def _make_context(self) -> Context:
        context = Context(
            board=self.board, clock=self.clock, platform=self.options.robot, inboxes=self.inboxes, devices=self.simulator.devices,
            map=self.options.map or self.options.world, say=self.say, is_running=self.is_running, start_pose=self.simulator.pose,
            order_module=self.order_module, silent_s=self.silent_s, latch=self.latch, joined=self, own_clock=self.options.own_clock,
            black_box=None if self.options.record is None else Notebook(TOPICS, self.options.robot.record.thinned_period_s),
        )  # fmt: skip
        self.robot = RobotLink(context)
        return context

    def _make_parts(self, rows: list[Module]) -> None:
        made: dict[str, Any] = {row.name: row.load()(self.context) for row in in_start_order(rows)}
        self._parts = {row.name: Part(row, made[row.name], number, self.guard) for number, row in enumerate(rows)}
        self.executive = made["executive"]
        self.recorder: Recorder | None = made.get("recorder")
        self.executive.on_event = self.options.on_event

    def _join(self) -> None:
        parts = tuple(self._parts.values())
        self.scheduler = Threads(parts, self.clock) if isinstance(self.clock, MonotonicClock) else Lockstep(parts, self.clock)
        for part in parts:
            for source in part.module.wakes:
                _, _, name = source.rpartition("inbox:")
                wake = self.scheduler.waker(part.row)
                if "inbox:" in source:
                    self.inboxes[name].on_post(wake, self.scheduler.waker(part.row, for_stop=True))
                else:
                    self.board.on_change(source, wake)
        for topic in self.board.topics:
            if topic.type is ActuatorState and topic.name.lower().endswith("/command"):
                self.board.on_change(topic.name, self._trace_command(topic.name))
        self.board.on_change("world/state", self._follow)

    def _owner_rule(self, link: str, above: str) -> Callable[[str], bool]:
        """Who may post to an inbox: the link above while it runs; else whoever is no link (the mission, the lease holder).

        While the safety latch holds nobody may; but the filter still tells the base to stand still, and wrist and alarms move nobody.
        """

        def is_owner(source: str) -> bool:
            if self.latch.held is not None and link not in ("base", "wrist", "alarms"):
                return False
            return source == above if above and (self.is_running(above) or link == "base") else source not in INBOXES

        return is_owner

    def running_above(self, link: str) -> list[str]:
        """The links above this one that run, the highest first: they stop in this order."""
        above, running = INBOXES[link], []
        while above:
            running += [above] if self.is_running(above) else []
            above = INBOXES[above]
        return running[::-1]

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

    def part(self, name: str) -> Part | None:
        """A module at work, None if this robot has none of that name."""
        return self._parts.get(name)

    def order_module(self, name: str, run: bool) -> None:
        """Start a module, after all that it needs; or stop it. Raises KeyError if there is none of that name."""
        part = self._parts[name]
        for need in part.module.needs if run else ():
            if need in self._parts and not self._parts[need].is_running:
                self.order_module(need, True)
        part.order(run)
        self.scheduler.waker(part.row, for_stop=not run)()

    def tune(self, robot: RobotFile) -> None:
        """Other parameters: each module takes them between two steps, what is made later begins with them. Thread-safe."""
        self.context.platform = robot
        for part in self._parts.values():
            take = getattr(part.component, "tune", None)
            if take is not None:
                part.hand(partial(take, robot))

    def stop_robot(self, source: str) -> None:
        """Zero velocity at once, on every link."""
        now_s = self.clock.now_s()
        for link in ("base", "filter", "drive", "avoid", "motion"):
            self.inboxes[link].stop(source, now_s)

    def operator_stop(self, source: str, why: str = OPERATOR_STOP) -> None:
        """Zero velocity at once, latched until somebody commands anew; a running mission pauses for the reason `why`. Thread-safe."""
        self.latch.set(OPERATOR_STOP, f"{source} stopped the robot")
        self.executive.core.pause(why)  # before the links are stopped, so that no tick takes the stop for a failure
        self.stop_robot(source)

    def operator_resume(self) -> None:
        """Take the operator's stop back, and let a paused mission go on; an emergency stop goes on holding. Thread-safe."""
        self.latch.release(OPERATOR_STOP)
        self.executive.core.resume()

    def start_parts(self) -> None:
        """Start every module, each after all that it needs."""
        now_ns = self.clock.now_ns()
        for row in in_start_order([part.module for part in self._parts.values()]):
            self._parts[row.name].start(now_ns)

    def stop_parts(self) -> None:
        """Stop every module, last one first; one that hangs is left alone."""
        for part in reversed(self._parts.values()):
            if not part.fault:
                part.stop()
