"""Missions: BehaviorTree.CPP v4 XML on py_trees.

    from pluto_bt.trees import load_mission, MissionError, TickError
    mission = load_mission(text_or_path, nodes=[MyLeaf], clock=clock, blackboard={"n": 3}, enums={"RED": 1})
    mission.tick_once()

`engine/` ticks, `controls/`, `decorators/` and `leaves/` are the nodes, `script/` the language of conditions, `loader/` reads files,
`checks/` looks at the whole, `dump/` draws.
"""

from pluto_bt.trees.checks import check_mission
from pluto_bt.trees.errors import MissionError, TickError
from pluto_bt.trees.loader.load import load_mission, plan_mission
from pluto_bt.trees.mission import Mission

__all__ = ["Mission", "MissionError", "TickError", "check_mission", "load_mission", "plan_mission"]
