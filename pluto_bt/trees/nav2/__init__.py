"""Nav2's own control nodes and decorators, with the semantics of the plugins in nav2_behavior_tree (August 2026)."""

from pluto_bt.trees.nav2.goals import GoalUpdatedController, GoalUpdater
from pluto_bt.trees.nav2.paced import DistanceController, RateController, SpeedController
from pluto_bt.trees.nav2.pause import PauseResumeController
from pluto_bt.trees.nav2.pipeline import NonblockingSequence, PersistentSequence, PipelineSequence
from pluto_bt.trees.nav2.recovery import RecoveryNode, RoundRobin
from pluto_bt.trees.nav2.triggers import PathLongerOnApproach, SingleTrigger

NAV2_NODES = {
    kind.__name__: kind
    for kind in (
        PipelineSequence,
        RecoveryNode,
        RoundRobin,
        NonblockingSequence,
        PersistentSequence,
        PauseResumeController,
        RateController,
        DistanceController,
        SpeedController,
        GoalUpdatedController,
        GoalUpdater,
        PathLongerOnApproach,
        SingleTrigger,
    )
}

__all__ = ["NAV2_NODES", *sorted(NAV2_NODES)]
