"""FollowPath: along a path that another node has planned."""

from __future__ import annotations

import math
from typing import Final

from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS
from pluto_bt.behaviours.nav2.ports import ERRORS, SERVER, ActionLeaf, ignored
from pluto_bt.behaviours.path_driver import PathDriver
from pluto_bt.behaviours.plan_path import TOLERANCE
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot

NAV2_CHOICES: Final = ("controller_id", "goal_checker_id", "progress_checker_id", "path_handler_id")


class FollowPath(ActionLeaf, PathDriver):
    """Follows `path` to its end by avoidance's goto; a new path written while it drives is taken over. Fails with `stuck` where it is blocked."""

    UNKNOWN, NUMBERS = 100, {"no-pose": 102, "no-path": 103, "stuck": 105, "bumper": 105, "laser-stale": 106, "wrist-stale": 106, "sonar-stale": 106,
                        "timeout": 107}  # fmt: skip
    INPUT_PORTS = {
        "path": Port(MapPath, True, "the way, from PlanPath"),
        "tolerance_m": TOLERANCE,
        **MOTION_INPUTS,
        **{name: ignored(name)[name] for name in NAV2_CHOICES},
        **SERVER,
    }
    OUTPUT_PORTS = {
        **MOTION_OUTPUTS,
        "tracking_feedback": Port(list[float], False, "metres to the left of the path; radians turned from it"),
        **ERRORS,
    }

    def begin(self, robot: Robot) -> Status | None:
        """Look at the path; the rest needs a pose."""
        self.tolerance_m = float(self.get_input("tolerance_m"))
        self._taken: MapPath | None = None
        return self.follow(robot)

    def follow(self, robot: Robot) -> Status:
        """Take the path, or drive on."""
        here = self.here(robot)
        if isinstance(here, Status):
            return here
        try:
            path: MapPath = self.get_input("path")
        except NoDataAvailable:
            return self.fail("no-path", "the port path has no value: PlanPath comes first")
        if not len(path):
            return self.fail("no-path", "the path is empty")
        if self._taken is None or path is not self._taken:
            is_same = self._taken is not None and path == self._taken
            self._taken = path
            if not is_same:
                self.take(robot, path, here)
        status = self.drive(robot, here)
        turned_rad = math.remainder(here[2] - self._following.heading_rad(), math.tau)
        self._set_output("tracking_feedback", [self._following.off_m(here), turned_rad])
        return status
