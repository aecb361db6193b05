"""The module `motion`: the top of the chain, where missions and operators post."""

from __future__ import annotations

from pluto_bt.blackboard.codes import GotoStatus, LinkStatus, MotionStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import RELEASE, Link, below
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.motion import Motion as Skill
from pluto_bt.skills.motion import MotionParameters


class Motion:
    """Steps at 10 Hz, and at once when a command comes."""

    def __init__(self, context: Context) -> None:
        self._link = Link(context, "motion", "motion")
        self._clock = context.clock
        self._avoid = context.inboxes["avoid"]
        self._skill = Skill(context.parameters(MotionParameters))
        self._avoid_status, self._avoid_command = below(context, "avoidance")
        self._sent: ActuatorState | None = None

    def start(self, now_s: float) -> None:
        """Begin without a command."""
        if not self._link.is_running:
            self._skill.reset()
            self._sent = None
            self._link.start()

    def step(self, now_s: float) -> None:
        """Take a command, pass it down, tell the status."""
        letter = self._link.letter()
        if letter is not None and letter.is_stop:
            self._avoid.stop("motion", now_s)
            self._skill.stop(letter.command)
            self._sent = None
        if not self._link.is_running:
            self._link.tell(now_s, self._rest(now_s), letter.command if letter is not None and letter.is_stop else None)
            return
        if letter is not None and not letter.is_stop:
            if letter.command.flags == RELEASE:
                self._avoid.post("motion", ActuatorState(now_s, RELEASE))
                self._link.release()
                self._link.tell(now_s, self._rest(now_s), letter.command)
                return
            command = self._skill.accept(letter.command, now_s)
            if command is not None:
                self._avoid.post("motion", command)
                self._sent = command
        has_it = self._sent is None or self._avoid_command() == self._sent
        self._link.tell(now_s, self._skill.status(now_s, self._avoid_status(), has_it), None if letter is None else letter.command)

    def stop(self) -> None:
        """The thread stops and shows -10. Avoidance goes on: stopping motion does not stop it."""
        now_s = self._clock.now_s()
        self._link.is_running = False
        self._link.tell(now_s, self._rest(now_s))

    def _rest(self, now_s: float) -> FVectorState:
        element: tuple[int, ...] = (int(LinkStatus.STOPPED_THREAD), int(GotoStatus.STOPPED_THREAD), 0, int(MotionStatus.STOPPED_THREAD))
        status: FVectorState | None = self._avoid_status()
        if status is not None:
            element = (*status.element, 0, int(MotionStatus.STOPPED_THREAD))
        return FVectorState(now_s, STILL if status is None else status.data, element, reasons.STOPPED, "the motion thread is stopped")
