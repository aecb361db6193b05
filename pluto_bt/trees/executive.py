"""The executive: one mission at a time, ticked, paused, resumed, stopped; it decides nothing that the tree does not decide.

Beside the mission there may be one errand: a single node that an operator runs while no mission does (or while it is paused);
and one job: the library tree of a complex command of motion, which a node of the mission, an errand or a raw command has asked for.
Start reading at `Executive.step`.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Final, NamedTuple, Protocol

from pluto_bt.trees.activity import ABORTED, IDLE, PAUSED, RUNNING, Activity
from pluto_bt.trees.mission import Mission

MODULE_ERROR: Final = "module-error"
PASSING: Final = (MODULE_ERROR,)  # reasons of pauses that end by themselves; that of a person takes their place, and does not


class Body(Protocol):
    """What the executive needs of the robot."""

    def refresh(self, now_s: float) -> None:
        """Take one consistent view of all topics for the coming tick."""

    def stop(self) -> None:
        """Zero velocity at once. Thread-safe."""

    def resumed(self) -> None:
        """A paused mission goes on: motion leaves have to command again."""


class Done(NamedTuple):
    """An order that was carried out: its verb, the run that it made or ended, a word or a text."""

    verb: str
    run: int = 0
    text: str = ""


class Executive:
    """Orders (start, pause, …) come from any thread and take effect at the next step; a pause stops the robot at once."""

    def __init__(self, body: Body, say: Callable[[str, str, str], None]) -> None:
        self._body = body
        self._say = say  # (level, code, text)
        self._orders: deque[tuple[Callable[[], None], dict[str, str]]] = deque()  # what to do; what it makes of the mission's state
        self._later: list[tuple[Callable[[], None], dict[str, str]]] = []  # orders of the next step
        self._done: list[Done] = []
        self._runs = 0
        self.mission: Activity | None = None
        self.errand: Activity | None = None
        self.job: Activity | None = None
        self._job_body = body
        self.on_begin: Callable[[Activity], None] = lambda activity: None  # before its first tick, in the thread that steps
        self.ticking: Activity | None = None  # for the watchdog: who is at work

    @property
    def active(self) -> Activity | None:
        """What is ticked: the errand while there is one, else the mission."""
        return self.errand if self.errand is not None and not self.errand.is_over else self.mission

    @property
    def shown(self) -> list[Activity]:
        """What people are shown: what is ticked, or would be if it were not paused or over; without a mission the last errand."""
        job = self.job if self.job is not None and not self.job.is_over else None
        return [activity for activity in (self.active or self.errand, job) if activity is not None]

    @property
    def coming_state(self) -> str:
        """The mission's state once all orders that wait are carried out: what a new order has to reckon with."""
        state = IDLE if self.mission is None else self.mission.state
        for _, turns in tuple(self._orders):
            state = turns.get(state, turns.get("", state))
        return state

    def note(self, verb: str, run: int = 0, text: str = "") -> None:
        """Remember that an order was carried out, for the black box. Called by the thread that steps."""
        self._done.append(Done(verb, run, text))

    def take_done(self) -> list[Done]:
        """What was carried out since the last call."""
        done, self._done = self._done, []
        return done

    def order(self, act: Callable[[], None]) -> None:
        """Let `act` take place at the next step, before the tick. Thread-safe."""
        self._orders.append((act, {}))

    def step(self, now_s: float) -> list[Activity]:
        """One turn: orders, a fresh view, one decision of the mission and one of the job. Gives what was ticked."""
        self._orders.extend(self._later)
        self._later.clear()
        while self._orders:
            self._orders.popleft()[0]()
        ticked = [activity for activity in (self.active, self.job) if activity is not None and activity.state == RUNNING]
        if not ticked:
            return ticked
        self._body.refresh(now_s)
        for activity in ticked:
            if activity is self.job:
                self._job_body.refresh(now_s)
            self.ticking = activity
            activity.tick()
            if activity.is_over:
                self._close(activity)
        self.ticking = None
        return ticked

    def _close(self, activity: Activity) -> None:
        """The end of a mission or an errand brings the robot to rest; after that of a job motion does it."""
        if activity is not self.job:
            self._body.stop()
        if activity.error is not None:
            self._say("error", "leaf-error", activity.text)

    def start(self, mission: Mission, held: str = "") -> None:
        """Run `mission` from its beginning at the next step; one that runs is ended. With `held`, a word, it waits for `resume` first."""
        self._orders.append((lambda: self._start(mission, held), {"": PAUSED if held else RUNNING}))

    def start_errand(self, mission: Mission) -> Activity:
        """Run a single node beside a mission that does not run; an errand that goes on is ended."""
        self._runs += 1
        errand = Activity(mission, self._runs)
        self._orders.append((lambda: self._start_errand(errand), {}))
        return errand

    def start_job(self, mission: Mission, body: Body) -> None:
        """Run the tree of a job from its beginning at once; one that runs is ended. Called by the thread that steps."""
        self.end_job("preempted")
        self._runs += 1
        self.job, self._job_body = Activity(mission, self._runs), body
        self.note("start-job", self._runs)
        self.on_begin(self.job)

    def end_job(self, reason: str) -> None:
        """Halt the tree of the job; harmless if it is over. Called by the thread that steps."""
        if self.job is not None:
            self._end(self.job, reason)

    def end_errand(self, errand: Activity, reason: str) -> None:
        """End an errand; harmless if it is over."""
        if not errand.is_over:
            self._body.stop()
            self._orders.append((lambda: self._end_errand(errand, reason), {}))

    def pause(self, reason: str) -> None:
        """Stop the robot now; the mission waits for `resume`, an errand ends. Thread-safe."""
        self._orders.append((lambda: self._pause(reason), {RUNNING: PAUSED}))  # first, so that no tick sees the stop as an interruption
        self._body.stop()

    def resume(self) -> None:
        """Let a paused mission go on where its tree stands; motion leaves command again when they are next ticked."""
        self._orders.append((self._resume, {PAUSED: RUNNING}))

    def resume_after(self, reason: str, may: Callable[[], bool]) -> None:
        """As `resume`, a step later, if it is for this reason that the mission waits, nobody is at an errand, and it `may` then. Thread-safe.

        A step later because the stop that came with the pause may still be on its way, and no command overtakes a stop.
        """

        def act() -> None:
            is_waiting = self.mission is not None and self.mission.state == PAUSED and self.mission.reason == reason
            if is_waiting and (self.errand is None or self.errand.is_over) and may():
                self._resume()

        self._orders.append((lambda: self._later.append((act, {})), {}))

    def let_go(self) -> None:
        """Stop the robot if something is at work; it stays in its state, and goes on when `step` is called again."""
        if self.active is not None and self.active.state == RUNNING:
            self._body.stop()

    def abort(self, reason: str) -> None:
        """Stop the robot now and end the mission and any errand."""
        self._body.stop()
        self._orders.append((lambda: self._abort(reason), {RUNNING: ABORTED, PAUSED: ABORTED}))

    def _end(self, activity: Activity, reason: str) -> None:
        """Halt an activity for good; a leaf that raises while it lets go is told. Harmless if it is over."""
        if activity.is_over:
            return
        activity.end(reason)
        if activity.error is not None:
            self._say("error", "leaf-error", activity.text)

    def _start(self, mission: Mission, held: str) -> None:
        self._abort("preempted")
        self._runs += 1
        self.mission = Activity(mission, self._runs)
        if held:
            self.mission.state, self.mission.reason = PAUSED, held
        self.note("start-held" if held else "start", self._runs, held)
        self.on_begin(self.mission)

    def _start_errand(self, errand: Activity) -> None:
        if self.errand is not None:
            self._end(self.errand, "preempted")
        self.errand = errand
        self.note("start-errand", errand.number)
        self.on_begin(errand)

    def _end_errand(self, errand: Activity, reason: str) -> None:
        self._end(errand, reason)
        self.note("end-errand", errand.number, reason)

    def _pause(self, reason: str) -> None:
        self.note("pause", text=reason)
        if self.errand is not None:
            self._end(self.errand, reason)
        if self.mission is None or reason == self.mission.reason:
            return
        if self.mission.state == RUNNING or (self.mission.state == PAUSED and self.mission.reason in PASSING):
            self.mission.state, self.mission.reason = PAUSED, reason
            self._say("warning", reason, f"mission paused: {reason}")

    def _resume(self) -> None:
        self.note("resume")
        if self.errand is not None:
            self._end(self.errand, "preempted")
        if self.mission is not None and self.mission.state == PAUSED:
            self.mission.state, self.mission.reason = RUNNING, ""
            self._body.resumed()
            self._say("info", "resumed", "mission goes on")

    def _abort(self, reason: str) -> None:
        self.note("abort", text=reason)
        for activity in (self.errand, self.mission):
            if activity is not None:
                self._end(activity, reason)
