"""Faults of missions, sorted by when BehaviorTree.CPP finds them: at load, or only while ticking."""

from __future__ import annotations

from pluto_bt.source import Faults, Place


class Report:
    """Collects faults; `stops_loading` tells whether one was found that `load_mission` refuses.

    Args:
        is_ticked: what is looked at will be ticked; else what would fail then is a warning.
    """

    def __init__(self, faults: Faults, *, is_ticked: bool = True) -> None:
        self.faults = faults
        self._is_ticked = is_ticked
        self._late = 0

    def error(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that BehaviorTree.CPP refuses at load."""
        self.faults.error(place, code, message, expected=expected, found=found, mend=mend)

    def late(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that fails at the first tick: an error for `check` and `run`; `load_mission` lets it pass."""
        if not self._is_ticked:
            self.warning(place, code, message, expected=expected, found=found, mend=mend)
            return
        self._late += 1
        self.faults.error(place, code, message, expected=expected, found=found, mend=mend)

    def warning(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that works but is probably not meant."""
        self.faults.warning(place, code, message, expected=expected, found=found, mend=mend)

    @property
    def doubtful(self) -> Report:
        """A report to the same faults, of what may never be ticked."""
        return Report(self.faults, is_ticked=False)

    @property
    def stops_loading(self) -> bool:
        """True if an error was found that is not only one of ticking."""
        return self._errors > self._late

    @property
    def _errors(self) -> int:
        return sum(fault.severity == "error" for fault in self.faults.in_order())
