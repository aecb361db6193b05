"""No kernel is compiled once a run has begun: while it compiles, the thread that needs it stands still, and the base misses its commands."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

FIELD = """<world name="field"><wall>-40,-40 40,-40 40,40 -40,40 -40,-40</wall>
<circle x="12" y="0.1" r="0.2"/><polygon>11,2.6 14,2.6 14,3 11,3</polygon>
<actor id="walker" r="0.25" speed="1.0" loop="true">20,0 7,0.2 7,6 20,6</actor>
<robot platform="pioneer" x="0" y="0" theta_deg="0"/></world>
"""
TELL_LATE = """
import gc, sys
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.maps.kernel import Kernel
from pluto_bt.runner import make_runner

def known():
    kernels = [one for one in gc.get_objects() if isinstance(one, Kernel) and one._compiled is not None]
    return {(one.__module__, one.__name__, str(signature)) for one in kernels for signature in one._compiled.signatures}

request = Request(sys.argv[3], world=sys.argv[1], platform=sys.argv[2], port=sys.argv[4:])
runner = make_runner(read_inputs(request), max_time_s=60.0)
rehearsed = known()
runner.run()
print(len(rehearsed) > 5, sorted(known() - rehearsed))
"""


@pytest.mark.parametrize("platform", ["pioneer", "jbot"])
def test_what_people_and_things_need_is_compiled_before_the_run(platform: str, tmp_path: Path) -> None:
    """A free field at the start: what an obstacle, a walker or a touch needs, the first half second does not show."""
    (tmp_path / "field.xml").write_text(FIELD, encoding="utf-8")
    assert compiled_late(str(tmp_path / "field.xml"), platform, "patrol.xml", "goals=16,0.2;1,0") == []


@pytest.mark.parametrize(("mission", "world"), [("t13_move_to.xml", "yard.xml"), ("t17_find_the_way.xml", "office.xml")])
def test_what_a_job_needs_is_compiled_before_the_run(mission: str, world: str) -> None:
    """Scans that look down, the map that they are entered in, ways over it."""
    assert compiled_late(world, "atrv2", mission) == []


def compiled_late(*arguments: str) -> list[tuple[str, str, str]]:
    """The kernels, each with its signature, that a run compiles after its rehearsal."""
    done = subprocess.run([sys.executable, "-c", TELL_LATE, *arguments], capture_output=True, text=True, check=False)
    assert done.stdout.startswith("True "), done.stdout + done.stderr
    return list(ast.literal_eval(done.stdout.removeprefix("True ")))
