"""`why` asked in the middle of every job, a second after something broke and when the run has ended: the true cause first, with what mends it."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import pytest

from pluto_bt.record.box import open_box
from pluto_bt.scenario import Play
from pluto_bt.source import Faults
from pluto_bt.trees.why_box import why_at
from tests.stories.test_endings import COURT, JOBS, PERSON, fault

T_S = 9.0


class Asked(NamedTuple):
    """One row: what breaks in which job, what is named, and a part of the cure. `later`: nothing can tell it within a second."""

    job: str
    happens: str
    layer: str
    code: str
    cure: str
    at_s: float = T_S
    platform: str = "atrv2"
    later: bool = False


KIDNAPPED = '<place id="pluto" x="21" y="11.5" theta_deg="130"/>'
ROWS = (
    Asked("moveto", fault("laser", "garbage"), "sensor", "laser-stale", "check the laser"),
    Asked("moveto", fault("laser", "stuck", 'value="0.5"'), "sensor", "laser-stale", "check the laser", platform="pioneer"),
    Asked("moveto", fault("module:sick", "off"), "module", "module-stopped", "module start sick"),
    Asked("moveto", fault("module:sick", "raise"), "module", "module-error", "pluto ps", platform="pioneer"),
    Asked("moveto", fault("wrist", "off"), "sensor", "wrist-stale", "check the wrist", at_s=2.0),
    Asked("moveto", fault("base", "blocked"), "sensor", "odometry-frozen", "free the wheels", platform="pioneer"),
    Asked("moveto", fault("bumpers", "off"), "sensor", "bumper-stale", "check the bumpers", at_s=2.0),
    Asked("explore", fault("wrist", "frozen"), "sensor", "wrist-stale", "check the wrist"),
    Asked("explore", fault("module:wrist", "off"), "module", "module-stopped", "module start wrist"),
    Asked("explore", fault("odometry", "stuck"), "sensor", "odometry-frozen", "encoders", platform="pioneer"),
    Asked("investigate", fault("laser", "off"), "sensor", "laser-stale", "check the laser", at_s=3.0),
    Asked("investigate", fault("module:local", "off"), "module", "module-stopped", "module start local"),
    Asked("investigate", KIDNAPPED, "sensor", "lost", "post its pose", platform="pioneer", later=True),
    Asked("wall follow", KIDNAPPED, "sensor", "lost", "post its pose"),
    Asked("wall follow", fault("laser", "fatal", 'for="100"'), "sensor", "laser-fatal", "reboot", platform="pioneer"),
    Asked("follow", fault("laser", "fatal", 'for="100"'), "sensor", "laser-fatal", "reboot", platform="pioneer"),
    Asked("follow", fault("sonar", "nan"), "sensor", "sonar-stale", "check the sonar"),
    Asked("navigate", fault("base", "late", 'delay="0.4"'), "sensor", "odometry-stale", "check the base", platform="pioneer"),
    Asked("navigate", fault("bumpers", "stuck", 'value="1"'), "sensor", "bumper", "DriveVelocity"),
    Asked("goto", fault("module:avoid", "raise"), "module", "module-error", "pluto ps"),
    Asked("goto", fault("laser", "drop", 'rate="0.9"'), "sensor", "laser-stale", "check the laser", platform="pioneer", later=True),
    Asked("goto", fault("odometry", "slow", 'rate="1"'), "sensor", "odometry-stale", "check the base"),
)


@pytest.mark.parametrize("row", ROWS, ids=[f"{row.job}, {row.happens[1:-2].replace(chr(34), '')}" for row in ROWS])
def test_why_names_what_broke_in_the_middle_of_a_job_and_at_its_end(scenario: Play, tmp_path: Path, row: Asked) -> None:
    more = PERSON if row.job == "follow" else ""
    world = COURT.format(more=more, y=12 if row.job == "wall follow" else 7, at_s=row.at_s, fault=row.happens)
    (tmp_path / "court.xml").write_text(world, encoding="utf-8")
    (tmp_path / "m.xml").write_text(f'<root BTCPP_format="4"><BehaviorTree ID="m">{JOBS[row.job]}</BehaviorTree></root>', encoding="utf-8")
    run = scenario(tmp_path / "court.xml", mission=tmp_path / "m.xml", platform=row.platform, max_time_s=row.at_s + 45.0, record=tmp_path / "a.mcap")
    assert run.result in ("FAILURE", "STOPPED") and run.reason != "max-time", run.text
    box = open_box(tmp_path / "a.mcap", "a.mcap", Faults())
    assert box is not None
    for at_s in (row.at_s + (2.0 if row.later else 1.0), None):
        if at_s is None or at_s < run.sim_time_s:
            first = why_at(box, at_s).first
            assert first is not None and (first.layer, first.code) == (row.layer, row.code), (at_s, first)
            assert row.cure in first.unblock and first.since_s >= row.at_s - 0.5, (at_s, first)
