"""A leaf of one's own, for t19_write_a_leaf.xml: where does the laser see farthest?"""

import math

import numpy as np
from py_trees.common import Status

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.ports import Port


class FarthestView(Leaf):
    """Finds the direction in which the way is free the farthest, and a place there. Fails with `no-pose` without scan or pose for long."""

    INPUT_PORTS = {
        "margin_m": Port(float, False, "how far to stay away from what stands there", 1.5, unit="m", ge=0.0),
        "half_width_deg": Port(float, False, "so far to either side it must be free as well", 12.0, unit="deg", ge=0.0, le=45.0),
        "patience_s": Port(float, False, "how long to wait for a scan", 2.0, unit="s", ge=0.0),
    }
    OUTPUT_PORTS = {
        "place": Port(tuple[float, float], description="where to go, x;y of the map", unit="m"),
        "reason": Port(str, False, "why it failed"),
    }

    def initialise(self) -> None:
        self.began_s = self.now_s()

    def update(self) -> Status:
        if self.robot is None or self.robot.is_stale("sick/scan") or self.robot.is_stale("Localization/Laser_Pose"):
            text = "no scan, or nobody knows where it was taken"
            return self.wait(text) if self.now_s() - self.began_s < self.get_input("patience_s") else self.fail("no-pose", text)
        scan, laser = self.robot.newest("sick/scan"), self.robot.newest("Localization/Laser_Pose")
        free_m, angle_rad = self.farthest(scan)
        far_m = max(free_m - self.get_input("margin_m"), 0.0)
        heading_rad = laser.pose[3] + angle_rad
        self._set_output("place", (laser.pose[0] + far_m * math.cos(heading_rad), laser.pose[1] + far_m * math.sin(heading_rad)))
        return self.succeed(f"{free_m:.1f} m free at {math.degrees(angle_rad):.0f}°")

    def farthest(self, scan) -> tuple[float, float]:
        """(metres, radians from straight ahead): the best beam, where a beam is as long as the shortest of its neighbours."""
        beams = round(math.radians(self.get_input("half_width_deg")) / scan.angle_step_rad)
        ranges_m = np.pad(np.nan_to_num(scan.ranges_m, nan=0.0), beams, constant_values=0.0)
        shortest_m = np.lib.stride_tricks.sliding_window_view(ranges_m, 2 * beams + 1).min(axis=1)
        best = int(np.argmax(shortest_m))
        return float(shortest_m[best]), scan.angle_min_rad + best * scan.angle_step_rad
