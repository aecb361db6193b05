"""Motion: passes simple commands on to avoidance, keeps rectangle and home, and orders the complex jobs 42 to 45 (Pluto manual, 6.3).

A job is a library tree that the executive runs; motion says when, hears how it stands, and shows it in `element[2..3]`.
"""

from __future__ import annotations

import msgspec

from pluto_bt.blackboard.codes import Avoidance, CommandType, GotoStatus, LinkStatus, MotionCommand, MotionStatus, MovetoStatus, split_flags
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, JobState
from pluto_bt.skills import reasons
from pluto_bt.skills.drive import is_finite
from pluto_bt.skills.jobs import Job
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.rectangle import Rectangle
from pluto_bt.skills.verdict import ALL_WELL, Verdict

__all__ = ["Motion", "MotionParameters", "Rectangle"]

JOBS = (MotionCommand.MOVETO, MotionCommand.INVESTIGATE, MotionCommand.EXPLORE)
ON_ITS_WAY = (MovetoStatus.SET, MovetoStatus.NEAR_GOAL)
SPEED, AVOID = 1, 2  # our own in `force` of 42 to 44, where it has so many numbers: highest speed (m/s, 0 = the parameter), and A
SUCCEEDED, RUNNING = "succeeded", "running"
WHATEVER_THE_COMMAND = (LinkStatus.STOPPED_THREAD, LinkStatus.LASER_FATAL)  # these are not of an earlier command


class Motion:
    """The state of motion between two commands. `order` is what the executive is to run now: a job, or None to end the one it runs."""

    def __init__(self, parameters: MotionParameters, avoid: Avoidance = Avoidance.BOTH, has_laser: bool = True) -> None:
        self.parameters = parameters
        self.rectangle: Rectangle | None = None
        self._avoid, self._has_laser = avoid, has_laser
        self._orders = 0
        self.job: Job | None = None  # the one at work
        self.kept: Job | None = None  # the one that was stopped and can be taken up again
        self.moveto = MovetoStatus.NONE
        self.reset()

    def reset(self) -> None:
        """No command. The rectangle outlives a restart of the thread, and a job that it stopped can be taken up again."""
        self.command: ActuatorState | None = None
        self.verdict = ALL_WELL
        self._end_job()
        self._phase, self._is_ordered = MotionStatus.AT_REST, False

    def order(self) -> tuple[bool, Job | None]:
        """(whether there is a new order, the job to run or None to end it), once."""
        is_ordered, self._is_ordered = self._is_ordered, False
        return is_ordered, self.job

    def accept(self, command: ActuatorState, now_s: float, pose: Planar | None = None) -> ActuatorState | None:
        """Take a command; the one to pass down to avoidance, or None where there is none to pass. `pose` is interface 3, None if unknown.

        What goes down is stamped anew, so that every order of motion is a new one for the links below, whatever stamp its sender wrote.
        46 only sets: a simple command in force is not touched, and a job at work goes on inside the new rectangle, or fails if it cannot.
        """
        if command.flags == MotionCommand.RESUME and self.job is not None and is_finite(command):
            self.command = command  # it goes on already
            return None
        self.command, self.verdict = command, ALL_WELL
        was_at_work = self.job is not None
        self._end_job()
        if not is_finite(command):
            return self._refuse(now_s, "a number of the command is missing or not finite")
        if split_flags(command.flags) is not None:
            return msgspec.structs.replace(command, stamp_s=now_s)
        if command.flags == MotionCommand.SET_RECTANGLE:
            refused = self._set_rectangle(command.velocity, (*command.position, command.force[0] if command.force else 0.0))
            if refused:
                return self._refuse(now_s, refused)
            return self._begin_job(msgspec.structs.replace(command, flags=int(MotionCommand.RESUME)), now_s, pose) if was_at_work else None
        if command.flags in (*JOBS, MotionCommand.RESUME):
            return self._begin_job(command, now_s, pose)
        return self._refuse(now_s, f"motion takes cmdFlags 10*A + T with A, T 0 to 3, 42 to 46, or -1; not {command.flags}")

    def stop(self, command: ActuatorState) -> None:
        """Stop was commanded; the adapter sends it down. A job can be taken up again."""
        self._end_job()
        self.command, self.verdict = command, Verdict(reason=reasons.STOPPED, text="stop was commanded")

    def hear(self, state: JobState) -> None:
        """How the job stands, as the executive says."""
        if self.job is None or state.number != self.job.number:
            return
        self.moveto, self._phase = MovetoStatus(state.moveto), MotionStatus(state.motion)
        if state.state == RUNNING:
            return
        self.job = None
        if state.state != SUCCEEDED:
            self.moveto = MovetoStatus.NONE
            self.verdict = Verdict(reason=state.reason, text=state.text)

    def status(self, now_s: float, avoid: FVectorState | None, sent: ActuatorState | None) -> FVectorState:
        """`motion/status`: data and element[0..1] are avoidance's; a stopped link below and a rebooting laser show always.

        Args:
            sent: what went down and avoidance has not accepted yet, so that its status is still that of an earlier command; else None.
        """
        data: tuple[float, ...] = (0.0, 0.0)
        flags = None if sent is None else split_flags(sent.flags)
        link, goto = 0, int(GotoStatus.RUNNING if flags is not None and flags[1] is CommandType.GOTO else GotoStatus.NONE)
        reason, text = self.verdict.reason, self.verdict.text
        if avoid is not None:
            data = avoid.data
            is_dead = avoid.element[1] == GotoStatus.STOPPED_THREAD
            if sent is None or is_dead or avoid.element[0] in WHATEVER_THE_COMMAND:
                link, goto = avoid.element[0], avoid.element[1] if sent is None or is_dead else goto
                if not reason:
                    reason, text = avoid.reason, avoid.text
        return FVectorState(now_s, data, (link, goto, int(self.moveto), int(self._shown())), reason, text)

    def _shown(self) -> MotionStatus:
        if self.job is not None:
            return self._phase
        return MotionStatus.AT_REST if self.rectangle is None else MotionStatus.AT_REST_WITH_RECTANGLE

    # ------------------------------------------------------------------ jobs

    def _end_job(self) -> None:
        """A new command or a stop: the job at work is kept; what was reached is shown no more."""
        if self.job is not None:
            self.job, self.kept, self._is_ordered = None, self.job, True
        self.moveto = MovetoStatus.SET if self.kept is not None and self.moveto in ON_ITS_WAY else MovetoStatus.NONE

    def _begin_job(self, command: ActuatorState, now_s: float, pose: Planar | None) -> ActuatorState:
        """42 to 45: zero velocity, and the order for the executive; or zero velocity and a reason."""
        self.verdict = self._job_trouble(command, pose)
        self.moveto = MovetoStatus.NONE
        if self.verdict == ALL_WELL and pose is not None:
            job = self._resumed() if command.flags == MotionCommand.RESUME else self._new_job(command, pose)
            self.verdict = self._place_trouble(job, pose)
            if self.verdict == ALL_WELL:
                self._orders += 1
                self.kept = None
                self.job, self._is_ordered = job._replace(number=self._orders, rectangle=self.rectangle), True
                self.moveto = MovetoStatus.SET if job.kind == MotionCommand.MOVETO else MovetoStatus.NONE
                self._phase = MotionStatus.APPROACHING_OBJECT if job.kind == MotionCommand.INVESTIGATE else MotionStatus.SCANNING_FOR_PATHS
        return ActuatorState(now_s)

    def _job_trouble(self, command: ActuatorState, pose: Planar | None) -> Verdict:
        """Why a job cannot begin, whatever its place."""
        if not self._has_laser:
            return Verdict(reason=reasons.NO_DEVICE, text="the jobs of motion need a laser")
        if pose is None:
            return Verdict(reason=reasons.NO_POSE, text="it is not known where the robot is")
        if command.flags == MotionCommand.RESUME and self.kept is None and self.rectangle is None:
            return Verdict(reason=reasons.NOTHING_TO_RESUME, text="nothing was stopped, and no rectangle is set")
        if command.flags == MotionCommand.EXPLORE:
            refused = self._set_rectangle(command.velocity, pose)
            return Verdict(reason=reasons.BAD_COMMAND, text=refused) if refused else ALL_WELL
        return ALL_WELL

    def _place_trouble(self, job: Job, pose: Planar) -> Verdict:
        """Goal and start must lie inside the rectangle."""
        rectangle = self.rectangle
        for what, place in (("the start", pose[:2]), ("the goal", job.place)):
            if rectangle is not None and not rectangle.holds(*place):
                text = f"{what} ({place[0]:.1f}, {place[1]:.1f}) lies {-rectangle.depth_m(*place):.1f} m outside the rectangle"
                return Verdict(reason=reasons.OUTSIDE_RECTANGLE, text=text)
        return ALL_WELL

    def _new_job(self, command: ActuatorState, pose: Planar) -> Job:
        force = command.force
        speed_mps = force[SPEED] if len(force) > SPEED and force[SPEED] > 0.0 else self.parameters.speed_mps
        avoid = Avoidance(int(force[AVOID])) if len(force) > AVOID and force[AVOID] in tuple(Avoidance) else self._avoid
        place = command.position if command.flags == MotionCommand.MOVETO else pose[:2]
        radius_m, turns = command.velocity if command.flags == MotionCommand.INVESTIGATE else (0.0, 0.0)
        radius_m = radius_m if radius_m > 0.0 else self.parameters.circle_radius_m
        return Job(0, MotionCommand(command.flags), place, speed_mps, avoid & self._avoid, radius_m, turns if turns > 0.0 else 1.0)

    def _resumed(self) -> Job:
        """What 45 means: the stopped job, else explore with the rectangle and its home."""
        if self.kept is not None:
            return self.kept._replace(goes_on=True)
        assert self.rectangle is not None  # else there was trouble
        return Job(0, MotionCommand.EXPLORE, self.rectangle.home[:2], self.parameters.speed_mps, self._avoid)

    def _set_rectangle(self, sides: tuple[float, float], home: Planar) -> str:
        """(b, h) = velocity; b = 0 removes the rectangle. They carry metres, so no limit of speed applies. Gives why it is refused, or ""."""
        base_m, height_m = sides
        if base_m == 0.0:
            self.rectangle = None
            return ""
        most_m = self.parameters.max_rectangle_m
        if not (0.0 < base_m <= most_m and 0.0 < height_m <= most_m):
            return f"a rectangle needs 0 < b, h <= {most_m:g} m (b = 0 removes it); not b = {base_m:g}, h = {height_m:g}"
        self.rectangle = Rectangle(base_m, height_m, home)
        if self.kept is not None and self.kept.kind == MotionCommand.EXPLORE:
            self.kept = self.kept._replace(place=home[:2])
        return ""

    def _refuse(self, now_s: float, text: str) -> ActuatorState:
        self.verdict = Verdict(LinkStatus.NORMAL, reasons.BAD_COMMAND, text)
        return ActuatorState(now_s)
