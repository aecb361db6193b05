"""Robot physics, sensors and scripted events. Start at `Simulator`; its `devices` look to the robot's software like real ones."""

from sim.device import BaseDevice, Device
from sim.simulator import Simulator
from sim.travel import Contact
from sim.wrist import WristDevice

__all__ = ["BaseDevice", "Contact", "Device", "Simulator", "WristDevice"]
