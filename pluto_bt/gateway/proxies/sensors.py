"""The sensors (manual, section 8): a method an interface, each gives the newest message."""

from __future__ import annotations

from pluto_bt.blackboard.messages import (
    ActuatorState,
    AlarmState,
    BatteryState,
    BumperState,
    CompassState,
    GasState,
    GpsState,
    ImuState,
    LaserScan,
    MarkerState,
    ScanTiming,
    SonarState,
    SpeedState,
    WeatherState,
)
from pluto_bt.gateway.proxies.proxy import Proxy

PRECISE_SATELLITES, PRECISE_QUALITY = 5, 2  # manual, section 8.4


class BaseProxy(Proxy):
    """The base: odometry and battery."""

    MODULE = "base"

    def odometry(self) -> ActuatorState:
        """position = way (m) and heading (rad), velocity = real velocities."""
        return self._newest("ATRV2/Drive/Raw", ActuatorState)

    def battery(self) -> BatteryState:
        """Its voltage."""
        return self._newest("ATRV2/Battery", BatteryState)


class SonarProxy(Proxy):
    """The sonar ring of the base."""

    MODULE = "base"

    def ranges(self) -> SonarState:
        """One range a transducer (m)."""
        return self._newest("ATRV2/Sonar", SonarState)


class BumperProxy(Proxy):
    """The bumpers of the base."""

    MODULE = "base"

    def pressed(self) -> BumperState:
        """Front and back."""
        return self._newest("ATRV2/Bumper", BumperState)


class SickProxy(Proxy):
    """The laser scanner; −1 in every beam after a fatal error."""

    MODULE = "sick"

    def rwi181(self) -> LaserScan:
        """First interface: 181 points, stamped at arrival."""
        return self._newest("sick/rwi181", LaserScan)

    def scan(self) -> LaserScan:
        """Second interface: every point, stamped mid-scan."""
        return self._newest("sick/scan", LaserScan)

    def timing(self) -> ScanTiming:
        """Third interface: when, and how many points."""
        return self._newest("sick/timing", ScanTiming)


class DmuProxy(Proxy):
    """The inertial sensor."""

    MODULE = "dmu"

    def raw(self) -> ImuState:
        """As measured, z up."""
        return self._newest("dmu/raw", ImuState)

    def state(self) -> ImuState:
        """Filtered; theta = rotation since the start."""
        return self._newest("dmu/state", ImuState)


class ImuProxy(Proxy):
    """The orientation sensor of jBot."""

    MODULE = "imu"

    def state(self) -> ImuState:
        """Absolute angles."""
        return self._newest("imu/state", ImuState)

    def alarms(self) -> AlarmState:
        """Stasis, stuck wheels, tilt."""
        return self._newest("imu/alarms", AlarmState)


class CompassProxy(Proxy):
    """The compass."""

    MODULE = "compass"

    def heading(self) -> CompassState:
        """On the map, counter-clockwise from x."""
        return self._newest("compass/state", CompassState)


class GpsProxy(Proxy):
    """GPS, in metres of the map."""

    MODULE = "gps"

    def position(self) -> GpsState:
        """Where, by how many satellites, of what quality."""
        return self._newest("gps/state", GpsState)

    def is_precise(self) -> bool:
        """More than 5 satellites and quality 2: better than a metre."""
        state = self.position()
        return state.satellites > PRECISE_SATELLITES and state.quality >= PRECISE_QUALITY


class MarkerProxy(Proxy):
    """The camera markers of the car."""

    MODULE = "marker"

    def position(self) -> MarkerState:
        """The last marker, and what the gate said of it."""
        return self._newest("car/marker", MarkerState)


class SpeedProxy(Proxy):
    """The wheel speed of the car."""

    MODULE = "speed"

    def speed(self) -> SpeedState:
        """Unsigned."""
        return self._newest("car/speed", SpeedState)


class WeatherProxy(Proxy):
    """The weather sensor."""

    MODULE = "weather"

    def state(self) -> WeatherState:
        """Air and wind."""
        return self._newest("weather/state", WeatherState)


class GasProxy(Proxy):
    """The gas sensor."""

    MODULE = "gas"

    def state(self) -> GasState:
        """Concentrations."""
        return self._newest("gas/state", GasState)
