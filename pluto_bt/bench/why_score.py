"""Does `why` name the right first cause? What breaks is known by construction, so what it must answer is known too."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from pluto_bt.record.box import Box, open_box
from pluto_bt.source import Faults
from pluto_bt.trees.why import RECENT_S
from pluto_bt.trees.why_box import view_of, why_at

ASKED_AFTER_S = 2.5  # of the fault: by then the robot stands if it has to
FOR_EVER_S = 1e9
LASER_GONE = frozenset({"laser-stale"})
NOTHING: frozenset[str] = frozenset()
FIRST_CAUSES: dict[str, frozenset[str]] = {  # name in CAUSES -> the codes that name it; none: it need not stop anybody
    "laser off": LASER_GONE, "laser frozen": LASER_GONE, "laser stuck": LASER_GONE, "laser NaN": LASER_GONE, "half the beams": LASER_GONE,
    "laser 2 Hz": LASER_GONE, "laser 400 ms late": LASER_GONE, "laser fatal": frozenset({"laser-fatal"}),
    "sonar stuck at 8 m": NOTHING, "sonar stuck at 0": frozenset({"sonar"}), "bumper stuck": frozenset({"bumper"}),
    "odometry frozen": frozenset({"odometry-stale"}),
    "odometry stuck": frozenset({"odometry-frozen"}), "base blocked": frozenset({"odometry-frozen"}),
    "wheel slip": frozenset({"wheel-slip"}), "a little slip": NOTHING,
    "gyro jump": frozenset({"no-pose"}), "small gyro jump": NOTHING, "odometry jump": NOTHING,
    "kidnapped": frozenset({"lost"}), "wrist off by 17 deg": frozenset({"lost"}), "a crate in the way": frozenset({"laser", "sonar"}),
}  # fmt: skip
STAYS = ("kidnapped", "a crate in the way")  # whatever its duration


class Broken(NamedTuple):
    """One fault of a run: its name in CAUSES, when it began, and for how long (0 = for ever)."""

    name: str
    at_s: float
    for_s: float

    def is_felt(self, t_s: float) -> bool:
        """True while it lasts, and for the moment in which its complaint still explains things."""
        lasts_s = FOR_EVER_S if self.for_s == 0.0 or self.name in STAYS else self.for_s + RECENT_S
        return self.at_s <= t_s <= self.at_s + lasts_s


class Asked(NamedTuple):
    """One question: at a time of the run, what was answered, and what would have been right."""

    t_s: float
    answer: str
    right: frozenset[str]

    @property
    def is_right(self) -> bool:
        """True if a cause that was there was named."""
        return self.answer in self.right

    @property
    def text(self) -> str:
        """In one line."""
        return f"at {self.t_s:.1f} s: {self.answer or 'nothing'}, not {' or '.join(sorted(self.right)) or 'anything that was broken'}"


def questions(path: Path, broken: Iterable[Broken], has_failed: bool) -> list[Asked]:
    """Ask a black box whenever a fault has just made the robot stand, and at the end if the mission failed."""
    faults = Faults()
    box = open_box(path, path.name, faults)
    if box is None:
        raise ValueError(f"{path} is no black box")
    return list(_questions(box, tuple(broken), has_failed))


def _questions(box: Box, broken: tuple[Broken, ...], has_failed: bool) -> Iterator[Asked]:
    end_s = box.tick(len(box) - 1).t_s
    for one in broken:
        t_s = one.at_s + ASKED_AFTER_S
        if t_s < end_s and FIRST_CAUSES[one.name] and (one.for_s == 0.0 or one.for_s > ASKED_AFTER_S) and _stands(box, t_s):
            yield _asked(box, t_s, t_s, broken)
    if has_failed:
        yield _asked(box, None, end_s, broken)


def _stands(box: Box, t_s: float) -> bool:
    """True if the robot stands and a link says why."""
    view = view_of(box.now(box.number_at(t_s)))
    return not view.trail.situation.moves and any(link.reason for link in view.trail.situation.links.values())


def _asked(box: Box, at_s: float | None, t_s: float, broken: tuple[Broken, ...]) -> Asked:
    first = why_at(box, at_s).first
    right = frozenset(code for one in broken if one.is_felt(t_s) for code in FIRST_CAUSES[one.name])
    return Asked(t_s, "" if first is None else first.code, right)
