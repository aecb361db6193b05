"""The parameters of a run: looked at, changed while it runs, taken back, saved."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.replies import Param, ParamsState
from pluto_bt.gateway.requests import Params
from pluto_bt.gateway.subscriptions import matches
from pluto_bt.modules.live_parameters import NAMES, broken_rules, value_of
from pluto_bt.modules.robot_file import RobotFile, overlay_names
from pluto_bt.runtime.parameters import Parameter, build, describe, override, shown
from pluto_bt.source import Fault, Faults, Place

STRANGE_TOLD = 20
CODES = {"unknown-parameter": "unknown-param", "bad-setting": "invalid"}
_OUT_OF_RANGE = re.compile(r"expected [a-z]+ (of length )?[<>]=? ", re.IGNORECASE)  # msgspec: of the right type, but beyond its range


class Tuning:
    """All parameters of one robot. A change counts at the next step of each module; one that is not confirmed in time goes back.

    Args:
        robot: the parameters that the run began with.
        apply: gives changed parameters to all who use them.
        path: the file that `save` writes, None = there is none; what it held at the start stays in it.
    """

    def __init__(self, robot: RobotFile, apply: Callable[[RobotFile], None], path: Path | None = None) -> None:
        self._robot = self._first = robot
        self._apply, self._path = apply, path
        self._kept = overlay_names(path) if path is not None else frozenset()
        self._rows: tuple[Parameter, ...] = describe(RobotFile)
        self._before: RobotFile | None = None  # what a rollback brings back
        self._until_s = math.inf  # then it goes back by itself
        self.rev = 1

    def answer(self, request: Params, now_s: float) -> tuple[ParamsState, dict[str, str]]:
        """Do what is asked; the reply, and what was changed. Raises: RefusedError with all that is wrong; then nothing was changed."""
        self.step(now_s)
        if request.op == "get":
            return self._state(request.name, now_s), {}
        if request.rev is not None and request.rev != self.rev:
            raise RefusedError("conflict", f'expected rev="{self.rev}", found "{request.rev}": the parameters were changed meanwhile; get them again')
        if request.op == "set":
            return self._set(request.values, request.confirm_s, now_s)
        if request.op == "save":
            self._save()
            return self._state("", now_s), {}
        if self._before is None:
            raise RefusedError("wrong-state", "there is no change to take back")
        changed = self._become(self._before)
        self._before, self._until_s = None, math.inf
        return self._told(changed, now_s), changed

    def step(self, now_s: float) -> dict[str, str]:
        """Take back what was not confirmed in time; what changed by that."""
        if now_s < self._until_s or self._before is None:
            return {}
        changed = self._become(self._before)
        self._before, self._until_s = None, math.inf
        return changed

    def _set(self, values: Mapping[str, str], confirm_s: float, now_s: float) -> tuple[ParamsState, dict[str, str]]:
        """All or nothing. Without values and `confirm_s` it confirms the change that waits."""
        if not values and not math.isfinite(self._until_s):
            raise RefusedError("invalid", '<params op="set">: expected <p name="…">VALUE</p>; an empty one confirms a change, and none waits for it')
        robot = self._checked(values)
        if not math.isfinite(self._until_s):
            self._before = self._robot  # else the one from before the change that waits stays
        changed = self._become(robot)
        self._until_s = now_s + confirm_s if confirm_s > 0.0 else math.inf
        return self._told(changed, now_s), changed

    def _become(self, robot: RobotFile) -> dict[str, str]:
        changed = {row.name: shown(value_of(robot, row.name)) for row in self._rows if value_of(robot, row.name) != value_of(self._robot, row.name)}
        if changed:
            self._robot = robot
            self.rev += 1
            self._apply(robot)
        return changed

    def _checked(self, values: Mapping[str, str]) -> RobotFile:
        """The robot with these values. Raises: RefusedError with everything that is wrong."""
        faults, refusals = Faults(), []
        table: dict[str, Any] = msgspec.to_builtins(self._robot)
        known = {row.name for row in self._rows}
        strange = [name for name in values if name not in known]
        untold = frozenset(strange[STRANGE_TOLD:])  # to look for what each of thousands may mean would take seconds
        values = {name: text for name, text in values.items() if name not in untold}
        for name in sorted(known & values.keys() - NAMES):
            refusals.append(RefusedError("read-only", f'"{name}" cannot be changed while the robot runs; start it with --set {name}=VALUE'))
        override(table, [f"{name}={text.strip()}" for name, text in values.items() if name in NAMES or name not in known], RobotFile, faults)
        robot = build(RobotFile, table, lambda path: Place(".".join(path)), faults)
        refusals += [_refusal(fault) for fault in faults.in_order()]
        if untold:
            refusals.append(RefusedError("unknown-param", f"{len(untold)} more parameters are unknown"))
        if robot is not None:
            for rule in broken_rules(robot, frozenset(values)):
                found = f"{shown(value_of(robot, rule.low))} > {shown(value_of(robot, rule.high))}"
                refusals.append(RefusedError("bad-value", f"expected {rule.low} <= {rule.high} ({rule.why}), found {found}"))
        if refusals:
            first, *more = refusals
            raise RefusedError(first.code, first.text, more=more)
        assert robot is not None
        return robot

    def _save(self) -> None:
        """Write what differs from the start of the run to the file that the next run reads; what waits to be confirmed is confirmed by it."""
        if self._path is None:
            raise RefusedError("wrong-state", "there is no file to save to; start the run with --params FILE.toml")
        lines = ['# Laid over the parameters of the platform file by --params; written by <params op="save"/>.']
        lines += [f"{name} = {shown(value_of(self._robot, name))}" for name in sorted(self._kept | self._changed())]
        try:
            fresh = self._path.with_name(self._path.name + ".new")
            fresh.write_text("\n".join(lines) + "\n", encoding="utf-8")
            fresh.replace(self._path)
        except OSError as error:
            raise RefusedError("internal", f"cannot write {self._path}: {error.strerror or error}") from None
        self._until_s = math.inf

    def _changed(self) -> set[str]:
        return {name for name in NAMES if value_of(self._robot, name) != value_of(self._first, name)}

    def _told(self, changed: Mapping[str, str], now_s: float) -> ParamsState:
        rows = tuple(self._row(row) for row in self._rows if row.name in changed)
        return ParamsState(rev=self.rev, confirm_s=self._left_s(now_s), rows=rows)

    def _state(self, pattern: str, now_s: float) -> ParamsState:
        rows = tuple(self._row(row) for row in self._rows if matches(pattern, row.name))
        if pattern and not rows:
            raise RefusedError("unknown-param", f'unknown parameter "{pattern}"; <params/> shows all')
        return ParamsState(rev=self.rev, confirm_s=self._left_s(now_s), rows=rows)

    def _left_s(self, now_s: float) -> float:
        return max(0.0, self._until_s - now_s) if math.isfinite(self._until_s) else 0.0

    def _row(self, row: Parameter) -> Param:
        return Param(row.name, shown(value_of(self._robot, row.name)), row.kind, row.unit, row.range, row.default, row.name in NAMES)


def _refusal(fault: Fault) -> RefusedError:
    """A fault of a value as an error of the protocol."""
    words = (fault.message, fault.expected and f"expected {fault.expected}", fault.found and f"found {fault.found}", fault.mend)
    code = CODES.get(fault.code) or ("out-of-range" if _OUT_OF_RANGE.search(fault.message) else "bad-value")
    return RefusedError(code, "; ".join(filter(None, words)))
