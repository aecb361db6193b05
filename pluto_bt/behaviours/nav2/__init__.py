"""Nav2's action and condition nodes (nav2_tree_nodes.xml, August 2026) on our robots, so that navigation trees made for Nav2 run here."""

from typing import Final

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.nav2 import conditions, costmaps, driving, error_conditions, goal_conditions, goals, paths, planning, selectors

NAV2_LEAVES: Final[tuple[type[Leaf], ...]] = (
    planning.ComputePathToPose, planning.ComputePathThroughPoses, planning.SmoothPath, driving.NavigateToPose, driving.NavigateThroughPoses,
    driving.Spin, driving.BackUp, driving.DriveOnHeading, driving.Wait, driving.CancelControl, driving.CancelSpin, driving.CancelBackUp,
    driving.CancelDriveOnHeading, costmaps.ClearEntireCostmap, costmaps.ClearCostmapExceptRegion, costmaps.ClearCostmapAroundRobot,
    costmaps.ClearCostmapAroundPose, selectors.PlannerSelector, selectors.ControllerSelector, selectors.SmootherSelector,
    selectors.GoalCheckerSelector, selectors.ProgressCheckerSelector, selectors.PathHandlerSelector, paths.TruncatePath, paths.TruncatePathLocal,
    paths.ConcatenatePaths, paths.GetPoseFromPath, paths.ValidatePath, paths.IsPathValid, goals.RemovePassedGoals, goals.RemoveInCollisionGoals,
    goals.AppendGoalPoseToGoals, goals.GetNextFewGoals, goals.GetCurrentPose, goals.CheckPoseOccupancy, goals.CheckStopStatus,
    goal_conditions.GoalUpdated, goal_conditions.GlobalUpdatedGoal, goal_conditions.GoalReached, conditions.TimeExpired,
    conditions.DistanceTraveled, conditions.PathExpiringTimer, conditions.IsBatteryLow, conditions.InitialPoseReceived,
    conditions.TransformAvailable, goal_conditions.ArePosesNear, goal_conditions.IsGoalNearby, conditions.IsWithinPathTrackingBounds,
    error_conditions.AreErrorCodesPresent, error_conditions.WouldAControllerRecoveryHelp, error_conditions.WouldAPlannerRecoveryHelp,
    error_conditions.WouldASmootherRecoveryHelp, error_conditions.WouldARouteRecoveryHelp,
)  # fmt: skip
