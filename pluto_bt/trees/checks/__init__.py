"""What only the whole mission tells: checks of the unfolded tree that BehaviorTree.CPP would find while ticking, or never."""

from pluto_bt.trees.checks.check import Examined, check_mission, examine_mission, load_checked

__all__ = ["Examined", "check_mission", "examine_mission", "load_checked"]
