"""What `why` looks at: the links of the chain, old topics, modules that do not run, a latched stop. The same live and in the black box."""

from __future__ import annotations

from pluto_bt.blackboard.messages import ActuatorState, FVectorState
from pluto_bt.modules.context import Context
from pluto_bt.modules.link import newest
from pluto_bt.record.entries import Link, Situation

LINKS = {
    "motion": "motion/status", "avoidance": "avoidance/status", "drive": "drive/status", "filter": "filter/status",
    "localisation": "Localization/Check",
}  # fmt: skip
RAW = "ATRV2/Drive/Raw"
STILL_MPS, STILL_RADPS = 0.005, 0.005


class SituationWatch:
    """Looks once a step of the executive; what has not changed costs little."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._links = {name: newest(context, topic) for name, topic in LINKS.items()}
        self._raw = newest(context, RAW)
        self._turns_in_place = context.platform.body.kinematics != "ackermann"
        self._drive_command = newest(context, "drive/command")
        self._told: dict[str, tuple[FVectorState, Link]] = {}

    def look(self, now_s: float) -> Situation:
        """The situation now."""
        system = self._context.system
        hold, activity, ended = self._context.latch.held, system.executive.core.mission, system.guard.ended
        links = {name: self._link(name, status) for name, read in self._links.items() if (status := read()) is not None}
        modules = {part.module.name: _trouble(part.state, part.fault, part.error) for part in system.parts if part.state != "running" or part.fault}
        raw, command = self._raw(), self._drive_command()
        stale = self._context.board.stale(now_s)
        return Situation(
            links=links, stale=stale, modules=modules, hold=("", "") if hold is None else (hold.word, hold.text),
            moves=RAW not in stale and _is_moving(raw, self._turns_in_place),
            wanted=isinstance(command, ActuatorState) and command.velocity != (0.0, 0.0),
            mission=("", "") if activity is None else (activity.state, activity.reason),
            ended=("", "") if ended is None else (ended.reason, ended.text),
        )  # fmt: skip

    def _link(self, name: str, status: FVectorState) -> Link:
        """What a link says, made anew only where it says something new."""
        last = self._told.get(name)
        if last is not None and last[0] is status:
            return last[1]
        link = Link(status.element, status.reason, status.text)
        self._told[name] = (status, link)
        return link


def _trouble(state: str, fault: str, error: str) -> str:
    return f"hung: {error}" if fault == "hang" else ": ".join(word for word in (state, error) if word)


def _is_moving(raw: ActuatorState | None, turns_in_place: bool) -> bool:
    """A car turns only by driving; what its base says beyond that is noise of its division."""
    return raw is not None and (abs(raw.velocity[0]) > STILL_MPS or (turns_in_place and abs(raw.velocity[1]) > STILL_RADPS))
