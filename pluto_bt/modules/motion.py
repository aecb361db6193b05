"""The module `motion`: the top of the chain, where missions and operators post."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

from pluto_bt.blackboard.codes import Avoidance, CommandType, GotoStatus, LinkStatus, MotionStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState, JobState, Pose, RectangleState
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import RELEASE, Link, below, newest
from pluto_bt.skills import reasons
from pluto_bt.skills.limits import STILL
from pluto_bt.skills.motion import Motion as Skill
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Planar
from pluto_bt.skills.rectangle import Rectangle

if TYPE_CHECKING:
    from pluto_bt.modules.robot_file import RobotFile

POSE_STALE_S = 1.0  # a job may be ordered with an older pose than one may steer by
REFRESH_S = 1.0  # a job that stands (it unfolds the arm, waits for people) renews its zero velocity so often, so that drive does not time out


class Motion:
    """Steps at 10 Hz, and at once when a command comes. Jobs are ordered through `context.jobs`; their trees post to the inbox `job`."""

    def __init__(self, context: Context) -> None:
        self._link = Link(context, "motion", "motion")
        self._clock, self._jobs = context.clock, context.jobs
        self._avoid = context.inboxes["avoid"]
        self._job_inbox = context.inboxes.get("job")
        devices = context.platform.devices
        has = (Avoidance.SONAR if devices.sonar else 0) | (Avoidance.LASER if devices.laser else 0)
        self._skill = Skill(context.parameters(MotionParameters), Avoidance(has), devices.laser is not None)
        self._pose, self._job_state = newest(context, "Localization/Pose"), newest(context, "motion/job")
        self._avoid_status, self._avoid_command = below(context, "avoidance")
        self._sent: ActuatorState | None = None  # what avoidance has not accepted yet
        self._down, self._down_s = ActuatorState(0.0), 0.0  # what was passed down last, and when
        self._rectangle = context.board.publisher("motion/rectangle", "motion")
        self._shown: Rectangle | None = None

    def start(self, now_s: float) -> None:
        """Begin without a command."""
        if not self._link.is_running:
            self._skill.reset()
            self._sent = None
            self._link.start()

    def tune(self, robot: RobotFile) -> None:
        """Parameters have changed."""
        self._skill.parameters = robot.motion

    def step(self, now_s: float) -> None:
        """Take a command, pass it down, tell the status."""
        letter = self._link.letter()
        if letter is not None and letter.is_stop:
            self._avoid.stop("motion", now_s)
            self._skill.stop(letter.command)
            self._order()
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
            self._pass_down(self._skill.accept(letter.command, now_s, self._where(now_s)), now_s)
            self._show(now_s)
            self._order()
        self._work_for_the_job(now_s)
        status: FVectorState | None = self._avoid_status()
        is_dropped = status is not None and status.element[1] == GotoStatus.STOPPED_THREAD
        if is_dropped or self._avoid_command() == self._sent:
            self._sent = None
        self._link.tell(now_s, self._skill.status(now_s, status, self._sent), None if letter is None else letter.command)

    def stop(self) -> None:
        """The thread stops and shows -10. Avoidance goes on: stopping motion does not stop it; a job ends."""
        now_s, last = self._clock.now_s(), self._rest(self._clock.now_s())
        if self._skill.job is not None:
            self._avoid.stop("motion", now_s)
            self._jobs.put(None)
            self._skill.reset()
            last = msgspec.structs.replace(last, data=STILL, element=(last.element[0], int(GotoStatus.NONE), *last.element[2:]))
        self._link.is_running = False
        self._link.tell(now_s, last)

    def _pass_down(self, command: ActuatorState | None, now_s: float) -> None:
        if command is not None:
            self._avoid.post("motion", command)
            self._sent = self._down = command
            self._down_s = now_s

    def _show(self, now_s: float) -> None:
        """The rectangle, if it is another one."""
        rectangle = self._skill.rectangle
        if rectangle is not self._shown:
            self._shown = rectangle
            sides = () if rectangle is None else (rectangle.base_m, rectangle.height_m, rectangle.home)
            self._rectangle.put(RectangleState(now_s, *sides), now_s)

    def _order(self) -> None:
        is_ordered, job = self._skill.order()
        if is_ordered:
            self._jobs.put(job)

    def _work_for_the_job(self, now_s: float) -> None:
        """Hear how the job stands, and pass down what its tree commands. What an ended job still commands is dropped."""
        letter = None if self._job_inbox is None else self._job_inbox.take()
        job = self._skill.job
        if letter is not None and job is not None and letter.source == job.source:
            self._pass_down(letter.command, now_s)
        elif job is not None and self._stands_by_order and now_s - self._down_s >= REFRESH_S:
            self._pass_down(self._down, now_s)  # the same command: its sender still knows it by its stamp
        state: JobState | None = self._job_state()
        if state is not None and job is not None:
            self._skill.hear(state)
            if self._skill.verdict.reason:
                self._pass_down(ActuatorState(now_s), now_s)  # it failed: the robot stands, whatever its tree did last

    @property
    def _stands_by_order(self) -> bool:
        return self._down.velocity == STILL and self._down.flags % 10 == CommandType.VELOCITY

    def _where(self, now_s: float) -> Planar | None:
        """The pose of interface 3, None if it is missing or too old."""
        pose: Pose | None = self._pose()
        return None if pose is None or now_s - pose.stamp_s > POSE_STALE_S else (pose.pose[0], pose.pose[1], pose.pose[3])

    def _rest(self, now_s: float) -> FVectorState:
        element: tuple[int, ...] = (int(LinkStatus.STOPPED_THREAD), int(GotoStatus.STOPPED_THREAD), 0, int(MotionStatus.STOPPED_THREAD))
        status: FVectorState | None = self._avoid_status()
        if status is not None:
            element = (*status.element, 0, int(MotionStatus.STOPPED_THREAD))
        return FVectorState(now_s, STILL if status is None else status.data, element, reasons.STOPPED, "the motion thread is stopped")
