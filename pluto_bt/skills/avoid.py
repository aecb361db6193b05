"""Avoidance: laser protection for what it passes down, goto and wall follow (Pluto manual, 6.2). `cmdFlags` = 10·A + T.

Orders and their amendments. What comes from above is an order; its time of acceptance is the stamp of every command that goes down for
it. A pass-through (T = 0, 1) is posted once; when laser protection slows it, or the heading of T = 1 has to follow the adjusted pose,
the amended command is posted under the stamp of the order, and drive counts its 4 s from the first of one stamp. So the timeout of the
order still fires. Goto and wall follow give a new order in each cycle, with the stamp of the cycle.
"""

from __future__ import annotations

from pluto_bt.blackboard.codes import Avoidance, CommandType, GotoStatus, LinkStatus, split_flags
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import reasons
from pluto_bt.skills.avoid_parameters import AvoidParameters
from pluto_bt.skills.avoid_senses import AvoidSenses
from pluto_bt.skills.backing import Behind
from pluto_bt.skills.drive import DriveParameters, drive_limits, is_finite
from pluto_bt.skills.goto import Goto
from pluto_bt.skills.heading import regulate
from pluto_bt.skills.limits import STILL, Limits, Twist, within
from pluto_bt.skills.outline import Array, Planar, outline_of
from pluto_bt.skills.protection import Protection
from pluto_bt.skills.sight import Sight
from pluto_bt.skills.verdict import ALL_WELL, Verdict, kept
from pluto_bt.skills.wall_follow import WallFollow, WallStatus
from pluto_bt.skills.wall_parameters import WallParameters

__all__ = ["Avoid", "AvoidParameters", "AvoidSenses"]

SAME_MPS, SAME_RAD = 0.01, 0.004  # smaller changes of a command in force are not worth a new post
REFRESH_S = 1.0  # a goto or wall follow that has ended renews its zero velocity so often, so that drive does not time out
LEAST_TURN_RADPS = 1e-3  # "do not turn": as the most turn rate, 0 would mean the platform's


class Avoid:
    """The state of avoidance between two steps. `step` gives the command for drive, or None where the last one still holds."""

    def __init__(self, platform: Platform, parameters: AvoidParameters, drive: DriveParameters, wall: WallParameters) -> None:
        self.parameters = parameters
        self._limits = drive_limits(platform, drive)
        self._outline = outline_of(platform.body.outline_m)
        motors = platform.limits
        latency_s = parameters.period_s + drive.period_s + motors.motor_latency_s + motors.motor_time_constant_s
        self._goto = Goto(self._outline, self._limits, parameters)
        self._wall = WallFollow(self._outline, self._limits, wall, parameters)
        self.sight = Sight(platform, parameters, self._outline)
        self._protection = Protection(self.sight, self._outline, self._limits, latency_s)
        self.reset()

    def tune(self, platform: Platform, parameters: AvoidParameters, drive: DriveParameters, wall: WallParameters) -> None:
        """Other parameters count from now on; what a goto or wall follow took from them when it began, from the next one on."""
        self.parameters, self._limits = parameters, drive_limits(platform, drive)
        self._goto.tune(self._limits, parameters)
        self._wall.tune(self._limits, wall, parameters)
        self._protection.limits = self._limits
        self.sight.tune(parameters)

    def reset(self) -> None:
        """No command, nothing seen."""
        self.command: ActuatorState | None = None
        self.verdict = ALL_WELL
        self.goto_status = GotoStatus.NONE
        self._kind: tuple[Avoidance, CommandType] | None = None
        self._posted: ActuatorState | None = None
        self._order_s = self._last_s = 0.0
        self.sight.forget()

    def accept(self, command: ActuatorState, now_s: float) -> None:
        """Take an order."""
        self.command, self._order_s, self._posted = command, now_s, None
        self._kind = split_flags(command.flags) if is_finite(command) else None
        kind = None if self._kind is None else self._kind[1]
        self.goto_status = GotoStatus.RUNNING if kind is CommandType.GOTO else GotoStatus.NONE
        self.verdict = ALL_WELL
        self.sight.widen(0.0)
        if kind is CommandType.GOTO:
            self._goto.begin(command, now_s, self._behind)
        elif kind is CommandType.WALL_FOLLOW:
            self._wall.begin(command)
            self.sight.widen(self._wall.reach_m)

    def stop(self, command: ActuatorState) -> None:
        """Stop was commanded: there is no order any more. The adapter sends the stop down."""
        self.command, self._kind, self._posted = command, None, command
        self.goto_status = GotoStatus.NONE
        self.verdict = Verdict(reason=reasons.STOPPED, text="stop was commanded")

    def step(self, now_s: float, senses: AvoidSenses) -> ActuatorState | None:
        """Look, decide, and give the command for drive if it changed."""
        dt_s, self._last_s = now_s - self._last_s, now_s
        if senses.dead is not None:
            self.sight.look(senses.view, senses.sonar, senses.dead, self._asks_laser, now_s)
        if self.command is None or self.verdict.reason == reasons.STOPPED:
            return None
        if self._kind is None:
            return self._refuse(self.command)
        avoidance, kind = self._kind
        if kind is CommandType.GOTO:
            return self._step_goto(now_s, dt_s, senses, avoidance)
        if kind is CommandType.WALL_FOLLOW:
            return self._step_wall(now_s, dt_s, senses, avoidance)
        return self._pass_down(now_s, senses, avoidance, kind)

    def status(self, now_s: float, drive: FVectorState | None, drive_has_it: bool) -> FVectorState:
        """`avoidance/status`: own words first, else drive's once it has accepted our last command; a stopped drive and a rebooting laser always."""
        data = drive.data if drive is not None else STILL
        verdict = self.verdict
        code, reason, text = int(verdict.code), verdict.reason, verdict.text
        if drive is not None and not verdict.code and (drive_has_it or drive.element[0] == LinkStatus.STOPPED_THREAD):
            code = drive.element[0]
            if not reason:
                reason, text = drive.reason, drive.text or text
        laser = self.sight.laser_fault(now_s) if not code and self._asks_laser else ALL_WELL
        if laser.code is LinkStatus.LASER_FATAL:
            code, reason, text = int(laser.code), reason or laser.reason, text or laser.text
        return FVectorState(now_s, data, (code, int(self.goto_status)), reason, text)

    @property
    def _behind(self) -> Behind:
        """What is known of what lies behind, by the sensors that A names."""
        avoidance = Avoidance.NONE if self._kind is None else self._kind[0]
        if self.sight.sees_behind(bool(avoidance & Avoidance.SONAR)):
            return Behind.HEARD
        return Behind.SEEN if avoidance & Avoidance.LASER and self.sight.laser is not None else Behind.UNKNOWN

    @property
    def _asks_laser(self) -> bool:
        """Whether the laser counts: A asks for it, or nothing is commanded."""
        return self._kind is None or bool(self._kind[0] & Avoidance.LASER)

    # -------------------------------------------------------------- what goes down

    def _refuse(self, command: ActuatorState) -> ActuatorState | None:
        """Zero velocity for what is not known."""
        text = f"avoidance takes cmdFlags 10*A + T with A 0 to 3, T 0 to 3 and finite numbers, or -1; not {command.flags}"
        self.verdict = kept(self.verdict, Verdict(reason=reasons.BAD_COMMAND, text=text))
        return self._post(0, 0.0, STILL, self._order_s)

    def _pass_down(self, now_s: float, senses: AvoidSenses, avoidance: Avoidance, kind: CommandType) -> ActuatorState | None:
        """T = 0 and 1, slowed where the laser says so; drive takes care of the sonar."""
        assert self.command is not None
        flags = int(kind) + (10 if avoidance & Avoidance.SONAR else 0)
        heading_rad, raw_rad = 0.0, senses.raw_heading_rad
        if kind is CommandType.VELOCITY:
            twist = within(self.command.velocity, self._limits)
        elif senses.pose is None or raw_rad is None:
            self.verdict = kept(self.verdict, senses.no_pose)
            return self._post(0, 0.0, STILL, self._order_s)
        else:
            heading_rad = self.command.position[1] - senses.pose[2] + raw_rad
            speed_mps, most_radps = self.command.velocity
            twist = within(regulate(wrap_angle(heading_rad - raw_rad), speed_mps, self._limits, max(0.0, most_radps)), self._limits)
        share, verdict = self._protection.laser_share(now_s, senses.dead, senses.twist, avoidance, twist)
        self.verdict = kept(self.verdict, verdict)
        v, w = self.command.velocity
        if share >= 1.0:
            return self._post(flags, heading_rad, (v, w), self._order_s)
        if kind is CommandType.VELOCITY:
            return self._post(flags, 0.0, (twist[0] * share, twist[1] * share), self._order_s)
        return self._post(flags, *self._slow_turn(v, heading_rad, raw_rad or 0.0, twist, share), self._order_s)

    def _step_goto(self, now_s: float, dt_s: float, senses: AvoidSenses, avoidance: Avoidance) -> ActuatorState | None:
        """T = 2: steer and adapt the speed; zero velocity when it is there, stuck, or cannot know."""
        if self.goto_status is not GotoStatus.RUNNING:
            return self._rest(now_s)
        fault = self._blindness(now_s, senses, avoidance)
        if fault != ALL_WELL or senses.pose is None or senses.dead is None:
            self.verdict = kept(self.verdict, fault)
            self._goto.pause(now_s, dt_s)
            return self._post(0, 0.0, STILL, now_s)
        if senses.waits_for_walker or senses.wheels_stand:
            self._goto.pause(now_s, dt_s)
        points = self._points(now_s, senses.dead, avoidance)
        way = self._goto.step(now_s, senses.pose, senses.dead, points)
        self.goto_status = way.status
        if way.status is not GotoStatus.RUNNING:
            reason = reasons.STUCK if way.status is GotoStatus.STUCK else ""
            self.verdict = Verdict(reason=reason, text=way.text)
            return self._post(0, 0.0, STILL, now_s)
        share, command = self._steered(now_s, senses, avoidance, points, way.speed_mps, way.turn_rad, self._goto.limits)
        self._goto.note_share(now_s, share)
        if share == 0.0 and way.speed_mps < 0.0:
            self._goto.give_up_backing()
        return command

    def _step_wall(self, now_s: float, dt_s: float, senses: AvoidSenses, avoidance: Avoidance) -> ActuatorState | None:
        """T = 3: along the wall; zero velocity where there is none, and when it is lost, stuck, or cannot know."""
        fault = self._blindness(now_s, senses, avoidance)
        if avoidance is Avoidance.NONE:
            fault = Verdict(reason=reasons.NO_WALL, text="A = 0 asks no sensor for the wall")
        if fault != ALL_WELL or senses.dead is None:
            self.verdict = kept(self.verdict, fault)
            self._wall.pause(dt_s)
            return self._rest(now_s)
        if senses.waits_for_walker:
            self._wall.pause(dt_s)
        points = self._points(now_s, senses.dead, avoidance)
        along = self._wall.step(now_s, senses.dead, points, self.sight.scan_s)
        if along.status is not WallStatus.FOLLOWING:
            self.verdict = kept(self.verdict, Verdict(reason=along.status.value, text=along.text))
            return self._rest(now_s)
        command = self._steered(now_s, senses, avoidance, points, along.speed_mps, along.turn_rad, self._wall.limits)[1]
        if self.verdict.reason == "":
            self.verdict = Verdict(text=along.text)
        return command

    def _rest(self, now_s: float) -> ActuatorState | None:
        """Zero velocity, renewed now and then."""
        last = self._posted
        return self._post(0, 0.0, STILL, now_s) if last is None or last.velocity != STILL or now_s - last.stamp_s >= REFRESH_S else None

    def _points(self, now_s: float, dead: Planar, avoidance: Avoidance) -> Array:
        """What stands around the robot, as far as the sensors that A names see it."""
        return self.sight.points(dead, bool(avoidance & Avoidance.LASER), bool(avoidance & Avoidance.SONAR), now_s)

    def _steered(
        self, now_s: float, senses: AvoidSenses, avoidance: Avoidance, points: Array, speed_mps: float, turn_rad: float, limits: Limits
    ) -> tuple[float, ActuatorState | None]:
        """The regulator command that turns by `turn_rad` at a speed, slowed where something is in the way; and the share that was let through."""
        assert senses.raw_heading_rad is not None  # else `_blindness` had spoken
        flags = 11 if avoidance & Avoidance.SONAR else 1
        twist = within(regulate(turn_rad, speed_mps, limits), limits)
        share, verdict = self._protection.clear_share(points, twist, senses.twist)
        self.verdict = kept(self.verdict, verdict)
        heading_rad = senses.raw_heading_rad + turn_rad
        if share >= 1.0:
            return share, self._post(flags, heading_rad, (speed_mps, limits.turn_rate_radps), now_s)
        return share, self._post(flags, *self._slow_turn(speed_mps, heading_rad, senses.raw_heading_rad, twist, share), now_s)

    def _slow_turn(self, speed_mps: float, heading_rad: float, raw_rad: float, twist: Twist, share: float) -> tuple[float, Twist]:
        """Heading and velocities of a regulator command that drive turns into `share` of `twist`."""
        if share == 0.0:
            return raw_rad, (0.0, LEAST_TURN_RADPS)  # stand, and hold the heading as it is
        return heading_rad, (speed_mps * share, max(abs(twist[1]) * share, LEAST_TURN_RADPS))

    def _post(self, flags: int, heading_rad: float, velocity: Twist, stamp_s: float) -> ActuatorState | None:
        """The command, or None if it says the same as the last one under the same stamp."""
        last = self._posted
        if last is not None and last.stamp_s == stamp_s and last.flags == flags and abs(last.position[1] - heading_rad) < SAME_RAD:
            dv, dw = abs(last.velocity[0] - velocity[0]), abs(last.velocity[1] - velocity[1])
            to_rest = velocity != last.velocity and STILL in (velocity, last.velocity)
            if dv < SAME_MPS and dw < SAME_RAD and not to_rest:
                return None
        self._posted = ActuatorState(stamp_s, flags, (0.0, heading_rad), velocity)
        return self._posted

    def _blindness(self, now_s: float, senses: AvoidSenses, avoidance: Avoidance) -> Verdict:
        """Why a job that steers cannot know where to go."""
        needs_pose = self._kind is not None and self._kind[1] is CommandType.GOTO
        if (needs_pose and senses.pose is None) or senses.dead is None or senses.raw_heading_rad is None:
            return senses.no_pose
        fault = self.sight.laser_fault(now_s) if avoidance & Avoidance.LASER else ALL_WELL
        if fault == ALL_WELL and avoidance & Avoidance.SONAR:
            fault = self.sight.sonar_fault(now_s)
        return fault
