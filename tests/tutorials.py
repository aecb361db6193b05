"""The tutorial missions, as their head comments tell of them: the new idea, and the world, robot and plugin to run them with."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

MISSIONS = Path(__file__).resolve().parents[1] / "missions"


@dataclass(frozen=True)
class Tutorial:
    """One tutorial. `plugin` is a Python module, "" = none is needed."""

    name: str
    idea: str
    world: str
    plugin: str

    @property
    def command(self) -> str:
        """How to run it."""
        words = ["pluto run", f"{self.name}.xml"]
        words += [f"--world {self.world}"] if self.world != "yard.xml" else []
        words += [f"--plugin {self.plugin}"] if self.plugin else []
        return " ".join(words)


def read_tutorials() -> list[Tutorial]:
    """All of them, in order."""
    return [_read(path) for path in sorted(MISSIONS.glob("t[0-9][0-9]_*.xml"))]


def _read(path: Path) -> Tutorial:
    head = " ".join(path.read_text(encoding="utf-8").split("-->")[0].removeprefix("<!--").split())
    idea = re.match(r"New idea: (.+?)[.:] ", head)
    after = re.search(r"After: (t\d\d|nothing)\.", head)
    if idea is None or after is None:
        raise ValueError(f'{path.name}: its first comment must begin "New idea: …", and say "After: tNN."')
    return Tutorial(path.stem, idea[1], _word("World", head) or "yard.xml", _word("Plugin", head))


def _word(name: str, head: str) -> str:
    found = re.search(rf"{name}: ([\w.]+\w)", head)
    return found[1] if found else ""
