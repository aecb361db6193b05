"""Say: a line for operators."""

from __future__ import annotations

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS, Leaf
from pluto_bt.behaviours.ports import Port


class Say(Leaf):
    """Shows `text` in shell, console and log. Without a robot the text is only the node's feedback."""

    INPUT_PORTS = {"text": Port(str, True, "what to say")}
    OUTPUT_PORTS = NO_PORTS
    SIDE_EFFECT = True  # after a crash nothing is said twice

    def update(self) -> Status:
        """SUCCESS at once."""
        text = str(self.get_input("text"))
        robot = self.robot
        if robot is not None:
            robot.say(text)
        return self.succeed(text)
