"""What the leaves of the complex jobs share: the local map, the ray that is followed, the rectangle, and the frames between which they pass.

The map lives in the frame of dead reckoning, which never jumps; goals and the rectangle are given in `Localization/Pose`. One object per
robot, made when it is first asked for; it is fed only while somebody asks.
"""

from __future__ import annotations

import math

import msgspec

from pluto_bt.behaviours.robot import Robot, pose_of
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState, LaserScan, Pair, Pose
from pluto_bt.maps.platform import Platform
from pluto_bt.skills import walked_ground
from pluto_bt.skills.circling import SeenObject
from pluto_bt.skills.headway import Headway
from pluto_bt.skills.local_grid import CELLS
from pluto_bt.skills.local_map import CELLS_OF_A_PATH, LEVEL_RAD, LocalMap
from pluto_bt.skills.motion_parameters import MotionParameters
from pluto_bt.skills.outline import Planar, outline_of
from pluto_bt.skills.passers_by import PassersBy
from pluto_bt.skills.rays import Openings
from pluto_bt.skills.rectangle import Rectangle
from pluto_bt.skills.sight import ScanView
from pluto_bt.skills.walked_ground import WalkedGround
from pluto_bt.skills.ways import Way, Ways

RARELY_S = 1.0  # so often the coarse map takes a level scan while nobody asks it
REFRESH_S = 0.35  # clearances are worked out anew so often: after every second scan
FINE_ROOM_M, FINE_LOOK_M, FINE_JOIN_M = 2.0, 8.0, 0.3  # of the fine map: farthest clearance, farthest range, gap in one wall
FEET_S, AGAIN_S = 6.0, 0.4  # where somebody walked so lately a low thing has to be seen twice: who walks has gone on by then
SHUT_AHEAD_M, SHUT_M = 0.3, 0.5  # so far before its front, and so much around there, is shut where the robot could not go on
MOST_DOUBT_M = 0.6  # with more doubt the ground along the edges would be given up
MOST_TRIES = 4  # so often in a job what was shut is tried again
MOST_BLOCKED = 6  # rays in a row that were blocked by something that no map shows


class Surroundings:
    """The memory of one robot. `robot` and `believed` are its pose in dead reckoning and in `Localization/Pose`."""

    def __init__(self, platform: Platform, parameters: MotionParameters, fine_cell_m: float) -> None:
        """`fine_cell_m`: side of a cell of the fine map."""
        self.parameters = parameters
        fine = {"path_half_width_m": CELLS_OF_A_PATH * fine_cell_m, "wide_half_width_m": FINE_ROOM_M, "look_m": FINE_LOOK_M, "join_m": FINE_JOIN_M}
        self.fine = LocalMap(msgspec.structs.replace(parameters, **fine))  # the same on smaller cells, for who passes through doors
        self.map = LocalMap(parameters, fine=self.fine)
        self.ways = Ways(self.map, outline_of(platform.body.outline_m))
        self._grids = (self.fine, self.map)  # in the order of their refreshing
        self.openings = Openings(self.map)
        self.rectangle: Rectangle | None = None  # in Localization/Pose
        self._laser = platform.devices.laser
        self._front_m = outline_of(platform.body.outline_m).front_m
        self._has_run_into = False
        self._is_empty = True
        self._coarse_s = -math.inf  # stamp of the last level scan in the coarse map
        self.robot: Planar = (0.0, 0.0, 0.0)
        self.believed: Planar = (0.0, 0.0, 0.0)
        self._passers_by, self._walked = PassersBy(), WalkedGround(self.map.look_m)
        self._first_variance_m2 = math.inf  # of the believed position when the rectangle was set
        self._doubt_m = 0.0
        self.begin(None)

    def begin(self, rectangle: Rectangle | None, goes_on: bool = False) -> None:
        """A job begins; what was seen stays known, what was explored only if the job goes on."""
        if rectangle != self.rectangle:
            self._first_variance_m2, self._doubt_m = math.inf, 0.0
        self.rectangle = rectangle
        self.blocked = 0
        self._reopened = 0
        self.headway = Headway()
        self.way: Way | None = None
        self.views: tuple[ScanView, ...] = ()  # the scans of the last look
        self.object: SeenObject | None = None
        if not goes_on:
            self.map.uncover()
            self.openings = Openings(self.map)

    def tune(self, parameters: MotionParameters) -> None:
        """These parameters count from now on; the grids keep their cells and their reach."""
        self.parameters = self.map.parameters = parameters

    def warm(self) -> None:
        """Use every kernel once, so that no later use waits for its compilation. For a memory that is then thrown away."""
        self.map.warm()
        walked_ground.warm()
        self.ways.to_goal((0.0, 0.0, 0.0), (1.0, 0.0), None)

    def forget(self) -> None:
        """What was seen is not known any more; what was explored is."""
        for grid in self._grids:
            grid.erase(self.robot[:2], 4.0 * CELLS * grid.cell_m, inside=True)
        self._walked.forget()

    def forget_square(self, middle: Pair, side_m: float, *, inside: bool) -> None:
        """What was seen in a square round a point (dead reckoning), or outside of it, is not known any more."""
        for grid in self._grids:
            grid.erase(middle, side_m, inside=inside)

    @property
    def is_empty(self) -> bool:
        """True as long as nobody has looked: then no pose is known either."""
        return self._is_empty

    def look(self, robot: Robot, now_s: float, only_finely: bool = False) -> bool:
        """Take what the robot has seen since the last look. False if it is not known where it is.

        Args:
            only_finely: True if nobody asks the coarse map: it is kept for the jobs that may follow, but not as often.
        """
        self._watch_passers_by(robot, now_s)
        dead, believed = robot.newest("Localization/Dead-Reckoning"), robot.newest("Localization/Pose")
        if pose_of(robot) is None or not isinstance(dead, Pose) or not isinstance(believed, Pose):
            self._has_run_into = False  # by the time a pose is back nobody knows where that was
            return False
        self.robot = (dead.pose[0], dead.pose[1], dead.pose[3])
        self.believed = (believed.pose[0], believed.pose[1], believed.pose[3])
        variance_m2 = max(believed.covariance[0], believed.covariance[4])
        self._first_variance_m2 = min(self._first_variance_m2, variance_m2)
        self._doubt_m = min(MOST_DOUBT_M, 2.0 * math.sqrt(variance_m2 - self._first_variance_m2))
        if self._is_empty:
            for grid in self._grids:
                grid.lay(self.robot)
            self._is_empty = False
        self.map.visit(*self.robot[:2])
        self.views = tuple(robot.scan_views())
        if self._has_run_into and not self.await_passers_by(now_s) and not self.sees_walkers(now_s):
            self.shut_ahead(now_s)
        self._has_run_into = False
        for view in self.views:
            if view.laser is not None and self._laser is not None:
                has_feet = abs(view.tilt_rad) >= LEVEL_RAD and len(self._walked.places(view.scan.stamp_s, FEET_S)) > 0
                for grid in self._grids_for(view, only_finely):
                    grid.add(view.scan, view.laser, self._laser.z_m, view.tilt_rad, AGAIN_S if has_feet else 0.0)
                self._note_walkers(view.scan, view.laser, view.tilt_rad)
        for grid in self._grids:
            if now_s - grid.refreshed_s >= REFRESH_S and not (only_finely and grid is self.map):
                grid.refresh(now_s)
        return True

    def _grids_for(self, view: ScanView, only_finely: bool) -> tuple[LocalMap, ...]:
        """Those that a scan is entered into. One that looks down finds what no later one may find again: it goes into all."""
        is_level = abs(view.tilt_rad) < LEVEL_RAD
        if only_finely and is_level and 0.0 <= view.scan.stamp_s - self._coarse_s < RARELY_S:
            return (self.fine,)
        self._coarse_s = view.scan.stamp_s if is_level else self._coarse_s
        return self._grids

    def _note_walkers(self, scan: LaserScan, laser: Planar, tilt_rad: float) -> None:
        """Who walks is found by level scans; what the others find of him are his feet."""
        if abs(tilt_rad) < LEVEL_RAD:
            self._walked.take(scan, laser)
        elif len(feet := self._walked.places(scan.stamp_s, FEET_S)):
            for grid in self._grids:
                grid.forget_feet(feet)

    def _watch_passers_by(self, robot: Robot, now_s: float) -> None:
        held, raw, bumper = robot.newest("filter/status"), robot.newest("ATRV2/Drive/Raw"), robot.newest("ATRV2/Bumper")
        self._has_run_into |= self._passers_by.note(
            now_s, held if isinstance(held, FVectorState) else None, raw if isinstance(raw, ActuatorState) else None,
            bumper if isinstance(bumper, BumperState) else None,
        )  # fmt: skip

    def shut_ahead(self, now_s: float, towards: Pair | None = None) -> None:
        """Something that no scan shows is in the way of the robot, close before its front; or beside it, on its way to a point (dead reckoning)."""
        (x, y, theta), away_m = self.robot, self._front_m + SHUT_AHEAD_M
        heading_rad = theta if towards is None else math.atan2(towards[1] - y, towards[0] - x)
        self.map.shut(x + away_m * math.cos(heading_rad), y + away_m * math.sin(heading_rad), SHUT_M, now_s)

    def await_passers_by(self, now_s: float) -> bool:
        """True while somebody is about who will walk on: what is blocked is blocked for a while."""
        return self._passers_by.are_awaited(now_s)

    def sees_walkers(self, now_s: float) -> bool:
        """True if the laser saw somebody walk, however far, and has not looked there in vain since for long."""
        return len(self._walked.places(now_s)) > 0

    def find_behind_walkers(self, goal: Pair, now_s: float) -> Way | None:
        """The way to a goal (`Localization/Pose`) that there would be but for what stands where somebody walked lately."""
        places = self._walked.places(now_s)
        if not len(places):
            return None
        ground = self.map.without_walkers(places, now_s)
        return self.ways.to_goal(self.robot, self.to_dead_reckoning(goal), self.rectangle_here, ground)

    @property
    def rectangle_here(self) -> Rectangle | None:
        """The rectangle in the frame of dead reckoning. Its doubt is two standard deviations of what the position has lost since it was set."""
        if self.rectangle is None:
            return None
        x, y = self.to_dead_reckoning(self.rectangle.home[:2])
        return self.rectangle._replace(home=(x, y, self.rectangle.home[2] - self.believed[2] + self.robot[2]), doubt_m=self._doubt_m)

    def to_dead_reckoning(self, point: Pair) -> Pair:
        """A point of `Localization/Pose` in the frame of dead reckoning."""
        return _moved(point, self.believed, self.robot)

    def to_map(self, point: Pair) -> Pair:
        """A point of dead reckoning in the frame of `Localization/Pose`."""
        return _moved(point, self.robot, self.believed)

    def heading_in_map(self, heading_rad: float) -> float:
        """A heading of dead reckoning in the frame of `Localization/Pose`."""
        return heading_rad - self.robot[2] + self.believed[2]

    def find(self, goal: Pair | None) -> Way | None:
        """The best way to a goal (`Localization/Pose`), or with None to the nearest new ground; where doubt of the position leaves none, one
        that is as near to the edge of the rectangle as if there were no doubt."""
        rectangle = self.rectangle_here
        way = self._find(goal, rectangle)
        if way is None and rectangle is not None and rectangle.doubt_m > 0.0:
            way = self._find(goal, rectangle._replace(doubt_m=0.0))
        return way

    def find_once_more(self, goal: Pair | None) -> Way | None:
        """The same where there was none, and where the robot could not go on is open again: from elsewhere, or another time, it may come through.
        New ground is worth one such try in a job, a goal some."""
        if self._reopened >= (MOST_TRIES if goal is not None else 1) or not self.map.reopen(self.map.refreshed_s):
            return None
        self._reopened += 1
        self.map.refresh(self.map.refreshed_s)
        return self.find(goal)

    def why_no_way(self, goal: Pair) -> str:
        """Why there is no way to a goal (`Localization/Pose`): what is too narrow, and how much the robot takes."""
        here, rectangle = self.to_dead_reckoning(goal), self.rectangle_here
        if rectangle is not None and self.ways.to_goal(self.robot, here, None) is not None:
            return "every way leads out of the rectangle"
        gap = self.ways.widest_gap(self.robot, here, None)
        if gap is None:
            return "every way is blocked: as far as was seen no gap leads on towards the goal"
        x_m, y_m = self.to_map((gap.x_m, gap.y_m))
        wide = f"the widest gap on the way, at {x_m:.1f};{y_m:.1f}, is about {gap.width_m:.1f} m wide"
        return f"every way is blocked: {wide}, and the robot takes one of {2.0 * self.ways.least_m:.2f} m"

    def _find(self, goal: Pair | None, rectangle: Rectangle | None) -> Way | None:
        if goal is None:
            return self.ways.to_new_ground(self.robot, rectangle)
        return self.ways.to_goal(self.robot, self.to_dead_reckoning(goal), rectangle)


def _moved(point: Pair, before: Planar, after: Planar) -> Pair:
    """A point given beside `before` as it lies beside `after`; both are the same robot in two frames."""
    dx, dy = point[0] - before[0], point[1] - before[1]
    c, s = math.cos(after[2] - before[2]), math.sin(after[2] - before[2])
    return after[0] + c * dx - s * dy, after[1] + s * dx + c * dy
