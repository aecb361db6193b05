"""What the sensors say of a known truth: closed forms without noise, statistics with it, and the manual's ideal dummies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from sim_worlds import box, cart, of_type, points, room, run, shipped

from drivers.records import (
    BatteryRecord,
    BumperRecord,
    CompassRecord,
    GpsRecord,
    InertialRecord,
    MarkerRecord,
    OdometryRecord,
    ScanRecord,
    SonarRecord,
    SpeedRecord,
    WristRecord,
)
from pluto_bt.maps.platform import Bumpers, Compass, Gps, Inertial, Laser, MarkerCamera, Odometry, Sonar, Transducer, WheelSpeed, Wrist
from pluto_bt.maps.world import Actor, Marker, Shadow, Shape, Terrain, World
from sim import BaseDevice, Simulator, WristDevice
from sim.outfit import STOOD_FOR_S

FIELD = points((-50, -50), (50, -50), (50, 50), (-50, 50))
LASER: dict[str, Any] = {"x_m": 0.3, "z_m": 0.6, "beams": 181}


def scans(sim: Simulator) -> list[ScanRecord]:
    """What the laser has delivered."""
    return of_type(sim.devices["laser"].read(), ScanRecord)


def test_a_scan_has_the_truth_of_its_stamp_and_arrives_later() -> None:
    sim = Simulator(room(), cart(laser=Laser(**LASER, resolution_m=0.0, arrival_delay_s=0.19)), 0)
    truth: dict[float, float] = {}
    arrivals: list[tuple[float, ScanRecord]] = []

    def note() -> None:
        truth[round(sim.time_s, 6)] = sim.pose[0]
        arrivals.extend((sim.time_s, scan) for scan in scans(sim))

    run(sim, 4.0, 0.5, each=note)
    assert len(arrivals) == 20  # every 0.2 s from 0 to 3.8; that of 4.0 has not arrived
    for seen_s, scan in arrivals:
        assert scan.arrival_s == pytest.approx(scan.stamp_s + 0.19)
        assert scan.arrival_s <= seen_s + 1e-9 < scan.arrival_s + 0.02 + 1e-9
        x = truth.get(round(scan.stamp_s, 6), 0.0)
        assert scan.ranges_m[90] == pytest.approx(5.0 - 0.3 - x, abs=1e-9)
        assert scan.ranges_m[0] == pytest.approx(5.0, abs=1e-9)


def test_the_laser_counts_whole_centimetres_and_never_beyond_its_range() -> None:
    sim = run(Simulator(room(), cart(laser=Laser(**LASER, max_range_m=5.2, noise_m=0.02)), 3), 4.0)
    ranges = np.array([scan.ranges_m for scan in scans(sim)])
    assert np.abs(ranges * 100 - np.rint(ranges * 100)).max() < 1e-9
    assert ranges.max() == 5.2
    assert (ranges[:, 45] == 5.2).all()  # the corner is farther


def test_laser_noise_drop_outs_and_dazzle_have_the_figures_of_the_platform() -> None:
    figures = Laser(**LASER, rate_hz=50.0, resolution_m=0.0, noise_m=0.02, dropout_rate=0.05, dazzle_rate=0.02, arrival_delay_s=0.0)
    sim = run(Simulator(room(), cart(laser=figures), 4), 10.0)
    true = run(Simulator(room(), cart(laser=Laser(**LASER, resolution_m=0.0, arrival_delay_s=0.0)), 4), 0.1)
    expected = scans(true)[0].ranges_m
    errors = np.array([scan.ranges_m for scan in scans(sim)]) - expected
    lost, dazzled = errors > 10.0, errors < -0.15
    assert lost.mean() == pytest.approx(0.05, rel=0.05)
    assert dazzled.mean() == pytest.approx(0.02, rel=0.15)
    assert errors[~lost & ~dazzled].std() == pytest.approx(0.02, rel=0.02)


def test_records_of_scans_cannot_be_changed() -> None:
    sim = run(Simulator(room(), cart(laser=Laser(**LASER)), 0), 0.5)
    with pytest.raises(ValueError, match="read-only"):
        scans(sim)[0].ranges_m[0] = 1.0


def test_the_wrist_turns_the_laser() -> None:
    low = box("kerb", 2.0, -1.0, 0.2, 2.0, height_m=0.3)
    sim = Simulator(room(low), cart(laser=Laser(**LASER, resolution_m=0.0), wrist=Wrist(max_rate_dps=90.0, max_acceleration_dps2=900.0)), 0)
    wrist = sim.devices["wrist"]
    assert isinstance(wrist, WristDevice)
    level = scans(run(sim, 1.0))[-1].ranges_m[90]
    assert level == pytest.approx(4.7)  # it looks over the kerb
    wrist.move(0.5, 0.0, 1.5, 10.0)
    panned = scans(run(sim, 2.0))[-1].ranges_m[90]
    assert panned == pytest.approx(4.7 / math.cos(0.5), abs=1e-6)
    wrist.move(0.0, 0.3, 1.5, 10.0)
    tilted = scans(run(sim, 2.0))[-1].ranges_m[90]
    assert tilted == pytest.approx(1.7 / math.cos(0.3), abs=0.11)  # down onto the kerb: its face or its top
    last = of_type(wrist.read(), WristRecord)[-1]
    assert (last.pan_rad, last.tilt_rad, last.tilt_rate_radps) == (0.0, 0.3, 0.0)


def test_sonar_sees_the_nearest_thing_in_its_cone_within_its_limits() -> None:
    quarters = (0.0, math.pi / 2, math.pi, -math.pi / 2)
    ring = tuple(Transducer(x_m=0.4 * math.cos(a), y_m=0.4 * math.sin(a), theta_deg=math.degrees(a)) for a in quarters)
    post = Shape("post", "circle", points((2.0, 0.2)), radius_m=0.1)
    near = box("near", -0.49, -4.0, 0.0 + 0.05, 3.4)
    sonar = Sonar(transducers=ring, max_range_m=4.0, min_range_m=0.25, cone_deg=30.0)
    sim = run(Simulator(room(post, near), cart(sonar=sonar), 0), 0.5)
    front, left, _back, right = of_type(sim.devices["base"].read(), SonarRecord)[-1].ranges_m
    assert front == pytest.approx(math.hypot(1.6, 0.2) - 0.1, abs=1e-6)
    assert left == 4.0
    assert right >= 0.25


def test_sonar_noise_and_drop_outs() -> None:
    sonar = Sonar(transducers=(Transducer(x_m=0.5, y_m=0.0, theta_deg=0.0),), noise_m=0.03, dropout_rate=0.1, rate_hz=50.0)
    sim = run(Simulator(room(), cart(sonar=sonar), 1), 10.0)
    ranges = np.array([record.ranges_m[0] for record in of_type(sim.devices["base"].read(), SonarRecord)])
    assert (ranges == 8.0).mean() == pytest.approx(0.1, abs=0.03)
    assert ranges[ranges < 8.0].std() == pytest.approx(0.03, rel=0.15)


def test_encoders_without_errors_count_the_truth_in_whole_counts() -> None:
    sim = run(Simulator(room(), cart(odometry=Odometry(counts_per_m=1000.0)), 0), 3.0, 0.5, 0.4)
    last = of_type(sim.devices["base"].read(), OdometryRecord)[-1]
    assert last.distance_m == pytest.approx(sim.distance_m, abs=0.0011)
    assert last.heading_rad == pytest.approx(sim.pose[2], abs=0.0021 / 0.6)
    assert (last.distance_m * 2000.0) == pytest.approx(round(last.distance_m * 2000.0), abs=1e-6)
    assert (last.speed_mps, last.turn_rate_radps) == pytest.approx((0.5, 0.4), abs=0.2)


def test_scale_errors_are_drawn_once_a_run_and_spread_over_seeds() -> None:
    ratios = []
    for seed in range(60):
        sim = run(Simulator(World("w"), cart(odometry=Odometry(distance_scale_noise=0.05, turn_scale_noise=0.1)), seed), 1.0, 0.8)
        records = of_type(sim.devices["base"].read(), OdometryRecord)
        ratio = records[-1].distance_m / sim.distance_m
        assert records[25].distance_m / (0.8 * 0.5 - 0.16) == pytest.approx(ratio, rel=0.01)
        ratios.append(ratio)
    assert np.std(ratios) == pytest.approx(0.05, rel=0.3)
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.03)


def test_odometry_noise_grows_with_the_square_root_of_the_way() -> None:
    ends = []
    for seed in range(40):
        sim = run(Simulator(World("w"), cart(odometry=Odometry(distance_noise=0.02)), seed), 4.2, 1.0)
        ends.append(of_type(sim.devices["base"].read(), OdometryRecord)[-1].distance_m - sim.distance_m)
    assert np.std(ends) == pytest.approx(0.02 * math.sqrt(4.0), rel=0.35)


@pytest.mark.parametrize("slip", [0.2, 0.6])
def test_on_slippery_ground_the_encoders_run_ahead_of_the_robot(slip: float) -> None:
    sim = run(Simulator(World("w", terrains=(Terrain("mud", FIELD, slip=slip),)), cart(odometry=Odometry(counts_per_m=1e6)), 0), 5.0, 0.5)
    last = of_type(sim.devices["base"].read(), OdometryRecord)[-1]
    assert sim.distance_m == pytest.approx((1.0 - slip) * last.distance_m, abs=1e-4)


def test_gyro_bias_is_drawn_once_and_drifts() -> None:
    still = run(Simulator(World("w"), cart(dmu=Inertial(bias_dps=1.0, noise_dps=0.1)), 5), 20.0)
    rates = np.array([record.turn_rates_radps[2] for record in of_type(still.devices["dmu"].read(), InertialRecord)])
    assert rates.std() == pytest.approx(math.radians(0.1), rel=0.1)
    assert abs(rates.mean()) > 5 * math.radians(0.1) / math.sqrt(rates.size)
    finals = []
    for seed in range(40):
        sim = run(Simulator(World("w"), cart(dmu=Inertial(drift_dps_per_sqrt_s=0.1)), seed), 4.0)
        finals.append(of_type(sim.devices["dmu"].read(), InertialRecord)[-1].turn_rates_radps[2])
    assert np.std(finals) == pytest.approx(math.radians(0.1) * math.sqrt(STOOD_FOR_S + 4.0), rel=0.35)


def test_an_inertial_sensor_feels_turning_speeding_up_and_gravity() -> None:
    sim = run(Simulator(World("w"), cart(dmu=Inertial(), imu=Inertial(absolute=True)), 0, start=(0, 0, 1.0)), 0.24, 1.0, 0.5)
    first = [record for record in of_type(sim.devices["dmu"].read(), InertialRecord) if record.stamp_s > 0.05]
    assert all(record.accelerations_mps2[0] == pytest.approx(2.0) for record in first)
    run(sim, 1.0, 1.0, 0.5)
    last = of_type(sim.devices["imu"].read(), InertialRecord)[-1]
    assert last.turn_rates_radps == pytest.approx((0.0, 0.0, 0.5))
    assert last.accelerations_mps2 == pytest.approx((0.0, 0.5, 9.80665))
    assert last.theta_rad == pytest.approx(sim.pose[2])
    assert math.isnan(of_type(sim.devices["dmu"].read(), InertialRecord)[-1].theta_rad)


def test_the_angles_of_an_orientation_sensor_wander_slowly() -> None:
    figures = Inertial(absolute=True, angle_wander_deg=1.0, angle_wander_s=10.0)
    errors = []
    for seed in range(30):
        sim = run(Simulator(World("w"), cart(imu=figures), seed), 40.0)
        errors.append([record.theta_rad for record in of_type(sim.devices["imu"].read(), InertialRecord)])
    angles = np.degrees(np.array(errors))
    assert np.std(angles) == pytest.approx(1.0, rel=0.25), "at any time, also at the start"
    assert np.std(angles[:, 0]) == pytest.approx(1.0, rel=0.5)
    steps = angles[:, 50:] - angles[:, :-50]  # over a second
    assert np.std(steps) == pytest.approx(math.sqrt(2.0 * (1.0 - math.exp(-0.1))), rel=0.15)


def test_a_slope_is_felt_as_tilt() -> None:
    sim = run(Simulator(World("w", terrains=(Terrain("hill", FIELD, pitch_rad=0.2, roll_rad=-0.1),)), cart(dmu=Inertial()), 0), 1.0)
    last = of_type(sim.devices["dmu"].read(), InertialRecord)[-1]
    assert (last.phi_rad, last.psi_rad) == pytest.approx((0.2, -0.1))
    assert last.accelerations_mps2[0] == pytest.approx(-9.80665 * math.sin(0.2))
    assert math.hypot(*last.accelerations_mps2) == pytest.approx(9.80665)


def test_iron_and_shadows_turn_the_compass() -> None:
    iron = Terrain("iron", points((-1, -1), (1, -1), (1, 1), (-1, 1)), magnetic_rad=0.3)
    shadow = Shadow("compass", points((2, -1), (4, -1), (4, 1), (2, 1)))
    turns = []
    for seed, x in ((0, 0.0), (0, -2.0), (0, 3.0), (1, 3.0)):
        sim = run(Simulator(World("w", terrains=(iron,), shadows=(shadow,)), cart(compass=Compass()), seed, start=(x, 0.0, 0.5)), 0.5)
        turns.append(of_type(sim.devices["compass"].read(), CompassRecord)[-1].heading_rad - 0.5)
    assert turns[:2] == pytest.approx([0.3, 0.0])
    assert all(math.radians(30) <= abs(turn) <= math.radians(90) for turn in turns[2:])
    assert turns[2] != turns[3]


def test_gps_says_how_good_it_is_and_knows_nothing_in_a_shadow() -> None:
    shadow = Shadow("gps", points((2, -1), (40, -1), (40, 1), (2, 1)))
    open_sky = run(Simulator(World("w", shadows=(shadow,)), cart(gps=Gps(noise_m=0.1, rate_hz=10.0)), 2), 60.0)
    records = of_type(open_sky.devices["gps"].read(), GpsRecord)
    good = [record for record in records if record.quality == 2]
    assert all(record.satellites > 5 for record in good)
    assert np.std([record.x_m for record in good]) == pytest.approx(0.1, rel=0.15)
    dark = run(Simulator(World("w", shadows=(shadow,)), cart(gps=Gps(noise_m=0.1)), 2, start=(3.0, 0.0, 0.0)), 10.0)
    assert {(record.quality, record.satellites < 4) for record in of_type(dark.devices["gps"].read(), GpsRecord)} == {(0, True)}


def test_the_camera_reads_the_nearest_marker_in_range() -> None:
    markers = (Marker(7, 0.0, 1.0, 0.0), Marker(8, 0.0, 1.5, 0.0), Marker(9, 9.0, 0.0, 0.0))
    world = World("w", markers=markers, shadows=(Shadow("marker", points((-9, -9), (-5, -9), (-5, 9), (-9, 9))),))
    camera = MarkerCamera(range_m=3.0, delay_s=0.2, rate_hz=5.0)
    for x, expected in ((0.0, 7), (8.0, 9), (4.5, -1), (-6.0, -1)):
        sim = run(Simulator(world, cart(marker=camera), 0, start=(x, 0.0, 0.4)), 1.0)
        records = of_type(sim.devices["marker"].read(), MarkerRecord)
        assert {record.marker for record in records} == {expected}
        assert all(record.arrival_s == pytest.approx(record.stamp_s + 0.2) for record in records)
        assert all((record.quality == 0.0) == (expected == -1) for record in records)


def test_marker_readings_are_noisy_sometimes_poor_and_seldom_nonsense() -> None:
    camera = MarkerCamera(noise_m=0.03, angle_noise_deg=2.0, outlier_rate=0.02, rate_hz=50.0, delay_s=0.0)
    sim = run(Simulator(World("w", markers=(Marker(1, 0.0, 0.0, 0.0),)), cart(marker=camera), 1), 20.0)
    records = of_type(sim.devices["marker"].read(), MarkerRecord)
    quality = np.array([record.quality for record in records])
    errors = np.array([math.hypot(record.x_m, record.y_m) for record in records])
    angles = np.abs([record.theta_rad for record in records])
    good = quality >= 0.25
    assert 0.02 < (quality < 0.25).mean() < 0.07
    assert 0 < (quality > 1.0).mean() < 0.03
    assert 0.005 < ((errors > 0.5) | (angles > 1.0))[good].mean() < 0.04
    assert np.sqrt((errors[good & (errors < 0.3)] ** 2).mean() / 2) == pytest.approx(0.03, rel=0.15)


def test_wheel_speed_has_no_sign_and_goes_on_when_the_car_is_held() -> None:
    sim = run(Simulator(room(), cart(speed=WheelSpeed()), 0), 2.0, -0.5)
    assert of_type(sim.devices["speed"].read(), SpeedRecord)[-1].speed_mps == pytest.approx(0.5)
    run(sim, 12.0, -0.5)
    assert sim.velocity[0] == 0.0
    assert of_type(sim.devices["speed"].read(), SpeedRecord)[-1].speed_mps == pytest.approx(0.5)


def test_the_battery_runs_down_faster_when_driving() -> None:
    idle, driving = (of_type(run(Simulator(World("w"), cart(), 0), 20.0, v).devices["base"].read(), BatteryRecord) for v in (0.0, 0.5))
    full = idle[0].voltage_v
    assert full - driving[-1].voltage_v == pytest.approx(20.0 / (5.0 * 3600.0) * 4.0, rel=0.05)
    assert full - idle[-1].voltage_v == pytest.approx((full - driving[-1].voltage_v) / 4.0, rel=0.15)


def test_the_ideal_robot_is_the_manuals_dummy() -> None:
    mud = Terrain("mud", FIELD, slip=0.5, magnetic_rad=1.0)
    robot = shipped("atrv2")
    sim = run(Simulator(room(box("crate", 2.0, -1.0, 1.0, 2.0), terrains=(mud,)), robot, 9, start=(0, 0, 0.1), ideal=True), 12.0, 0.4)
    base = sim.devices["base"].read()
    odometry = of_type(base, OdometryRecord)[-1]
    assert odometry.distance_m == pytest.approx(sim.distance_m, abs=1e-12)
    assert odometry.heading_rad == pytest.approx(sim.pose[2] - 0.1, abs=1e-12)
    assert {record.ranges_m for record in of_type(base, SonarRecord)} == {(8.0,) * 12}
    assert {(record.front, record.back) for record in of_type(base, BumperRecord)} == {(False, False)}
    assert of_type(sim.devices["dmu"].read(), InertialRecord)[-1].turn_rates_radps == (0.0, 0.0, 0.0)
    assert of_type(sim.devices["compass"].read(), CompassRecord)[-1].heading_rad == pytest.approx(sim.pose[2])
    assert len(sim.collisions) == 1


def test_the_world_file_can_ask_for_the_ideal_robot() -> None:
    from pluto_bt.maps.world import RobotStart

    world = room(robot=RobotStart(ideal=True, pose=(1.0, 1.0, 0.0)))
    sim = run(Simulator(world, shipped("pioneer"), 0), 1.0)
    assert {record.ranges_m for record in of_type(sim.devices["base"].read(), SonarRecord)} == {(8.0,) * 16}
    assert sim.pose == (1.0, 1.0, 0.0)


@pytest.mark.parametrize("name", ["atrv2", "car", "jbot", "pioneer"])
def test_every_shipped_robot_drives_and_has_the_devices_of_its_file(name: str) -> None:
    robot = shipped(name)
    walker = Actor("person", 0.25, 1.0, True, points((3.0, 3.0), (-3.0, 3.0)))
    sim = run(Simulator(room(actors=(walker,), markers=(Marker(1, 0.0, 0.0, 0.0),)), robot, 0), 3.0, 0.3, 0.1)
    fitted = {"laser", "wrist", "dmu", "imu", "compass", "gps", "marker", "speed"}
    assert set(sim.devices) == {"base"} | {device for device in fitted if getattr(robot.devices, device) is not None}
    assert all(sim.devices[device].read() for device in sim.devices)
    assert sim.distance_m == pytest.approx(0.85, abs=0.2)


def test_bumpers_are_open_far_from_everything() -> None:
    sim = run(Simulator(World("w"), cart(bumpers=Bumpers()), 0), 1.0, 0.5)
    assert {(record.front, record.back) for record in of_type(sim.devices["base"].read(), BumperRecord)} == {(False, False)}
    assert isinstance(sim.devices["base"], BaseDevice)
