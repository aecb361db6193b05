"""Nodes that our robots cannot run yet: known by name, so that a tree with one is refused with the reason and the place.

There is no class behind them: nothing that could be run.
"""

from __future__ import annotations

from typing import Final

# name → (what our robots have not, inputs, outputs)
OWN_MISSING: Final[dict[str, tuple[str, str, str]]] = {
    "FindWall": ("module pose", "side distance_m timeout_s", "pose reason"),
    "Record": ("recording that a mission begins; `pluto run --record FILE.mcap` records", "file", "reason"),
    "SaveMap": ("module slam", "file", "reason"),
}
NAV2_MISSING: Final[dict[str, tuple[str, str, str]]] = {
    "AssistedTeleop": ("teleoperation", "is_recovery time_allowance server_name server_timeout", "error_code_id error_msg"),
    "CancelAssistedTeleop": ("teleoperation", "server_name server_timeout", ""),
    "CancelWait": ("cancelling a Wait from beside it", "server_name server_timeout", ""),
    "ComputeRoute": (
        "routes on a graph",
        "start goal start_id goal_id use_start use_poses server_name server_timeout",
        "route path planning_time error_code_id error_msg",
    ),
    "ComputeAndTrackRoute": (
        "routes on a graph",
        "start goal start_id goal_id use_start use_poses server_name server_timeout",
        "execution_duration execution_time last_node_id next_node_id current_edge_id route path rerouted error_code_id error_msg",
    ),
    "CancelComputeAndTrackRoute": ("routes on a graph", "server_name server_timeout", ""),
    "ExtractRouteNodesAsGoals": ("routes on a graph", "route", "goals"),
    "FollowObject": (
        "following a pose of another program; Follow follows what the laser sees",
        "pose_topic max_duration tracked_frame server_name server_timeout",
        "total_elapsed_time error_code_id error_msg",
    ),
    "CancelFollowObject": ("following a pose of another program", "server_name server_timeout", ""),
    "DockRobot": (
        "docking",
        "use_dock_id dock_id dock_pose dock_type max_staging_time navigate_to_staging_pose server_name server_timeout",
        "success num_retries error_code_id error_msg",
    ),
    "UndockRobot": ("docking", "dock_type max_undocking_time server_name server_timeout", "success error_code_id error_msg"),
    "ReinitializeGlobalLocalization": ("a localisation that can be spread anew", "service_name server_timeout", ""),
    "ToggleCollisionMonitor": ("a collision monitor that can be switched off; the stop filter never is", "enable service_name server_timeout", ""),
    "IsBatteryCharging": ("a charger that tells", "battery_topic", ""),
}
MISSING: Final = NAV2_MISSING | OWN_MISSING
MISSING_CONDITIONS: Final = ("IsBatteryCharging",)
