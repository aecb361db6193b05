"""A robot for leaves: notes what it is told, says what the test put in its mouth. And a small exact car."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pluto_bt.behaviours.navigation import Navigation
from pluto_bt.behaviours.robot import Ticket
from pluto_bt.behaviours.surroundings import Surroundings
from pluto_bt.blackboard.messages import ActuatorState, FloatArray, FVectorState, ImuState, MarkerState, Message, Pair, Pose, SpeedState
from pluto_bt.blackboard.topics import TOPICS
from pluto_bt.maps.platform import Body, Bumpers, Devices, Inertial, Laser, Limits, MarkerCamera, Platform, Sonar, Transducer, WheelSpeed, Wrist
from pluto_bt.maps.world import World
from pluto_bt.runtime import VirtualClock
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.plan_parameters import PlanParameters
from pluto_bt.skills.sight import ScanView

STALE_S = {topic.name: topic.stale_after_s for topic in TOPICS}
BOX = ((0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4))
LIMITS = Limits(max_speed_mps=0.9, max_turn_rate_dps=70, acceleration_mps2=0.6, deceleration_mps2=1, turn_acceleration_dps2=90)
SKID = Platform(
    name="skid",
    body=Body(kinematics="skid", outline_m=BOX, track_m=0.6),
    limits=LIMITS,
    devices=Devices(laser=Laser(x_m=0.4), wrist=Wrist(), bumpers=Bumpers(), sonar=Sonar(transducers=(Transducer(x_m=0.5, y_m=0, theta_deg=0),))),
)
CAR = Platform(
    name="car",
    body=Body(kinematics="ackermann", outline_m=BOX, track_m=0.25, min_turn_radius_m=0.83),
    limits=LIMITS,
    devices=Devices(dmu=Inertial(), speed=WheelSpeed(), marker=MarkerCamera()),
)


class FakeRobot:
    """Accepts each command when `accept` is True; `says` is the status of the accepted command."""

    def __init__(self, clock: VirtualClock, platform: Platform = SKID, world: World | None = None) -> None:
        self.platform, self.map, self.clock = platform, world, clock
        self.values: dict[str, Message] = {}
        self.commands: list[ActuatorState] = []
        self.pointed: list[tuple[float, ...]] = []
        self.said: list[str] = []
        self.accept = True
        self.refuse = ""
        self.alarms_read = 0
        self.keeps_pose = False
        self.posed: Pose | None = None
        self.paths: list[FloatArray] = []
        self.resumes = 0
        self.views: list[ScanView] = []
        self._surroundings: Surroundings | None = None
        self._navigation: Navigation | None = None
        self.says = FVectorState(0.0, (0.0, 0.0), (0, -1, 0, 0))

    def command(
        self,
        flags: int,
        position: Pair = (0.0, 0.0),
        velocity: Pair = (0.0, 0.0),
        tolerance_m: float = 0.0,
        force: float = 1.0,
        on_the_way: bool = False,
    ) -> Ticket:
        command = ActuatorState(self.clock.now_s(), int(flags), position, velocity, (tolerance_m, 0.0), (force,))
        self.commands.append(command)
        return Ticket(command, self.refuse)

    def status(self, ticket: Ticket) -> FVectorState | None:
        return self.says if self.accept and self.commands and ticket.command is self.commands[-1] else None

    def newest(self, topic: str) -> Message | None:
        return self.values.get(topic)

    def age_s(self, topic: str) -> float:
        return self.clock.now_s() - self.values[topic].stamp_s if topic in self.values else math.inf

    def is_stale(self, topic: str) -> bool:
        return topic not in self.values or 0.0 < STALE_S[topic] < self.age_s(topic)

    @property
    def surroundings(self) -> Surroundings:
        if self._surroundings is None:
            self._surroundings = Surroundings(self.platform, MotionParameters(), PlanParameters().seen_cell_m)
        return self._surroundings

    @property
    def navigation(self) -> Navigation:
        if self._navigation is None:
            self._navigation = Navigation(self.platform, self.map, self.surroundings, PlanParameters())
        return self._navigation

    def scan_views(self) -> tuple[ScanView, ...]:
        views, self.views = tuple(self.views), []
        return views

    def point_wrist(self, *target: float) -> None:
        self.pointed.append(target)

    def post_pose(self, x_m: float, y_m: float, theta_rad: float) -> Pose | None:
        self.posed = None if self.keeps_pose else Pose(1.0, (x_m, y_m, 0.0, theta_rad, 0.0, 0.0), setter=-1)
        return self.posed

    def show_path(self, points: FloatArray) -> None:
        self.paths.append(points)

    def read_alarms(self) -> None:
        self.alarms_read += 1

    def say(self, text: str) -> None:
        self.said.append(text)

    def stop(self) -> None:
        self.commands.append(ActuatorState(self.clock.now_s()))

    def is_at(self, x: float, y: float, theta: float = 0.0, speed: float = 0.0) -> None:
        """Fresh pose and odometry."""
        now_s = self.clock.now_s()
        self.values["Localization/Pose"] = self.values["Localization/Dead-Reckoning"] = Pose(now_s, (x, y, 0.0, theta, 0.0, 0.0))
        self.values["ATRV2/Drive/Raw"] = ActuatorState(now_s, 0, (x, theta), (speed, 0.0))


class ExactCar:
    """The car on an exact arc: steering error drawn for each new command, drifting gyro, markers 3 times a second, wheel speed 5 times.

    Markers set the estimated position and pull the heading by 5 % as the adapter does.
    """

    STEP_S = 0.02

    def __init__(self, robot: FakeRobot, seed: int, start: tuple[float, float, float], drift_dps: float = 0.02) -> None:
        self.robot, self.rng = robot, np.random.default_rng(seed)
        self.x, self.y, self.theta = start
        self.estimate = list(start)
        self.drift_radps = math.radians(drift_dps)
        self.speed = self.curvature = 0.0
        self.is_held = False
        self.count = 0
        self.box = [self.x, self.y, self.x, self.y]
        self._last: tuple[float, float] = (0.0, 0.0)
        self.error = 1.0

    def advance(self, seconds: float) -> None:
        for _ in range(round(seconds / self.STEP_S)):
            self._move()
            self._sense()
            self.count += 1

    def _move(self) -> None:
        v, w = self.robot.commands[-1].velocity if self.robot.commands else (0.0, 0.0)
        curvature = w / v if v else self.curvature
        if abs(curvature - self._last[0]) > 0.5 / 90 / 0.83:
            self._last, self.error = (curvature, v), 1.0 + 0.05 * self.rng.normal()
        self.curvature = curvature
        self.speed += max(-0.02, min(0.012, v - self.speed))
        way = 0.0 if self.is_held else self.speed * self.STEP_S
        turn = way * curvature * self.error
        for pose, extra in ((self, 0.0), (None, self.drift_radps * self.STEP_S)):
            if pose is not None:
                self.x += way * math.cos(self.theta + turn / 2)
                self.y += way * math.sin(self.theta + turn / 2)
                self.theta += turn
            else:
                self.estimate[0] += way * math.cos(self.estimate[2] + turn / 2)
                self.estimate[1] += way * math.sin(self.estimate[2] + turn / 2)
                self.estimate[2] += turn + extra
        self.box = [min(self.box[0], self.x), min(self.box[1], self.y), max(self.box[2], self.x), max(self.box[3], self.y)]

    def _sense(self) -> None:
        now_s = self.robot.clock.now_s()
        if self.count % 17 == 5:
            self.estimate[0], self.estimate[1] = self.x + 0.03 * self.rng.normal(), self.y + 0.03 * self.rng.normal()
            seen = self.theta + math.radians(2.0) * self.rng.normal()
            self.estimate[2] += 0.05 * math.remainder(seen - self.estimate[2], math.tau)
            self.robot.values["car/marker"] = MarkerState(now_s, 7, accepted_count=1)
        if self.count % 10 == 0:
            shown = 0.0 if self.is_held else round(abs(self.speed), 2)
            self.robot.values["car/speed"] = SpeedState(now_s, shown)
        self.robot.values["dmu/state"] = ImuState(now_s, bias_known=True)
        x, y, theta = self.estimate
        self.robot.values["Localization/Pose"] = Pose(now_s, (x, y, 0.0, theta, 0.0, 0.0))


class Stage:
    """A clock, a robot, and a way to run XML on them."""

    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.robot = FakeRobot(self.clock)

    def load(self, xml: str, **more: Any) -> Any:
        """A mission; a text without root gets one around it."""
        import pluto_bt.behaviours.catalogue
        from pluto_bt.trees import load_mission

        assert pluto_bt.behaviours.catalogue.LEAVES
        if xml.startswith("<") and "<root" not in xml:
            xml = f'<root BTCPP_format="4"><BehaviorTree ID="T">{xml}</BehaviorTree></root>'
        return load_mission(xml, clock=self.clock, robot=self.robot, **more)

    def tick(self, mission: Any, after_s: float = 0.1) -> str:
        """Move the clock, keep odometry and pose fresh, tick."""
        self.clock.advance(after_s)
        return str(mission.tick_once())


@pytest.fixture
def stage() -> Stage:
    return Stage()


@pytest.fixture
def make_car() -> Any:
    return lambda seed, start, world=None: _car(seed, start, world)


def _car(seed: int, start: tuple[float, float, float], world: World | None) -> tuple[Stage, ExactCar]:
    stage = Stage()
    stage.robot = FakeRobot(stage.clock, CAR, world)
    return stage, ExactCar(stage.robot, seed, start)
