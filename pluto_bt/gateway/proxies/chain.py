"""The command chain: drive, avoidance, motion (manual, section 6). Each link takes what the one below takes, and more."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from pluto_bt.blackboard.codes import Avoidance, CommandType, GotoStatus, MotionCommand, MotionStatus, MovetoStatus
from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.gateway.errors import WrongStateError
from pluto_bt.gateway.proxies.proxy import Proxy
from pluto_bt.gateway.words import RunResult


class LinkProxy(Proxy):
    """One link: its status, the command it accepted last, and the two commands that every link takes.

    A link obeys a client only while the thread of the link above is stopped; else WrongStateError, which names whom to release.
    """

    TARGET: ClassVar[str]
    ABOVE: ClassVar[tuple[str, str] | None]  # module of the link above, and its proxy
    RELEASED: ClassVar[tuple[str, ...]]  # modules that -1 stops

    def status(self) -> FVectorState:
        """`element` as in the manual; `data` = the velocities really in force."""
        return self._newest(f"{self.TARGET}/status", FVectorState)

    def accepted(self) -> ActuatorState:
        """The command that the link accepted last."""
        return self._newest(f"{self.TARGET}/command", ActuatorState)

    def set_velocity(self, speed_mps: float, turn_rate_radps: float, sensors: Avoidance = Avoidance.BOTH) -> None:
        """T = 0: these velocities, positive turns left. Say it again within 4 s, or the robot stops."""
        self._command(self._flags(CommandType.VELOCITY, sensors), velocity=(speed_mps, turn_rate_radps))

    def hold_heading(self, heading_rad: float, speed_mps: float, sensors: Avoidance = Avoidance.BOTH) -> None:
        """T = 1: turn to this heading and hold it at this speed. Say it again within 4 s, or the robot stops."""
        self._command(self._flags(CommandType.REGULATOR, sensors), (0.0, heading_rad), (speed_mps, 0.0))

    def stop(self) -> None:
        """Zero velocity at once, on every link; needs no lease."""
        self.client.stop()

    def release_robot(self) -> None:
        """cmdFlags -1: stop the thread, so that the link below can be commanded; back when it stands. `start_activity` takes over again."""
        self._command(MotionCommand.RELEASE)
        self._wait_for("stopped", self.RELEASED)

    def _flags(self, kind: CommandType, sensors: Avoidance) -> int:
        return 10 * int(sensors) + int(kind)

    def _command(self, flags: int, position: Sequence[float] = (), velocity: Sequence[float] = (), force: Sequence[float] = ()) -> None:
        try:
            self.client.command(self.TARGET, int(flags), position, velocity, force=force)
        except WrongStateError as error:
            is_mission = self.client.request("mission", op="state").get("state") == "running"  # then that is what hinders it first
            if self.ABOVE is None or is_mission or self._states().get(self.ABOVE[0]) != "running":
                raise
            above, proxy = self.ABOVE
            text = f"{self.TARGET} obeys the module {above} while its thread runs: {proxy}.release_robot() first, start_activity() afterwards"
            raise WrongStateError(error.code, text) from None


class DriveProxy(LinkProxy):
    """The drive: velocities and headings, with bumpers and sonar alone; headings are those of the odometry (`ATRV2/Drive/Raw`)."""

    MODULE, TARGET = "drive", "drive"
    ABOVE, RELEASED = ("avoid", "AvoidProxy"), ("drive",)

    def _flags(self, kind: CommandType, sensors: Avoidance) -> int:
        return 10 * (int(sensors) & int(Avoidance.SONAR)) + int(kind)  # it knows no laser


class AvoidProxy(LinkProxy):
    """Avoidance: goto and wall follow; headings are those of `Localization/Pose`."""

    MODULE, TARGET = "avoid", "avoidance"
    ABOVE: ClassVar[tuple[str, str] | None] = ("motion", "MotionProxy")
    RELEASED: ClassVar[tuple[str, ...]] = ("avoid",)

    def goto(
        self, x_m: float, y_m: float, speed_mps: float = 0.5, turn_rate_radps: float = 0.5, force: float = 1.0,
        sensors: Avoidance = Avoidance.BOTH,
    ) -> None:  # fmt: skip
        """T = 2: straight to a place of the map, around what is in the way; `force` above 1 makes avoidance weaker."""
        self._command(self._flags(CommandType.GOTO, sensors), (x_m, y_m), (speed_mps, turn_rate_radps), (force,))

    def follow_wall(self, speed_mps: float = 0.3, turn_rate_radps: float = 0.5, sensors: Avoidance = Avoidance.BOTH) -> None:
        """T = 3: along the wall on the left; turn the wrist there first."""
        self._command(self._flags(CommandType.WALL_FOLLOW, sensors), velocity=(speed_mps, turn_rate_radps))

    def goto_status(self) -> GotoStatus:
        """element[1]: how the goto stands."""
        return GotoStatus(self.status().element[1])


class MotionProxy(AvoidProxy):
    """Motion: the complex jobs; everything else it passes on to avoidance. Its release stops avoidance, too."""

    MODULE, TARGET = "motion", "motion"
    ABOVE, RELEASED = None, ("motion", "avoid")

    def moveto(self, x_m: float, y_m: float) -> None:
        """42: to a place of the map, along open paths."""
        self._command(MotionCommand.MOVETO, (x_m, y_m))

    def investigate(self) -> None:
        """43: to the closest object, and around it."""
        self._command(MotionCommand.INVESTIGATE)

    def explore(self, b_m: float, h_m: float) -> None:
        """44: explore the rectangle ahead, `b_m` to either side, `h_m` deep; here is home."""
        self._command(MotionCommand.EXPLORE, velocity=(b_m, h_m))

    def resume(self) -> None:
        """45: go on with the job that was stopped, or explore the rectangle that was set."""
        self._command(MotionCommand.RESUME)

    def set_rectangle(self, b_m: float, h_m: float, x_m: float, y_m: float, theta_rad: float) -> None:
        """46: the rectangle that limits the jobs, and its home; `b_m` = 0 removes it."""
        self._command(MotionCommand.SET_RECTANGLE, (x_m, y_m), (b_m, h_m), (theta_rad,))

    def moveto_status(self) -> MovetoStatus:
        """element[2]: how the moveto or the investigation stands."""
        return MovetoStatus(self.status().element[2])

    def motion_status(self) -> MotionStatus:
        """element[3]: what motion is doing."""
        return MotionStatus(self.status().element[3])


class FollowProxy(Proxy):
    """Following what moves: the node `Follow`, driven by motion."""

    MODULE = "motion"

    def follow(self, target: str = "nearest", distance_m: float = 1.5, duration_s: float = 60.0) -> RunResult:
        """Follow a `person` or the `nearest` that moves, at this distance, for so long; back when that is over."""
        return self.client.run("Follow", target=target, distance_m=distance_m, duration_s=duration_s)
