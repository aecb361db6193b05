"""SingleTrigger and PathLongerOnApproach: a child that is worked only on one occasion."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from pluto_bt.behaviours.map_path import MapPath
from pluto_bt.trees.engine.node import DecoratorNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel, PortProblem
from pluto_bt.trees.python_types import kind_of_type
from pluto_bt.trees.scopes import EMPTY, MissingValue, Scope
from pluto_bt.trees.values import BOOL, DOUBLE

NO_PATH = MapPath.empty()
SAME_M = 1e-3  # goals so near to each other are one


class SingleTrigger(DecoratorNode):
    """The child until it has completed once, then FAILURE, until a parent resets this node; `is_global`: until the entry `run_id` changes."""

    PORTS: ClassVar = {"is_global": PortModel("is_global", kind=BOOL, default="false", description="a parent's reset does not arm it again")}

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.scope: Scope | None = None  # set by the loader
        self.is_armed = True
        self.run: Any = None

    def step(self) -> Result:
        if self.status is IDLE and not self.read("is_global"):
            self.is_armed = True
        elif self.read("is_global") and (run := self._run()) != self.run:
            self.is_armed, self.run = True, run
        start(self)
        if not self.is_armed:
            self.status = FAILURE
            return FAILURE
        result = self.pass_on()
        if result is not SKIPPED and result is not RUNNING:
            self.is_armed = False
        return result

    def _run(self) -> Any:
        entry = self.scope.find("run_id") if self.scope is not None else None
        return None if entry is None or entry.value is EMPTY else entry.value


class PathLongerOnApproach(DecoratorNode):
    """The child when the robot is near its goal and a new path to the same goal is suddenly much longer; else SUCCESS without it."""

    PORTS: ClassVar = {
        "path": PortModel("path", kind=kind_of_type(MapPath), required=False, description="the path that is followed"),
        "prox_len": PortModel("prox_len", kind=DOUBLE, default="3.0", description="in m: near is a path shorter than this"),
        "length_factor": PortModel("length_factor", kind=DOUBLE, default="2.0", description="much longer is so many times"),
    }

    def __init__(self, name: str = "", child: Any = None) -> None:
        super().__init__(name, child)
        self.before = NO_PATH

    def step(self) -> Result:
        path = self._path()
        start(self)
        if not self._is_longer(path):
            self.before = path
            reset(self.child)  # the long way is no longer proposed: what was begun about it is given up
            self.status = SUCCESS
            return SUCCESS
        result = self.pass_on()
        if result is not SKIPPED and result is not RUNNING:
            self.before = path
        return result

    def _path(self) -> MapPath:
        reader = self.readers.get("path")
        try:
            path: MapPath = NO_PATH if reader is None else reader()
        except MissingValue:
            return NO_PATH
        except PortProblem as problem:
            self.fail(str(problem))
        return path

    def _is_longer(self, path: MapPath) -> bool:
        before = self.before
        if len(path) == 0 or len(before) == 0 or len(path) == len(before) or math.dist(path.end, before.end) > SAME_M:
            return False
        near_m, factor = float(self.read("prox_len")), float(self.read("length_factor"))
        return before.length_m < near_m and path.length_m > factor * before.length_m
