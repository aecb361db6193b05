"""Nav2's action and condition nodes (nav2_tree_nodes.xml, August 2026) on our robots, so that navigation trees made for Nav2 run here."""

from typing import Final

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.nav2 import conditions, costmaps, driving, goals, paths, planning, selectors

NAV2_LEAVES: Final[tuple[type[Leaf], ...]] = (
    planning.ComputePathToPose, planning.ComputePathThroughPoses, planning.SmoothPath, driving.NavigateToPose, driving.NavigateThroughPoses,
    driving.Spin, driving.BackUp, driving.DriveOnHeading, driving.Wait, driving.CancelControl, driving.CancelSpin, driving.CancelBackUp,
    driving.CancelDriveOnHeading, costmaps.ClearEntireCostmap, costmaps.ClearCostmapExceptRegion, costmaps.ClearCostmapAroundRobot,
    costmaps.ClearCostmapAroundPose, selectors.PlannerSelector, selectors.ControllerSelector, selectors.SmootherSelector,
    selectors.GoalCheckerSelector, selectors.ProgressCheckerSelector, selectors.PathHandlerSelector, paths.TruncatePath, paths.TruncatePathLocal,
    paths.ConcatenatePaths, paths.GetPoseFromPath, paths.ValidatePath, paths.IsPathValid, goals.RemovePassedGoals, goals.RemoveInCollisionGoals,
    goals.AppendGoalPoseToGoals, goals.GetNextFewGoals, goals.GetCurrentPose, goals.CheckPoseOccupancy, goals.CheckStopStatus,
    conditions.GoalUpdated, conditions.GlobalUpdatedGoal, conditions.GoalReached, conditions.TimeExpired, conditions.DistanceTraveled,
    conditions.PathExpiringTimer, conditions.IsBatteryLow, conditions.InitialPoseReceived, conditions.TransformAvailable, conditions.ArePosesNear,
    conditions.IsGoalNearby, conditions.IsWithinPathTrackingBounds, conditions.AreErrorCodesPresent, conditions.WouldAControllerRecoveryHelp,
    conditions.WouldAPlannerRecoveryHelp, conditions.WouldASmootherRecoveryHelp, conditions.WouldARouteRecoveryHelp,
)  # fmt: skip
