"""Localisation and the two modules that improve it (manual, sections 3 and 7)."""

from __future__ import annotations

import math

from pluto_bt.blackboard.codes import Setter
from pluto_bt.blackboard.messages import FVectorState, LaserPose, Pose
from pluto_bt.gateway.client import Client
from pluto_bt.gateway.errors import WrongStateError
from pluto_bt.gateway.proxies.proxy import Proxy
from pluto_bt.gateway.words import RunResult

INTERFACES: tuple[tuple[str, type[Pose | LaserPose]], ...] = (
    ("Localization/Dead-Reckoning", Pose),
    ("Localization/Laser_Dead-Reckoning", LaserPose),
    ("Localization/Post_Pose", Pose),
    ("Localization/Pose", Pose),
    ("Localization/Laser_Pose", LaserPose),
)
ALL = 2 ** len(INTERFACES) - 1


class LocProxy(Proxy):
    """The five pose interfaces: 0 dead reckoning, 1 that of the laser, 2 the posted pose, 3 and 4 = 0 and 1 adjusted by 2."""

    MODULE = "local"

    def __init__(self, client: Client | None = None, *, interfaces: int = ALL) -> None:
        """`interfaces`: the sum of 2^n of those that will be used; 9 = 0 and 3. Raises: ValueError, GatewayError."""
        if not 0 < interfaces <= ALL:
            raise ValueError(f"expected the sum of 2^n of the interfaces 0 to {len(INTERFACES) - 1} (1 to {ALL}), found {interfaces}")
        self.interfaces = interfaces
        super().__init__(client)

    def get_pose(self, interface: int = 3) -> Pose | LaserPose:
        """The newest pose: x, y, z, theta, phi, psi, for the laser also pan and tilt. Raises: ValueError for an interface that was not named."""
        named = [n for n in range(len(INTERFACES)) if self.interfaces >> n & 1]
        if interface not in named:
            raise ValueError(f"expected one of the interfaces {named} that were named by interfaces={self.interfaces}, found {interface}")
        return self._newest(*INTERFACES[interface])

    def get_setter(self, interface: int = 3) -> Setter:
        """Who adjusts the pose."""
        return Setter(self.get_pose(interface).setter)

    def set_pose(self, x_m: float, y_m: float, theta_rad: float) -> None:
        """Tell the robot where it stands on the map. Raises: WrongStateError while another module keeps the pose."""
        result = self.client.run("SetPose", pose=f"{x_m!r};{y_m!r};{math.degrees(theta_rad)!r}")
        if not result.is_success:
            raise WrongStateError("wrong-state", ": ".join(word for word in (result.reason, result.text) if word))


class PoseProxy(Proxy):
    """The pose module: the map and the laser improve the pose. Its thread runs from the start."""

    MODULE = "pose"

    def status(self) -> FVectorState:
        """element[0] = 1 while it runs; element[1] and `data` speak of the wall."""
        return self._newest("pose/status", FVectorState)

    def set_pose(self, x_m: float, y_m: float, theta_rad: float) -> None:
        """As the manual has it: stop the thread, set the pose in localisation, start the thread again."""
        self.stop_activity()
        try:
            LocProxy(self.client).set_pose(x_m, y_m, theta_rad)
        finally:
            self.start_activity()

    def find_wall(self) -> RunResult:
        """Find the longest wall ahead; its parameters are the outputs."""
        return self.client.run("FindWall")


class SlamProxy(Proxy):
    """The slam module: makes a map while it improves the pose. Never let it and the pose module run at the same time."""

    MODULE = "slam"

    def status(self) -> FVectorState:
        """element[0] = 1 while it runs, element[1] = -1 while it saves the map."""
        return self._newest("slam/status", FVectorState)

    def save_map(self, file: str) -> RunResult:
        """Save the map; back when that is done."""
        return self.client.run("SaveMap", file=file)
