"""The robot that missions see, over the blackboard and the inboxes of one system."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from pluto_bt.behaviours.navigation import Navigation
from pluto_bt.behaviours.robot import Ticket
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard import Publisher, Snapshot
from pluto_bt.blackboard.codes import CommandType, MotionCommand, MotionStatus, MovetoStatus, Setter
from pluto_bt.blackboard.messages import ActuatorState, FloatArray, FVectorState, Message, Pair, PathState, Pose
from pluto_bt.maps.platform import Platform
from pluto_bt.maps.world import World
from pluto_bt.modules.context import Context
from pluto_bt.modules.scan_views import ScanViews
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.sight import ScanView

if TYPE_CHECKING:
    from pluto_bt.modules.robot_file import RobotFile

SOURCE = "mission"
GOALS_KEPT = 200
AMENDED_WITHIN_S = 1.0  # a goal so soon after the last one is the same order with other figures: a target that is followed
BY_HAND = (0.1**2, 0.0, 0.0, 0.0, 0.1**2, 0.0, 0.0, 0.0, 0.05**2)  # how sure a person is of a pose: 0.1 m, 3°
MOTION_COMMAND, MOTION_STATUS = "motion/command", "motion/status"


class RobotLink:
    """Implements `pluto_bt.behaviours.robot.Robot`. The executive calls `refresh` before each tick, so that a tick sees one moment."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self.reads: set[int] = set()  # rows of the topics that trees have asked for
        self.on_command: Callable[[str, Ticket], None] = lambda to, ticket: None  # the black box listens here
        self._snapshot = context.board.snapshot(context.clock.now_s(), self.reads)
        self.resumes = 0
        self.goals: list[Pair] = []  # where missions sent the robot, for pictures
        self._surroundings: Surroundings | None = None
        self._navigation: Navigation | None = None
        self._views: ScanViews | None = None
        self._path: Publisher | None = None
        self._goal_s = -AMENDED_WITHIN_S

    @property
    def snapshot(self) -> Snapshot:
        """The moment that this tick sees."""
        return self._snapshot

    @property
    def platform(self) -> Platform:
        """The platform file."""
        return self._context.platform

    @property
    def map(self) -> World | None:
        """The a-priori map."""
        return self._context.map

    def refresh(self, now_s: float) -> None:
        """Take the snapshot that the next tick sees."""
        self._snapshot = self._context.board.snapshot(now_s, self.reads)

    def tune(self, robot: RobotFile) -> None:
        """Parameters have changed: they count for the next job and the next way."""
        if self._surroundings is not None:
            self._surroundings.tune(robot.motion)
        if self._navigation is not None:
            self._navigation.parameters = robot.plan

    @property
    def surroundings(self) -> Surroundings:
        """The local map and what belongs to it; made when it is first asked for."""
        if self._surroundings is None:
            context = self._context
            cell_m = context.parameters(PlanParameters).seen_cell_m
            self._surroundings = Surroundings(context.platform, context.parameters(MotionParameters), cell_m)
        return self._surroundings

    @property
    def navigation(self) -> Navigation:
        """Planning on the map; made when it is first asked for."""
        if self._navigation is None:
            context = self._context
            self._navigation = Navigation(context.platform, context.map, self.surroundings, context.parameters(PlanParameters))
        return self._navigation

    def scan_views(self) -> Sequence[ScanView]:
        """The laser scans since the last call, with the places they were taken from."""
        if self._views is None:
            self._views = ScanViews(self._context.platform)
        return self._views.new(self._snapshot)

    def command(
        self,
        flags: int,
        position: Pair = (0.0, 0.0),
        velocity: Pair = (0.0, 0.0),
        tolerance_m: float = 0.0,
        force: float | tuple[float, ...] = 1.0,
        *,
        on_the_way: bool = False,
    ) -> Ticket:
        """Send a command; `acceleration[0]` carries the tolerance of a goto."""
        forces = force if isinstance(force, tuple) else (force,)
        return self._send(ActuatorState(self.now_s(), flags, position, velocity, (tolerance_m, 0.0), forces), on_the_way)

    def _send(self, command: ActuatorState, on_the_way: bool) -> Ticket:
        """Post it to motion as `mission`; a goal is noted for pictures."""
        is_goto = 0 < command.flags < MotionCommand.MOVETO and command.flags % 10 == CommandType.GOTO
        if command.flags == MotionCommand.MOVETO or (is_goto and not on_the_way):
            self._note_goal(command.position, command.stamp_s)
        return self._post("motion", SOURCE, command)

    def _post(self, to: str, source: str, command: ActuatorState) -> Ticket:
        ticket = Ticket(command, self._context.inboxes[to].post(source, command))
        self.on_command(to, ticket)
        return ticket

    def now_s(self) -> float:
        """The moment that trees live in: one and the same through a whole tick."""
        return self._context.mission_clock.now_s()

    def _note_goal(self, goal: Pair, now_s: float) -> None:
        if now_s - self._goal_s >= AMENDED_WITHIN_S:
            self._keep_goal(goal)
        self._goal_s = now_s

    def _keep_goal(self, goal: Pair) -> None:
        if goal not in self.goals and len(self.goals) < GOALS_KEPT:
            self.goals.append(goal)

    def status(self, ticket: Ticket) -> FVectorState | None:
        """`motion/status` as far as it speaks of this command: motion has accepted it and has written its status since."""
        return spoken_of(self._snapshot, MOTION_COMMAND, MOTION_STATUS, ticket.command)

    def show_phase(self, moveto: MovetoStatus | None, motion: MotionStatus | None) -> None:
        """Nobody listens: only jobs have phases."""

    def newest(self, topic: str) -> Message | None:
        """The newest value, or None if nobody has written yet."""
        sample = self._snapshot.newest(topic)
        return None if sample is None else sample.value

    def age_s(self, topic: str) -> float:
        """Seconds since the value was true; infinite without a value."""
        return self._snapshot.age_s(topic)

    def is_stale(self, topic: str) -> bool:
        """True if the value is missing or older than the table of topics allows."""
        return self._snapshot.is_stale(topic)

    def point_wrist(self, pan_rad: float, tilt_rad: float, rate_radps: float, acceleration_radps2: float) -> None:
        """Post a command to the wrist, both axes alike."""
        rates, accelerations = (rate_radps, rate_radps), (acceleration_radps2, acceleration_radps2)
        self._post("wrist", SOURCE, ActuatorState(self.now_s(), 0, (pan_rad, tilt_rad), rates, accelerations))

    def move_arm(self, share: float) -> None:
        """Post a command to the arm."""
        self._post("arm", SOURCE, ActuatorState(self.now_s(), 0, (share, 0.0)))

    def post_pose(self, x_m: float, y_m: float, theta_rad: float) -> Pose | None:
        """Leave it in the post box of localisation, at the stamp of its newest pose."""
        newest = self.newest("Localization/Pose")
        stamp_s = newest.stamp_s if newest is not None else self.now_s()
        pose = Pose(stamp_s, (x_m, y_m, 0.0, theta_rad, 0.0, 0.0), BY_HAND, Setter.JUST_SET)
        return None if self._context.posts.post(SOURCE, pose) else pose

    def show_path(self, points: FloatArray) -> None:
        """The path that is followed, as the topic `map/path`. The end of one without a way is a goal for pictures too: nobody else commands it."""
        if len(points) == 1:
            self._keep_goal((float(points[0, 0]), float(points[0, 1])))
        self._path = self._path or self._context.board.publisher("map/path", "executive")
        now_s = self.now_s()
        self._path.put(PathState(now_s, tuple(points.ravel().tolist())), now_s)

    def read_alarms(self) -> None:
        """Leave a letter for the module `alarms`."""
        self._post("alarms", SOURCE, ActuatorState(self.now_s()))

    def order_module(self, name: str, run: bool) -> bool:
        """Ask the system to start or stop it."""
        try:
            self._context.order_module(name, run)
        except KeyError:
            return False
        return True

    def say(self, text: str) -> None:
        """A line for operators."""
        self._context.say("info", "say", SOURCE, text)

    def resumed(self) -> None:
        """A paused mission goes on."""
        self.resumes += 1

    def stop(self) -> None:
        """Zero velocity at once; beats every command that waits."""
        self._context.inboxes["motion"].stop(SOURCE, self._context.clock.now_s())


def spoken_of(snapshot: Snapshot, command_topic: str, status_topic: str, command: ActuatorState) -> FVectorState | None:
    """The status of a link as far as it speaks of `command`: the link has accepted it and has written its status since."""
    accepted, status = snapshot.newest(command_topic), snapshot.newest(status_topic)
    if accepted is None or status is None or status.written_s < accepted.written_s or accepted.value != command:
        return None
    return status.value if isinstance(status.value, FVectorState) else None
