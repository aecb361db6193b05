"""Every tutorial mission runs, and says and does what the file beside it shows.

After a wanted change: `python tests/test_tutorials.py` writes the expected files anew; look at the difference before you keep it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

MISSIONS = Path(__file__).resolve().parents[1] / "missions"
TUTORIALS = sorted(path.stem for path in MISSIONS.glob("t[0-9][0-9]_*.xml"))


def told(run: Any) -> str:
    """What a person sees of a run, without times and distances, which every change of the chain moves a little."""
    lines = [f"says    {text}" for text in run.said("say")]
    lines += [f"leaf    {path}: {status}" for path, status in run.leaves.items()]
    lines += [f"entry   {key} = {value}" for key, value in sorted(run.blackboard.items())]
    return "\n".join([*lines, f"result  {run.result} {run.reason}".rstrip(), ""])


def test_there_are_tutorials() -> None:
    assert [name[:3] for name in TUTORIALS] == [f"t{i:02d}" for i in range(1, len(TUTORIALS) + 1)]


@pytest.mark.parametrize("name", TUTORIALS)
def test_a_tutorial_does_what_it_shows(scenario: Any, name: str) -> None:
    run = scenario("yard.xml", mission=f"{name}.xml")
    assert told(run) == (MISSIONS / f"{name}.expected").read_text(encoding="utf-8")
    assert run.collisions == 0
    assert f"<!-- Expected: {name}.expected -->" in (MISSIONS / f"{name}.xml").read_text(encoding="utf-8")


if __name__ == "__main__":
    from pluto_bt.scenario import Play

    for tutorial in TUTORIALS:
        (MISSIONS / f"{tutorial}.expected").write_text(told(Play(MISSIONS)("yard.xml", mission=f"{tutorial}.xml")), encoding="utf-8")
