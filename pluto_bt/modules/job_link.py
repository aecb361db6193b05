"""The robot as the tree of a job sees it: it commands through motion's hands, on behalf of the job."""

from __future__ import annotations

from typing import Final

from pluto_bt.behaviours.robot import Ticket
from pluto_bt.blackboard.codes import GotoStatus, MotionStatus, MovetoStatus
from pluto_bt.blackboard.messages import ActuatorState, FloatArray, FVectorState
from pluto_bt.modules.context import Context
from pluto_bt.modules.robot_link import RobotLink, spoken_of
from pluto_bt.skills.jobs import Job
from pluto_bt.skills.limits import STILL

INBOX: Final = "job"
AVOIDANCE_COMMAND, AVOIDANCE_STATUS = "avoidance/command", "avoidance/status"


class JobLink(RobotLink):
    """Implements `Robot`. What motion passes down for the job goes unchanged to avoidance, so avoidance's status speaks of it."""

    def __init__(self, context: Context, robot: RobotLink, job: Job) -> None:
        super().__init__(context)
        self._robot, self._job = robot, job
        self.on_command = robot.on_command
        self._last: Ticket | None = None
        self.moveto, self.motion = MovetoStatus.NONE, MotionStatus.SCANNING_FOR_PATHS
        self._surroundings = robot.surroundings

    def refresh(self, now_s: float) -> None:
        """See what the mission sees in this tick."""
        self._snapshot = self._robot.snapshot

    def _send(self, command: ActuatorState, on_the_way: bool) -> Ticket:
        """Post it for motion to pass down. A goto that has arrived stands already: no zero velocity takes its status away."""
        if command.flags == 0 and command.velocity == STILL and self._has_arrived():
            assert self._last is not None
            return self._last
        self._last = self._post(INBOX, self._job.source, command)
        return self._last

    def status(self, ticket: Ticket) -> FVectorState | None:
        """`avoidance/status` as far as it speaks of this command."""
        return spoken_of(self._snapshot, AVOIDANCE_COMMAND, AVOIDANCE_STATUS, ticket.command)

    def show_phase(self, moveto: MovetoStatus | None, motion: MotionStatus | None) -> None:
        """What motion shows of this job."""
        self.moveto = self.moveto if moveto is None else moveto
        self.motion = self.motion if motion is None else motion

    def show_path(self, points: FloatArray) -> None:
        """What the mission would show."""
        self._robot.show_path(points)

    def _has_arrived(self) -> bool:
        status = None if self._last is None else self.status(self._last)
        return status is not None and status.element[1] == GotoStatus.REACHED
