"""For how long the chain has held a robot back, word by word."""

from __future__ import annotations

from typing import Final, NamedTuple

from pluto_bt.behaviours.reasons import SENSORS

# a sensor on the brink is well for a moment now and then, and held wheels try again every second: these words must stay away for CLEAR_S
FLICKERING: Final = (*SENSORS, "odometry-stale", "odometry-frozen", "no-pose")
CLEAR_S: Final = 2.0


class Spell(NamedTuple):
    """From the first to the last moment of a word."""

    first_s: float
    last_s: float


class Patience:
    """Counts each word by itself, for what is broken may be told by several that take turns. `word`: the one that holds the robot back, now or
    but for a moment in which it flickers; "" if none does."""

    def __init__(self) -> None:
        self.word = ""
        self._spells: dict[str, Spell] = {}

    def waited_s(self, word: str, now_s: float) -> float:
        """Take the word of this moment, "" for none; seconds since it came."""
        self._spells = {one: spell for one, spell in self._spells.items() if now_s - spell.last_s < CLEAR_S and one in (word, *FLICKERING)}
        if word:
            self._spells[word] = Spell(self._spells[word].first_s if word in self._spells else now_s, now_s)
        self.word = word or max(self._spells, key=lambda one: self._spells[one].last_s, default="")
        return now_s - self._spells[word].first_s if word else 0.0
