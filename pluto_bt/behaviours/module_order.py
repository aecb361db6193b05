"""StartModule and StopModule: what `pluto module` does, from a mission."""

from __future__ import annotations

from typing import ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import RobotLeaf
from pluto_bt.behaviours.motion_leaf import MOTION_OUTPUTS
from pluto_bt.behaviours.ports import Port
from pluto_bt.behaviours.robot import Robot
from pluto_bt.blackboard.messages import ModulesState
from pluto_bt.source import did_you_mean

TICKING: Final = "executive"  # it runs the mission that would stop it


class ModuleOrder(RobotLeaf, register=False):  # its two children are the nodes
    """What both have in common."""

    RUNS: ClassVar[bool]
    STATES: ClassVar[tuple[str, ...]]  # in one of these the order is carried out

    INPUT_PORTS = {
        "module": Port(str, True, "its name, as `pluto ps` lists it"),
        "timeout_s": Port(float, False, "fails with `timeout` after so long", 5.0, unit="s", ge=0.0),
    }
    OUTPUT_PORTS = dict(MOTION_OUTPUTS)

    def initialise(self) -> None:
        """The order is given in the first `update`."""
        self._ordered_s: float | None = None

    def act(self, robot: Robot) -> Status:
        """Order once, then wait until the table of modules says that it is so."""
        name, told = str(self.get_input("module")), robot.newest("modules")
        rows = told.modules if isinstance(told, ModulesState) else ()
        if self._ordered_s is None:
            if name == TICKING and not self.RUNS:
                return self.fail("bad-command", f"{name} runs this mission")
            if not robot.order_module(name, self.RUNS):
                return self.fail("bad-command", f'no module "{name}"; {did_you_mean(name, [row.name for row in rows]) or "`pluto ps` lists them"}')
            self._ordered_s = self.now_s()
        state = next((row.state for row in rows if row.name == name), "")
        if told is not None and told.stamp_s > self._ordered_s and state in self.STATES:
            return self.succeed(f"{name} is {state}")
        if self.now_s() - self._ordered_s >= float(self.get_input("timeout_s")):
            return self.fail("timeout", f"{name} is {state or 'not there'}")
        return self.wait(f"waiting for {name}")


class StartModule(ModuleOrder):
    """Starts a module, after all that it needs; SUCCESS once it runs."""

    RUNS, STATES = True, ("running",)


class StopModule(ModuleOrder):
    """Stops a module; SUCCESS once it stands. A link of the chain that is stopped lets nothing through, so the robot stands, too."""

    RUNS, STATES = False, ("stopped",)
