"""Watches the contracts of the mission after each of its ticks, and does what a broken one asks for."""

from __future__ import annotations

from pluto_bt.modules.context import Context
from pluto_bt.trees.activity import Activity
from pluto_bt.trees.contracts import CONTRACT, Breach, ContractWatch, Kept
from pluto_bt.trees.executive import Executive


class ContractGuardian:
    """The contracts of whatever mission runs."""

    def __init__(self, context: Context, core: Executive) -> None:
        self._context, self._core = context, core
        self._watched: Activity | None = None
        self._watch: ContractWatch | None = None

    @property
    def kept(self) -> list[Kept]:
        """How each contract of the mission has stood."""
        return [] if self._watch is None else self._watch.kept

    def look(self, ticked: list[Activity], now_s: float) -> None:
        """Judge the contracts, if the mission was ticked."""
        mission = self._core.mission
        if mission is None or mission not in ticked:
            return
        if mission is not self._watched:
            self._watched, self._watch = mission, mission.mission.contract_watch()
        if self._watch is not None:
            for breach in self._watch.look(now_s):
                self._act(breach)

    def _act(self, breach: Breach) -> None:
        system, then = self._context.system, breach.contract.then
        if then == "stop":
            system.guard.end(CONTRACT, breach.text)
            system.stop_robot(CONTRACT)
            return
        self._context.say("error" if then == "ask" else "warning", CONTRACT, "executive", breach.text)
        if then == "ask":
            system.operator_stop(f'broken contract "{breach.contract.name}"')
