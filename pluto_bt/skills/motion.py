"""Motion: passes simple commands on to avoidance, keeps rectangle and home, and starts the complex jobs 42 to 45 (Pluto manual, 6.3)."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import msgspec
from msgspec import Meta

from pluto_bt.blackboard.codes import GotoStatus, LinkStatus, MotionCommand, MotionStatus, MovetoStatus, split_flags
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.maps.platform import Positive
from pluto_bt.skills import reasons
from pluto_bt.skills.drive import is_finite
from pluto_bt.skills.verdict import ALL_WELL, Verdict

JOBS = (MotionCommand.MOVETO, MotionCommand.INVESTIGATE, MotionCommand.EXPLORE, MotionCommand.RESUME)


class MotionParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Table [motion] of a platform file."""

    max_rectangle_m: Annotated[Positive, Meta(description="a rectangle with a longer side is refused")] = 10_000.0


class Rectangle(NamedTuple):
    """The region that limits the jobs: x' in [0, height], y' in [-base, base] in the frame of home (the base is 2 * base_m long)."""

    base_m: float
    height_m: float
    home: tuple[float, float, float]  # x m, y m, theta rad: middle of the base, looking into the rectangle


class Motion:
    """The state of motion between two commands."""

    def __init__(self, parameters: MotionParameters) -> None:
        self.parameters = parameters
        self.rectangle: Rectangle | None = None
        self.reset()

    def reset(self) -> None:
        """No command. The rectangle outlives a restart of the thread."""
        self.command: ActuatorState | None = None
        self.verdict = ALL_WELL
        self.moveto = MovetoStatus.NONE

    def accept(self, command: ActuatorState, now_s: float) -> ActuatorState | None:
        """Take a command; the one to pass down to avoidance, or None where there is none to pass.

        What goes down is stamped anew, so that every order of motion is a new one for the links below, whatever stamp its sender wrote.
        """
        self.command, self.verdict = command, ALL_WELL
        if not is_finite(command):
            return self._refuse(now_s, "the command has a number that is not finite")
        if split_flags(command.flags) is not None:
            return msgspec.structs.replace(command, stamp_s=now_s)
        if command.flags == MotionCommand.SET_RECTANGLE:
            return self._set_rectangle(command, now_s)
        if command.flags in JOBS:
            return self._refuse(now_s, f"cmdFlags {command.flags} needs a library tree that this version does not have yet")
        return self._refuse(now_s, f"motion takes cmdFlags 10*A + T with A, T 0 to 3, 42 to 46, or -1; not {command.flags}")

    def stop(self, command: ActuatorState) -> None:
        """Stop was commanded; the adapter sends it down."""
        self.command, self.verdict = command, Verdict(reason=reasons.STOPPED, text="stop was commanded")

    def status(self, now_s: float, avoid: FVectorState | None, avoid_has_it: bool) -> FVectorState:
        """`motion/status`: data and element[0..1] are avoidance's once it has accepted our last command; a stopped avoidance shows always."""
        data: tuple[float, ...] = (0.0, 0.0)
        link, goto = 0, 0
        reason, text = self.verdict.reason, self.verdict.text
        if avoid is not None:
            data = avoid.data
            if avoid_has_it or avoid.element[1] == GotoStatus.STOPPED_THREAD:
                link, goto = avoid.element
                if not reason:
                    reason, text = avoid.reason, avoid.text
        return FVectorState(now_s, data, (link, goto, int(self.moveto), int(self._rest())), reason, text)

    def _rest(self) -> MotionStatus:
        return MotionStatus.AT_REST if self.rectangle is None else MotionStatus.AT_REST_WITH_RECTANGLE

    def _set_rectangle(self, command: ActuatorState, now_s: float) -> ActuatorState | None:
        """46: (b, h) = velocity, home = position and force[0]; b = 0 removes. It carries metres, so no limit of speed applies; nothing goes down."""
        base_m, height_m = command.velocity
        if base_m == 0.0:
            self.rectangle = None
            return None
        most_m = self.parameters.max_rectangle_m
        if not (0.0 < base_m <= most_m and 0.0 < height_m <= most_m):
            return self._refuse(now_s, f"a rectangle needs 0 < b, h <= {most_m:g} m (b = 0 removes it); not b = {base_m:g}, h = {height_m:g}")
        self.rectangle = Rectangle(base_m, height_m, (*command.position, command.force[0] if command.force else 0.0))
        return None

    def _refuse(self, now_s: float, text: str) -> ActuatorState:
        self.verdict = Verdict(LinkStatus.NORMAL, reasons.BAD_COMMAND, text)
        return ActuatorState(now_s)
