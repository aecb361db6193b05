"""Every leaf of the library, in the order of `pluto nodes`."""

from __future__ import annotations

from typing import Final

from pluto_bt.behaviours.arm import UnfoldArm
from pluto_bt.behaviours.back_out import BackOut
from pluto_bt.behaviours.car_goto import CarGoTo
from pluto_bt.behaviours.circle_object import CircleObject
from pluto_bt.behaviours.conditions import BatteryAbove, BumperPressed, InsideArea, IsAt, IsStuck, IsTilted, PoseQualityAbove
from pluto_bt.behaviours.escape import ReadAlarms, TryTurn
from pluto_bt.behaviours.find_object import FindObject
from pluto_bt.behaviours.follow import Follow
from pluto_bt.behaviours.follow_path import FollowPath
from pluto_bt.behaviours.goto import GoTo
from pluto_bt.behaviours.jobs import Explore, Investigate, MoveTo, Resume, SetRectangle
from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.look_around import LookAround
from pluto_bt.behaviours.make_turn import MakeTurn
from pluto_bt.behaviours.module_order import StartModule, StopModule
from pluto_bt.behaviours.nav2 import NAV2_LEAVES
from pluto_bt.behaviours.navigate_to import NavigateTo
from pluto_bt.behaviours.paths import FindPath, FollowRay
from pluto_bt.behaviours.phase import Phase
from pluto_bt.behaviours.plan_path import PlanPath
from pluto_bt.behaviours.say import Say
from pluto_bt.behaviours.set_pose import SetPose
from pluto_bt.behaviours.stop import Release, Stop
from pluto_bt.behaviours.sweep_wrist import SweepWrist
from pluto_bt.behaviours.topic_compare import TopicCompare, WaitFor
from pluto_bt.behaviours.velocity import DriveVelocity, HoldHeading
from pluto_bt.behaviours.wall_follow import WallFollow
from pluto_bt.behaviours.would_retry_help import WouldRetryHelp
from pluto_bt.behaviours.wrist import PointWrist

ACTIONS: Final[tuple[type[Leaf], ...]] = (
    GoTo, CarGoTo, MakeTurn, MoveTo, PlanPath, FollowPath, NavigateTo, Explore, SetRectangle, Investigate, Resume, DriveVelocity, HoldHeading,
    Stop, Release, WallFollow, Follow, PointWrist, LookAround, SweepWrist, UnfoldArm, FindPath, FollowRay, FindObject, CircleObject, BackOut, Phase,
    TryTurn, ReadAlarms, SetPose, StartModule, StopModule, WaitFor, Say,
)  # fmt: skip
CONDITIONS: Final[tuple[type[Leaf], ...]] = (
    IsAt, IsStuck, IsTilted, BumperPressed, BatteryAbove, PoseQualityAbove, InsideArea, TopicCompare, WouldRetryHelp,
)  # fmt: skip
LEAVES: Final = (*ACTIONS, *CONDITIONS, *NAV2_LEAVES)
