"""Every tutorial mission runs, and says and does what the file beside it shows.

After a wanted change: `python -m tests.test_tutorials` writes the expected files anew; look at the difference before you keep it.
"""

from __future__ import annotations

import importlib
from typing import Any

import pytest
from py_trees.ports import PortsMixin

from pluto_bt.behaviours.map_path import MapPath
from tests.tutorials import MISSIONS, Tutorial, read_tutorials

TUTORIALS = read_tutorials()


def leaves_of(module: str) -> list[type]:
    """What `--plugin` would find in a module."""
    found = vars(importlib.import_module(module)).values() if module else ()
    return [value for value in found if isinstance(value, type) and issubclass(value, PortsMixin) and value.__module__ == module]


def told(run: Any) -> str:
    """What a person sees of a run: what it said, the leaves that were ticked, the entries. Without times and distances, which every change
    of the chain moves a little.
    """
    lines = [f"says    {text}" for text in run.said("say")]
    lines += [f"leaf    {path}: {status}" for path, status in run.leaves.items() if status != "IDLE"]
    lines += [f"entry   {key} = {rounded(value)}" for key, value in sorted(run.blackboard.items())]
    return "\n".join([*lines, f"result  {run.result} {run.reason}".rstrip(), ""])


def rounded(value: Any) -> str:
    """A measured place in whole metres, a planned path as what it is; all else as it stands."""
    if isinstance(value, tuple) and value != tuple(round(number, 3) for number in value):
        return f"about ({', '.join(f'{number:.0f}' for number in value)})"
    return "a path" if isinstance(value, MapPath) else str(value)


def play(scenario: Any, tutorial: Tutorial) -> Any:
    """Run it as its head comment says."""
    return scenario(tutorial.world, mission=f"{tutorial.name}.xml", nodes=leaves_of(tutorial.plugin))


def test_they_stand_in_order_without_a_gap() -> None:
    assert [one.name[:3] for one in TUTORIALS] == [f"t{i:02d}" for i in range(1, 22)]


@pytest.mark.parametrize("tutorial", TUTORIALS, ids=lambda one: one.name)
def test_a_tutorial_does_what_it_shows(scenario: Any, tutorial: Tutorial) -> None:
    run = play(scenario, tutorial)
    assert told(run) == (MISSIONS / f"{tutorial.name}.expected").read_text(encoding="utf-8")
    assert run.collisions == 0
    assert f"<!-- Expected: {tutorial.name}.expected -->" in (MISSIONS / f"{tutorial.name}.xml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "ports", "lines"),
    [("t09_choose", {"job": "water"}, ["leaf    fetch water: SUCCESS", "entry   job = water"]),
     ("t09_choose", {"job": "sing"}, ["says    I do not know that job", "leaf    no such job: SUCCESS", "entry   job = sing"]),
     ("t11_visit_places", {"places": "4,3.5;-1,3.5;4,3.5"}, ["leaf    Script::2: SUCCESS", "leaf    go: SUCCESS", "leaf    Script::6: SUCCESS",
      "entry   missed = 1", "entry   place = 4,3.5", "entry   places = 4,3.5;-1,3.5;4,3.5", "entry   visited = 2"])],
)  # fmt: skip
def test_a_tutorial_takes_other_inputs(scenario: Any, name: str, ports: dict[str, str], lines: list[str]) -> None:
    run = scenario("yard.xml", mission=f"{name}.xml", ports=ports)
    assert told(run).splitlines() == [*lines, "result  SUCCESS"]


if __name__ == "__main__":
    from pluto_bt.scenario import Play

    for one in TUTORIALS:
        (MISSIONS / f"{one.name}.expected").write_text(told(play(Play(MISSIONS), one)), encoding="utf-8")
