"""Contracts of a mission: what must hold all the time, whatever the tree does. Checked live, and over recorded runs.

    <Contract name="keeps its distance" always="@filter_status_element_0 != 7" when="speed > 0" within_s="2" then="stop"/>

A child of `<root>`, also of an included file. Other tools of BehaviorTree.CPP pass over it. `always` and `when` are scripts that only look;
`within_s`: so long `always` may be false in one go; `then`: stop (the run ends), ask (the robot stops until an operator resumes), tell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from pluto_bt.trees.errors import StepError
from pluto_bt.trees.scopes import EMPTY, Scope
from pluto_bt.trees.script import ScriptRunner
from pluto_bt.trees.script.names import names_used

CONTRACT: Final = "contract"  # the reason of a run that a broken one has ended


@dataclass(frozen=True)
class Contract:
    """One rule. `always`, `when` are the scripts as written; "" = at all times."""

    name: str
    always: str
    when: str = ""
    within_s: float = 0.0
    then: str = "stop"
    place: str = ""


@dataclass
class Breach:
    """A contract that does not hold: from when on `always` was false, when that was too long, and when it held again (None = not yet).

    `problem`: why it could not be judged, although all that it names has a value: what guards nothing counts as broken.
    """

    contract: Contract
    since_s: float
    broken_s: float
    until_s: float | None = None
    problem: str = ""

    @property
    def text(self) -> str:
        """One sentence."""
        c = self.contract
        if self.problem:
            return f'contract "{c.name}" cannot be judged: {self.problem}'
        late = f" for more than {c.within_s:g} s" if c.within_s else ""
        return f'contract "{c.name}" is broken: {c.always} has not held since {self.since_s:.2f} s{late}'


@dataclass
class Kept:
    """How a contract has stood so far: how often it was judged, every breach, and why it could not be judged if it never was."""

    contract: Contract
    judged: int = 0
    breaches: list[Breach] = field(default_factory=list)
    problem: str = ""

    def as_json(self) -> dict[str, Any]:
        """For reports."""
        told = [{"since_s": one.since_s, "broken_s": one.broken_s, "until_s": one.until_s} for one in self.breaches]
        verdict = "broken" if told else "kept" if self.judged else "not judged"
        problem = next((one.problem for one in self.breaches if one.problem), "" if self.judged else self.problem)
        return {"name": self.contract.name, "always": self.contract.always, "verdict": verdict, "judged": self.judged, "breaches": told,
                "problem": problem}  # fmt: skip


class ContractWatch:
    """The contracts of one run, looked at after each tick."""

    def __init__(self, contracts: Sequence[Contract], scope: Scope, enums: Mapping[str, int] | None = None) -> None:
        self.kept = [Kept(contract) for contract in contracts]
        known = dict(enums or {})
        self._scripts = [(ScriptRunner(scope, known, one.always), ScriptRunner(scope, known, one.when) if one.when else None) for one in contracts]
        self._names = [tuple(use.name for text in (one.always, one.when) for use in names_used(text)) for one in contracts]
        self._scope = scope
        self._since_s: list[float | None] = [None] * len(contracts)

    def look(self, now_s: float) -> list[Breach]:
        """The contracts that are broken now and were not before."""
        return [breach for number in range(len(self.kept)) if (breach := self._look_at(number, now_s)) is not None]

    def _look_at(self, number: int, now_s: float) -> Breach | None:
        kept, (always, when), problem = self.kept[number], self._scripts[number], ""
        try:
            holds = (when is not None and not when.is_true(None)) or always.is_true(None)
        except StepError as error:
            holds, kept.problem, problem = False, error.reason, error.reason
            if self._is_waiting(number):
                return None
        kept.judged += 1
        since_s = self._since_s[number]
        is_open = bool(kept.breaches) and kept.breaches[-1].until_s is None
        if holds:
            self._since_s[number] = None
            if is_open:
                kept.breaches[-1].until_s = now_s
            return None
        if since_s is None:
            since_s = self._since_s[number] = now_s
        if is_open or now_s - since_s < kept.contract.within_s:
            return None
        kept.breaches.append(Breach(kept.contract, since_s, now_s, problem=problem))
        return kept.breaches[-1]

    def _is_waiting(self, number: int) -> bool:
        """True if it names an entry or topic that nobody has written yet."""
        entries = [self._scope.find(name) for name in self._names[number]]
        return any(entry is None or entry.value is EMPTY for entry in entries)
