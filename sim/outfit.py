"""Fits a robot out: every device that the platform has, with its sensors, each with its own stream of chance."""

from __future__ import annotations

from dataclasses import dataclass

from pluto_bt.maps import platform
from pluto_bt.maps.world import World
from sim.body import Body
from sim.channel import Channel, Sensor
from sim.device import BaseDevice, Device
from sim.ground import Ground
from sim.noise import Noise
from sim.outline import Outline
from sim.record_faults import RecordFaults
from sim.sensors.battery import BatterySensor
from sim.sensors.bumpers import BumperSensor
from sim.sensors.compass import CompassSensor
from sim.sensors.gps import GpsSensor
from sim.sensors.inertial import InertialSensor
from sim.sensors.laser import LaserSensor
from sim.sensors.marker import MarkerSensor
from sim.sensors.odometry import OdometrySensor
from sim.sensors.sonar import SonarSensor
from sim.sensors.wheel_speed import WheelSpeedSensor
from sim.sensors.wrist_state import WristSensor
from sim.simtime import SimTime
from sim.surroundings import Surroundings
from sim.travel import Travel
from sim.wrist import WristDevice

STOOD_FOR_S = 21.0  # the robot has been switched on and standing for so long when the run begins: enough for the bias of its gyro


@dataclass(frozen=True)
class Setting:
    """What the sensors measure."""

    world: World
    platform: platform.Platform
    body: Body
    outline: Outline
    ground: Ground
    around: Surroundings
    travel: Travel
    time: SimTime
    seed: int
    ideal: bool

    def noise(self, name: str) -> Noise:
        """The streams of chance of one sensor."""
        return Noise(self.seed, name)


class Outfit:
    """`devices` by name, as drivers offer them; `channels` by name, in the order in which equal due times are served."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self.devices: dict[str, Device] = {}
        self.channels: dict[str, Channel] = {}
        self.wrist: WristDevice | None = None
        self._fit_base(setting.platform)
        self._fit_wrist_and_laser(setting.platform.devices)
        self._fit_inertial(setting.platform.devices)
        self._fit_position(setting.platform.devices)

    def _fit(self, name: str, sensor: Sensor, device: Device | None = None) -> None:
        """Add a sensor, on a device of its own unless one is given."""
        setting = self._setting
        if device is None:
            device = self.devices[name] = Device(name, setting.time)
        self.channels[name] = Channel(name, sensor, device, RecordFaults(setting.noise(f"{name} fault")))

    def _fit_base(self, robot: platform.Platform) -> None:
        """Odometry, battery, and the sonars and bumpers that hang on the base's controller."""
        s, devices = self._setting, robot.devices
        base = self.devices["base"] = BaseDevice("base", s.time, s.body.motors)
        track_m = robot.body.effective_track_m or robot.body.track_m
        odometry = OdometrySensor(devices.odometry, track_m, s.body, s.noise("odometry"), s.ideal)
        base.on_calibrate = odometry.calibrate
        self._fit("odometry", odometry, base)
        if devices.bumpers:
            self._fit("bumpers", BumperSensor(devices.bumpers, s.outline, s.body, s.around, s.travel, s.ideal), base)
        if devices.sonar:
            self._fit("sonar", SonarSensor(devices.sonar, s.around, s.body, s.noise("sonar"), s.ideal), base)
        self._fit("battery", BatterySensor(devices.battery, s.body, s.ideal), base)

    def _fit_wrist_and_laser(self, devices: platform.Devices) -> None:
        s = self._setting
        if devices.wrist:
            self.wrist = self.devices["wrist"] = WristDevice("wrist", s.time, devices.wrist)
            self._fit("wrist", WristSensor(devices.wrist, self.wrist), self.wrist)
        if devices.laser:
            self._fit("laser", LaserSensor(devices.laser, s.around, s.body, self.wrist, s.noise("laser"), s.ideal))

    def _fit_inertial(self, devices: platform.Devices) -> None:
        s = self._setting
        for name, figures in (("dmu", devices.dmu), ("imu", devices.imu)):
            if figures:
                self._fit(name, InertialSensor(figures, s.body, s.ground, s.noise(name), s.ideal))
        if devices.dmu:
            self.channels["dmu"].send_past(STOOD_FOR_S)
        if devices.compass:
            n_shadows = sum(shadow.sensor == "compass" for shadow in s.world.shadows)
            self._fit("compass", CompassSensor(devices.compass, n_shadows, s.body, s.ground, s.noise("compass"), s.ideal))

    def _fit_position(self, devices: platform.Devices) -> None:
        s = self._setting
        if devices.gps:
            self._fit("gps", GpsSensor(devices.gps, s.body, s.ground, s.noise("gps"), s.ideal))
        if devices.marker:
            self._fit("marker", MarkerSensor(devices.marker, s.world.markers, s.body, s.ground, s.noise("marker"), s.ideal))
        if devices.speed:
            self._fit("speed", WheelSpeedSensor(devices.speed, s.body, s.noise("speed"), s.ideal))
