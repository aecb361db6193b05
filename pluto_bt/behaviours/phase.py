"""Phase: what a job tells of itself in `element[2..3]` of motion's status."""

from __future__ import annotations

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.blackboard.codes import MotionStatus, MovetoStatus, code_name

MOVETO = {code_name(code): code for code in MovetoStatus}
MOTION = {code_name(code): code for code in MotionStatus}
AS_IT_IS = "as-it-is"


class Phase(Leaf):
    """Tells motion in which phase its job is, by the names of the codes. In a tree that motion did not start nobody listens."""

    INPUT_PORTS = {
        "moveto": Port(str, False, "element[2]", AS_IT_IS, choices=(AS_IT_IS, *MOVETO)),
        "motion": Port(str, False, "element[3]", AS_IT_IS, choices=(AS_IT_IS, *MOTION)),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """SUCCESS at once."""
        robot = self.robot
        if robot is not None:
            robot.show_phase(MOVETO.get(self.get_input("moveto")), MOTION.get(self.get_input("motion")))
        return self.succeed()
