"""Adapter `imu`: an orientation sensor that knows its heading (3DM-GX1)."""

from __future__ import annotations

from math import isnan

from drivers.records import InertialRecord
from pluto_bt.blackboard.messages import ImuState
from pluto_bt.modules.context import Context
from pluto_bt.modules.relay import Relay


def sum_of_numbers(record: InertialRecord) -> float:
    """Not finite if anything but theta is not; theta is NaN in a sensor that does not know it."""
    return sum(record.turn_rates_radps) + sum(record.accelerations_mps2) + record.phi_rad + record.psi_rad


def imu_state(record: InertialRecord) -> ImuState:
    """The record as a message. `bias_known` says that theta can be used as a heading: the sensor removes its bias itself."""
    known = not isnan(record.theta_rad)
    theta_rad = record.theta_rad if known else 0.0
    return ImuState(record.stamp_s, theta_rad, record.phi_rad, record.psi_rad, record.turn_rates_radps, record.accelerations_mps2, 0.0, known)


class Imu(Relay[InertialRecord]):
    """`imu/state` from the sensor."""

    def __init__(self, context: Context) -> None:
        super().__init__(context, "imu", "imu/state", InertialRecord, sum_of_numbers, imu_state)
