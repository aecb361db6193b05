"""Faults of missions, sorted by when BehaviorTree.CPP finds them: at load, or only while ticking."""

from __future__ import annotations

from pluto_bt.source import Faults, Place


class Report:
    """Collects faults; `stops_loading` tells whether one was found that `load_mission` refuses."""

    def __init__(self, faults: Faults) -> None:
        self.faults = faults
        self._late = 0

    def error(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that BehaviorTree.CPP refuses at load."""
        self.faults.error(place, code, message, expected=expected, found=found, mend=mend)

    def late(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that fails at the first tick: an error for `check` and `run`; `load_mission` lets it pass."""
        self._late += 1
        self.faults.error(place, code, message, expected=expected, found=found, mend=mend)

    def warning(self, place: Place, code: str, message: str, *, expected: str = "", found: str = "", mend: str = "") -> None:
        """Something that works but is probably not meant."""
        self.faults.warning(place, code, message, expected=expected, found=found, mend=mend)

    @property
    def doubtful(self) -> Report:
        """A report to the same faults of what may never be ticked: what would fail then is a warning."""
        report = Report(self.faults)
        report.late = report.warning  # type: ignore[method-assign]
        return report

    @property
    def stops_loading(self) -> bool:
        """True if an error was found that is not only one of ticking."""
        return self._errors > self._late

    @property
    def _errors(self) -> int:
        return sum(fault.severity == "error" for fault in self.faults.in_order())
