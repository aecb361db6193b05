"""The five pose interfaces, setters, and the car's markers."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import pytest

from drivers.records import MarkerRecord
from estimation.se2 import compose, inverse
from pluto_bt.blackboard.messages import ActuatorState, ImuState, Pose, ScanTiming, SpeedState
from pluto_bt.maps.geometry import wrap_angle
from pluto_bt.maps.platform import Inertial, Laser, MarkerCamera, WheelSpeed
from pluto_bt.maps.platform import Wrist as WristUnit
from pluto_bt.modules.local import Local
from pluto_bt.modules.marker import Marker
from pluto_bt.modules.post_box import refusal

DT_S = 0.02
V_MPS, W_RADPS = 0.5, 0.2
DR, POSE, POST = "Localization/Dead-Reckoning", "Localization/Pose", "Localization/Post_Pose"
LASER_DR, LASER_POSE = "Localization/Laser_Dead-Reckoning", "Localization/Laser_Pose"


def drive(rig: Any, local: Local, steps: range, pan_radps: float = 0.0) -> None:
    """Odometry, and a wrist that pans, step by step."""
    for k in steps:
        now_s = k * DT_S
        rig.put("ATRV2/Drive/Raw", ActuatorState(now_s, 0, (V_MPS * now_s, W_RADPS * now_s), (V_MPS, W_RADPS)), now_s)
        if k % 5 == 0:
            rig.put("wrist/state", ActuatorState(now_s, 0, (pan_radps * now_s, 0.1)), now_s)
        local.step(now_s)


def true_pose(start: tuple[float, float, float], t_s: float) -> tuple[float, float, float]:
    radius = V_MPS / W_RADPS
    step = (radius * math.sin(W_RADPS * t_s), radius * (1 - math.cos(W_RADPS * t_s)), W_RADPS * t_s)
    return compose(start, step)


def planar(pose: Any) -> tuple[float, float, float]:
    return (pose.pose[0], pose.pose[1], pose.pose[3])


def close(a: Any, b: Any, tolerance: float = 1e-6) -> bool:
    return math.dist(a[:2], b[:2]) < tolerance and abs(wrap_angle(a[2] - b[2])) < tolerance


def post(t_s: float, pose: tuple[float, float, float], setter: int) -> Pose:
    return Pose(t_s, (pose[0], pose[1], 0.0, pose[2], 0.0, 0.0), (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.001), setter)


def test_the_estimate_starts_at_the_start_pose_and_follows_the_wheels(make_rig: Any) -> None:
    start = (3.0, -1.0, 0.7)
    rig = make_rig(start)
    local = Local(rig.context)
    local.start(0.0)
    assert planar(rig.newest(DR)) == planar(rig.newest(POSE)) == pytest.approx(start)
    drive(rig, local, range(101))
    assert close(planar(rig.newest(DR)), true_pose(start, 2.0))
    assert rig.newest(DR).stamp_s == rig.newest(POSE).stamp_s == 2.0
    assert rig.newest(DR).covariance[0] > 0.0


def test_interface_1_is_the_laser_at_the_scans_stamp_with_pan_and_tilt(make_rig: Any) -> None:
    start = (1.0, 2.0, 0.3)
    rig = make_rig(start, laser=Laser(x_m=0.48, y_m=0.1, z_m=0.6), wrist=WristUnit())
    local = Local(rig.context)
    drive(rig, local, range(101), pan_radps=0.2)
    rig.put("sick/timing", ScanTiming(1.807, 361), 2.0)
    local.step(2.0)
    laser = rig.newest(LASER_DR)
    pan = 0.2 * 1.807
    assert laser.stamp_s == 1.807 and laser.pose[6:] == pytest.approx((pan, 0.1))
    assert close(planar(laser), compose(true_pose(start, 1.807), (0.48, 0.1, pan)))
    assert laser.pose[2] == pytest.approx(0.6) and laser.pose[4] == pytest.approx(0.1)
    assert rig.newest(LASER_POSE).pose == pytest.approx(laser.pose)


def test_covariance_of_interface_1_is_that_of_one_increment_and_of_0_since_the_start(make_rig: Any) -> None:
    rig = make_rig(laser=Laser(x_m=0.0))
    local = Local(rig.context)
    increments = []
    for i in range(1, 20):
        drive(rig, local, range(i * 10 - 9, i * 10 + 1))
        rig.put("sick/timing", ScanTiming(i * 0.2 - 0.05, 361), i * 0.2)
        local.step(i * 0.2)
        increments.append(rig.newest(LASER_DR).covariance[8])
    assert increments[5:] == pytest.approx([increments[5]] * len(increments[5:]), rel=1e-6)
    assert sum(increments) == pytest.approx(rig.newest(LASER_POSE).covariance[8], rel=1e-6)


def test_a_scan_waits_for_odometry_and_one_that_is_too_old_is_counted(make_rig: Any) -> None:
    rig = make_rig(laser=Laser(x_m=0.5))
    local = Local(rig.context)
    drive(rig, local, range(11))
    rig.put("sick/timing", ScanTiming(0.23, 361), 0.2)
    local.step(0.2)
    assert rig.newest(LASER_DR) is None
    drive(rig, local, range(11, 13))
    assert rig.newest(LASER_DR).stamp_s == 0.23
    rig.put("sick/timing", ScanTiming(-1.0, 361), 0.3)
    local.step(0.3)
    assert local.dropped == 1 and rig.newest(LASER_DR).stamp_s == 0.23


def test_a_set_pose_moves_interface_3_and_never_0(make_rig: Any) -> None:
    rig = make_rig()
    local, box = Local(rig.context), rig.context.posts
    drive(rig, local, range(101))
    before = rig.newest(DR)
    assert box.post("operator", post(1.5, (10.0, 5.0, 2.0), -1)) == ""
    local.step(2.01)
    assert rig.newest(DR).pose == before.pose
    assert rig.newest(POSE).setter == -1 and rig.newest(POST).setter == -1
    moved = compose((10.0, 5.0, 2.0), compose(inverse(true_pose((0, 0, 0), 1.5)), true_pose((0, 0, 0), 2.0)))
    assert close(planar(rig.newest(POSE)), moved)
    drive(rig, local, range(101, 120))
    assert rig.newest(POSE).setter == -1  # until the next change


def test_interface_0_never_moves_more_than_v_dt_when_2_is_written(make_rig: Any) -> None:
    rig = make_rig()
    local, box = Local(rig.context), rig.context.posts
    drive(rig, local, range(2))
    for k in range(2, 200):
        before = planar(rig.newest(DR))
        box.post("operator", post((k - 1) * DT_S, (math.sin(k) * 40, math.cos(k) * 40, k * 1.0), -1))
        drive(rig, local, range(k, k + 1))
        assert math.dist(before[:2], planar(rig.newest(DR))[:2]) <= V_MPS * DT_S + 1e-9
    assert rig.newest(POST).stamp_s == pytest.approx(198 * DT_S), "each post was taken"


def test_a_laser_pose_puts_the_laser_where_it_says(make_rig: Any) -> None:
    rig = make_rig(laser=Laser(x_m=0.48), wrist=WristUnit())
    local, box = Local(rig.context), rig.context.posts
    drive(rig, local, range(101), pan_radps=0.3)
    better = (7.0, 8.0, -1.0)
    box.post("pose", post(1.8, better, 1))
    local.step(2.0)
    rig.put("sick/timing", ScanTiming(1.8, 361), 2.0)
    local.step(2.0)
    assert close(planar(rig.newest(LASER_POSE)), better)
    assert rig.newest(LASER_POSE).setter == 1 and rig.newest(LASER_DR).setter == 0
    assert close(planar(rig.newest(POSE)), compose(_robot_of(better, 1.8), compose(inverse(true_pose((0, 0, 0), 1.8)), true_pose((0, 0, 0), 2.0))))


def _robot_of(laser: tuple[float, float, float], t_s: float) -> tuple[float, float, float]:
    return compose(laser, inverse((0.48, 0.0, 0.3 * t_s)))


def test_a_post_whose_stamp_is_forgotten_is_dropped_counted_and_said(make_rig: Any) -> None:
    rig = make_rig()
    local, box = Local(rig.context), rig.context.posts
    drive(rig, local, range(400))
    before = rig.newest(POSE)
    for stamp_s in (0.5, 99.0):
        box.post("operator", post(stamp_s, (50.0, 0.0, 0.0), -1))
    local.step(8.0)
    assert local.dropped == 2 and rig.codes() == ["stamp-not-in-history"] * 2
    assert rig.newest(POSE).setter == 0 and rig.newest(POSE).pose == before.pose


@pytest.mark.parametrize(
    ("setter", "now_set_by", "refused"),
    [
        *((s, 0, "") for s in (-1, 0, 1, 2, 3)),
        *((s, -1, "") for s in (-1, 0, 1, 2, 3)),
        *((-1, s, "wrong-state") for s in (1, 2, 3)),
        *((0, s, "") for s in (1, 2, 3)),
        (1, 1, ""), (2, 2, ""), (3, 2, ""), (2, 3, ""), (3, 3, ""),
        (1, 2, "conflict"), (1, 3, "conflict"), (2, 1, "conflict"), (3, 1, "conflict"),
        (4, 0, "bad-value"), (-2, 0, "bad-value"),
    ],
)  # fmt: skip
def test_who_may_set_the_pose_after_whom(setter: int, now_set_by: int, refused: str) -> None:
    assert refusal(setter, now_set_by) == refused


def test_a_setter_that_falls_silent_becomes_0_and_the_covariance_grows(make_rig: Any) -> None:
    rig = make_rig(laser=Laser(x_m=0.0))
    local, box = Local(rig.context), rig.context.posts
    drive(rig, local, range(51))
    box.post("pose", post(1.0, (1.0, 1.0, 1.0), 1))
    local.step(1.0)
    settled = rig.newest(POSE)
    assert settled.setter == 1 and settled.covariance[0] == pytest.approx(0.01)
    drive(rig, local, range(51, 200))
    now = rig.newest(POSE)
    assert now.setter == 0 and now.covariance[8] > settled.covariance[8]
    assert math.dist(planar(now)[:2], (1.0, 1.0)) < V_MPS * 3.1  # the last adjustment stays
    assert rig.codes() == ["pose-jump", "setter-stale"]
    assert box.post("operator", post(3.9, (0.0, 0.0, 0.0), -1)) == ""


def test_the_gyro_gives_the_heading_once_its_bias_is_known_and_the_wheels_when_it_is_stale(make_rig: Any) -> None:
    rig = make_rig(dmu=Inertial())
    local = Local(rig.context)
    local.start(0.0)
    turned = {}
    for k in range(301):
        now_s = k * DT_S
        rig.put("ATRV2/Drive/Raw", ActuatorState(now_s, 0, (0.0, 1.0 * now_s)), now_s)  # the wheels say 1 rad/s
        if k <= 200:  # the gyro says 0.5 rad/s
            rig.put("dmu/state", ImuState(now_s - 0.04, 0.5 * (now_s - 0.04), 0, 0, (0.0, 0.0, 0.5), bias_known=k > 100), now_s)
        local.step(now_s)
        turned[k] = rig.newest(DR).pose[3]
    assert turned[100] == pytest.approx(2.0)
    assert wrap_angle(turned[200] - turned[101]) == pytest.approx(0.5 * 99 * DT_S, abs=0.03)
    assert wrap_angle(turned[300] - turned[212]) == pytest.approx(1.0 * 88 * DT_S, abs=1e-9)
    assert all(abs(theta) <= math.pi for theta in turned.values())


def test_the_car_reckons_with_unsigned_speed_sign_of_command_and_gyro(make_rig: Any) -> None:
    rig = make_rig((0.5, 12.0, math.pi / 2), kinematics="ackermann", dmu=Inertial(), speed=WheelSpeed())
    local = Local(rig.context)
    rig.put("ATRV2/Drive/Command", ActuatorState(0.0, 0, velocity=(-0.4, 0.0)))
    for k in range(101):
        now_s = k * DT_S
        if k % 10 == 0:
            rig.put("car/speed", SpeedState(now_s, 0.4), now_s)
        rig.put("dmu/state", ImuState(now_s, 0.0, bias_known=True), now_s)
        local.step(now_s)
    assert close(planar(rig.newest(DR)), (0.5, 12.0 - 0.8, math.pi / 2), 1e-3)
    stamp_s = rig.newest(DR).stamp_s
    for k in range(101, 200):
        local.step(k * DT_S)
    assert rig.newest(DR).stamp_s <= stamp_s + 1.02  # speed is stale: no more poses


def test_accepted_markers_set_position_and_slowly_pull_the_heading(make_rig: Any) -> None:
    start = (0.5, 12.0, math.pi / 2)
    rig = make_rig(start, kinematics="ackermann", dmu=Inertial(), speed=WheelSpeed(), marker=MarkerCamera())
    local, marker = Local(rig.context), Marker(rig.context)
    local.start(0.0)
    for k in range(3000):
        now_s = k * DT_S
        rig.put("car/speed", SpeedState(now_s, 0.0), now_s)
        rig.put("dmu/state", ImuState(now_s, 0.002 * now_s, bias_known=True), now_s)  # drifts 0.12 rad in a minute
        if k % 15 == 10:
            quality = 0.1 if k % 30 == 10 else 0.5
            rig.devices["marker"].records = [MarkerRecord(now_s - 0.16, now_s, 7, 0.6, 12.1, math.pi / 2, quality)]
        marker.step(now_s)
        local.step(now_s)
    pose = rig.newest(POSE)
    assert planar(pose)[:2] == pytest.approx((0.6, 12.1), abs=1e-6) and pose.setter == -1
    assert abs(pose.pose[3] - math.pi / 2) < 0.03
    assert abs(rig.newest(DR).pose[3] - math.pi / 2) > 0.1
    assert rig.newest("car/marker").refused == "" and rig.newest("car/marker").accepted_count == 100


def test_a_far_marker_moves_the_pose_only_when_the_next_one_confirms_it(make_rig: Any) -> None:
    rig = make_rig((0.5, 12.0, 0.0), kinematics="ackermann", dmu=Inertial(), speed=WheelSpeed(), marker=MarkerCamera())
    local, marker = Local(rig.context), Marker(rig.context)
    local.start(0.0)
    seen = {1.0: (3.0, 9.0), 2.0: (0.5, 12.0), 6.0: (0.52, 12.01), 7.0: (1.4, 12.0), 8.0: (1.41, 12.0)}
    verdicts, places = {}, {}
    for k in range(1, 451):
        now_s = round(k * DT_S, 6)
        rig.put("car/speed", SpeedState(now_s, 0.0), now_s)
        rig.put("dmu/state", ImuState(now_s, 0.0, bias_known=True), now_s)
        if now_s in seen:
            rig.devices["marker"].records = [MarkerRecord(now_s, now_s, 7, *seen[now_s], 0.0, 0.5)]
        local.step(now_s)
        marker.step(now_s)
        if now_s in seen:
            verdicts[now_s] = rig.newest("car/marker").refused
        if now_s - 0.5 in seen:
            places[now_s - 0.5] = rig.newest(POSE).pose[:2]
    assert verdicts == {1.0: "", 2.0: "too-fast", 6.0: "", 7.0: "", 8.0: ""}
    assert places[1.0] == pytest.approx((0.5, 12.0))  # the first marker is nonsense, and there is nothing to compare it with
    assert places[6.0] == pytest.approx((0.52, 12.01))
    assert places[7.0] == pytest.approx((0.52, 12.01))  # far from the estimate, for the first time
    assert places[8.0] == pytest.approx((1.41, 12.0))  # confirmed


class Camera:
    """A car that drives along x with 0.5 m/s below markers; each reading is given as (marker, error x m, y m, heading deg)."""

    def __init__(self, make_rig: Any) -> None:
        self.rig = make_rig((0.0, 0.0, 0.0), kinematics="ackermann", dmu=Inertial(), speed=WheelSpeed(), marker=MarkerCamera())
        self._local, self._marker = Local(self.rig.context), Marker(self.rig.context)
        self._local.start(0.0)
        self.rig.put("ATRV2/Drive/Command", ActuatorState(0.0, 0, velocity=(0.5, 0.0)))
        self.k, self.repeats = 0, False

    def sees(self, *readings: tuple[int, float, float, float]) -> list[tuple[str, bool]]:
        """A reading each 0.34 s: (refused, is the car elsewhere) after each."""
        verdicts = []
        for marker, x, y, heading_deg in readings:
            for _ in range(17):
                self.k += 1
                now_s = self.k * DT_S
                self.rig.put("car/speed", SpeedState(now_s, 0.5), now_s)
                self.rig.put("dmu/state", ImuState(now_s, 0.0, bias_known=True), now_s)
                self._local.step(now_s)
            seen = MarkerRecord(now_s, now_s, marker, self.x_m + x, y, math.radians(heading_deg), 0.5)
            self._last = msgspec.structs.replace(self._last, stamp_s=now_s, arrival_s=now_s) if self.repeats else seen
            self.rig.devices["marker"].records = [self._last]
            self._marker.step(now_s)
            state = self.rig.newest("car/marker")
            verdicts.append((state.refused, state.is_elsewhere))
        return verdicts

    @property
    def x_m(self) -> float:
        """Where it is in truth, but for the first step."""
        return 0.5 * DT_S * (self.k - 1)

    @property
    def off(self) -> tuple[float, float]:
        """How far the estimate is off, m and degrees."""
        self._local.step((self.k + 0.5) * DT_S)
        x, y, theta = planar(self.rig.newest(POSE))
        return math.hypot(x - self.x_m, y), math.degrees(theta)


NEAR = (0.0, 0.0, 0.0)


def test_a_marker_that_hangs_elsewhere_moves_nothing_and_is_passed(make_rig: Any) -> None:
    camera = Camera(make_rig)
    camera.sees(*[(1, *NEAR)] * 3)
    verdicts = camera.sees(*[(2, 1.2, 0.6, 0.0)] * 8)
    assert verdicts[-1] == ("", False), "the gate lets it pass in the end"
    assert camera.off[0] < 0.05
    camera.sees(*[(3, *NEAR)] * 8)
    assert camera.off[0] < 0.05


def test_a_marker_that_hangs_turned_turns_nothing(make_rig: Any) -> None:
    camera = Camera(make_rig)
    camera.sees(*[(1, *NEAR)] * 3)
    assert camera.sees(*[(2, 0.1, 0.0, 170.0)] * 8) == [("bad-heading", False)] * 8
    assert abs(camera.off[1]) < 0.5


@pytest.mark.parametrize("markers", [(1, 1, 1), (2, 3, 3), (2, 2, 1)])  # one that agreed before, two, an unknown one and one that agreed before
def test_a_car_that_was_turned_stands_and_believes_the_third_reading(make_rig: Any, markers: tuple[int, ...]) -> None:
    camera = Camera(make_rig)
    camera.sees(*[(1, *NEAR)] * 3)
    verdicts = camera.sees(*((marker, 0.0, 0.0, 120.0) for marker in markers))
    assert verdicts[-1] == ("", False)
    assert ("bad-heading", True) in verdicts or markers == (2, 2, 1)
    assert camera.off[1] == pytest.approx(120.0, abs=1.0)
    assert any(event[1] == "pose-jump" for event in camera.rig.events)


def test_a_camera_that_repeats_itself_to_the_last_digit_holds_nobody_back(make_rig: Any) -> None:
    camera = Camera(make_rig)
    camera.sees(*[(1, *NEAR)] * 3)
    camera.repeats = True
    assert camera.sees(*[(1, *NEAR)] * 9) == [("repeated", False)] * 9
    assert camera.off[0] < 0.05
