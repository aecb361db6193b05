"""The manual's proxies before a whole robot in lockstep: its chain link by link, its sensors, its wrist; and one that lacks what is asked for."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pluto_bt.blackboard.codes import Avoidance, GotoStatus, MotionStatus, Setter
from pluto_bt.blackboard.messages import LaserPose, Pose
from pluto_bt.gateway.client import Client
from pluto_bt.gateway.errors import BadRequestError, NoLeaseError, WrongStateError
from pluto_bt.gateway.proxies import (
    PROXIES,
    AvoidProxy,
    BaseProxy,
    BumperProxy,
    CompassProxy,
    DmuProxy,
    DriveProxy,
    GpsProxy,
    LocProxy,
    MotionProxy,
    SickProxy,
    SonarProxy,
    WristProxy,
)
from pluto_bt.modules.gateway_port import GatewayPort
from pluto_bt.runtime.clock import NS
from pluto_bt.system import MODULES
from tests.raw_robot import RawRobot

from .lines import Bench

HALL = '<world name="hall"><wall>-6,-6 30,-6 30,6 -6,6 -6,-6</wall><robot platform="atrv2" x="0" y="0" theta_deg="0"/></world>'


class Whole(Bench):
    """A whole robot whose mission is paused, so that it can be driven by hand; its time goes on while the client waits."""

    def __init__(self, folder: Path) -> None:
        self.raw = RawRobot(folder, HALL)
        super().__init__(GatewayPort(self.raw.system.context))
        self.now_s = self.raw.now_s
        self.anna = self.client(name="anna")
        self.anna.request("mission", op="pause")

    def go_on(self, seconds: float) -> None:
        self.raw.system.scheduler.run_until(round((self.now_s + seconds) * NS))
        super().go_on(seconds)

    def speeds(self, seconds: float) -> tuple[float, float]:
        """The true ones, after so long."""
        self.anna.receive(seconds)
        return self.raw.velocity


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    return Whole(tmp_path_factory.mktemp("proxies"))


@pytest.fixture
def anna(whole: Whole) -> Client:
    """A client of a robot whose links all run, none of them commanded."""
    whole.anna.stop()
    for link in ("drive", "avoid", "motion"):
        whole.anna.request("module", name=link, op="start")
    whole.anna.receive(2.0)
    return whole.anna


def test_the_five_interfaces_are_read_as_in_the_manual(anna: Client) -> None:
    loc = LocProxy(anna, interfaces=9)
    pose = loc.get_pose(3)
    assert isinstance(pose, Pose) and len(pose.covariance) == 9 and loc.get_setter(3) in (Setter.NOBODY, Setter.JUST_SET)
    with pytest.raises(ValueError, match=r"one of the interfaces \[0, 3\] that were named by interfaces=9, found 4"):
        loc.get_pose(4)
    with pytest.raises(ValueError, match="found 32"):
        LocProxy(anna, interfaces=32)
    laser = LocProxy(anna, interfaces=2).get_pose(1)
    assert isinstance(laser, LaserPose) and len(laser.pose) == 8


def test_the_robot_is_told_where_it_is(anna: Client) -> None:
    loc = LocProxy(anna, interfaces=8)
    x_m, y_m, _, theta_rad, *_ = loc.get_pose(3).pose
    with anna.driving():
        loc.set_pose(x_m + 0.05, y_m - 0.05, theta_rad + 0.02)
        assert loc.get_setter(3) is Setter.JUST_SET
        assert loc.get_pose(3).pose[:2] == pytest.approx((x_m + 0.05, y_m - 0.05), abs=0.02)
        loc.set_pose(x_m, y_m, theta_rad)


def test_a_lower_link_obeys_only_while_the_one_above_is_stopped(whole: Whole, anna: Client) -> None:
    drive, avoid, motion = DriveProxy(anna), AvoidProxy(anna), MotionProxy(anna)
    with anna.driving():
        with pytest.raises(WrongStateError, match=r"drive obeys the module avoid .* AvoidProxy\.release_robot\(\) first"):
            drive.set_velocity(0.2, 0.0)
        with pytest.raises(WrongStateError, match=r"avoidance obeys the module motion .* MotionProxy\.release_robot\(\) first"):
            avoid.goto(3.0, 0.0)
        motion.release_robot()
        assert (motion.is_running, avoid.is_running, drive.is_running) == (False, False, True)
        assert motion.motion_status() is MotionStatus.STOPPED_THREAD and avoid.goto_status() is GotoStatus.STOPPED_THREAD
        drive.set_velocity(0.2, 0.0)
        assert whole.speeds(1.5)[0] == pytest.approx(0.2, abs=0.03)
        assert drive.accepted().velocity == (0.2, 0.0) and drive.accepted().flags == 10
        assert whole.speeds(5.0)[0] == pytest.approx(0.0, abs=0.01), "nobody said it again within 4 s"
        drive.hold_heading(0.5, 0.1)
        whole.speeds(3.0)
        assert BaseProxy(anna).odometry().position[1] == pytest.approx(0.5, abs=0.1)
        avoid.start_activity()
        x_m, y_m, _ = whole.raw.pose
        avoid.goto(x_m + 1.0, y_m, sensors=Avoidance.LASER)
        while avoid.accepted().flags != 22 or avoid.goto_status() is GotoStatus.RUNNING:
            anna.receive(0.2)
        assert avoid.goto_status() is GotoStatus.REACHED
        assert math.dist(whole.raw.pose[:2], (x_m + 1.0, y_m)) < 0.5
    assert whole.speeds(2.0)[0] == pytest.approx(0.0, abs=0.01)
    assert drive.status().data == (0.0, 0.0)


def test_a_proxy_starts_the_module_that_it_needs(whole: Whole, anna: Client) -> None:
    MotionProxy(anna).stop_activity()
    AvoidProxy(anna).stop_activity()
    states = {row.get("name"): row.get("state") for row in anna.request("modules")}
    assert (states["motion"], states["avoid"]) == ("stopped", "stopped")
    assert MotionProxy(anna).is_running and AvoidProxy(anna).is_running, "starting motion starts avoidance"


def test_nobody_drives_without_the_lease(anna: Client) -> None:
    with pytest.raises(NoLeaseError, match="acquire it first"):
        MotionProxy(anna).moveto(1.0, 0.0)


def test_motion_takes_the_rectangle_and_shows_it(whole: Whole, anna: Client) -> None:
    motion = MotionProxy(anna)
    with anna.driving():
        motion.set_rectangle(2.0, 5.0, 0.0, 0.0, 0.0)
        anna.receive(0.5)
        assert motion.motion_status() is MotionStatus.AT_REST_WITH_RECTANGLE
        motion.set_rectangle(0.0, 0.0, 0.0, 0.0, 0.0)
        anna.receive(0.5)
        assert motion.motion_status() is MotionStatus.AT_REST


def test_the_wrist_points_where_it_is_told(anna: Client) -> None:
    wrist = WristProxy(anna)
    with anna.driving():
        wrist.move(0.4, -0.2)
        anna.receive(3.0)
        assert wrist.state().position == pytest.approx((0.4, -0.2), abs=0.02)
        with pytest.raises(ValueError, match="above 0, found 0 and 1"):
            wrist.move(0.0, 0.0, velocity_radps=0.0)
        wrist.move(0.0, 0.0)


def test_the_outputs_of_a_run_come_back(anna: Client) -> None:
    with anna.driving():
        result = anna.run("MakeTurn", angle_deg=20)
    assert result.is_success and result.outputs["reason"] == ""


def test_each_sensor_has_its_proxy(whole: Whole, anna: Client) -> None:
    platform = whole.raw.system.options.robot.devices
    assert len(SonarProxy(anna).ranges().ranges_m) > 4 and not BumperProxy(anna).pressed().front
    assert BaseProxy(anna).battery().voltage_v > 10.0
    assert SickProxy(anna).rwi181().count == 181 and SickProxy(anna).timing().count == SickProxy(anna).scan().count
    assert abs(DmuProxy(anna).state().psi_rad) < 0.1 and DmuProxy(anna).raw().stamp_s > 0.0
    assert platform.compass is None or abs(CompassProxy(anna).heading().heading_rad) < 7.0
    assert platform.gps is None or GpsProxy(anna).is_precise() in (True, False)


def test_what_this_robot_has_not_is_said_by_name(whole: Whole, anna: Client) -> None:
    here = {part.module.name for part in whole.raw.system.parts}
    known = {row.name for row in MODULES}
    lacking = [proxy for proxy in PROXIES if proxy.MODULE not in here]
    assert lacking
    for proxy in lacking:
        with pytest.raises(BadRequestError) as error:
            proxy(anna)
        why = "it has world, base" if proxy.MODULE in known else "it is not there yet and comes with a later version"
        assert f'no module "{proxy.MODULE}": {why}' in error.value.text


def test_a_proxy_lets_go_of_its_own_client_alone(whole: Whole, anna: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Client] = []

    def make(name: str) -> Client:
        made.append(whole.client(name=name))
        return made[-1]

    monkeypatch.setattr("pluto_bt.gateway.proxies.proxy.Client", make)
    with LocProxy(interfaces=9) as loc, LocProxy(anna) as other:
        assert loc.get_pose(0).stamp_s > 0.0 and other.client is anna
    with pytest.raises(BadRequestError, match="no module"):
        next(proxy for proxy in PROXIES if proxy.MODULE == "weather")()
    assert anna.is_connected and [client.is_connected for client in made] == [False, False]
