"""Every fault of the table once, for ever, while a patrol drives past a post: never a contact of its own making, and a word for what ended it."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from pluto_bt.maps.fault_table import FAULTS, FaultRow
from pluto_bt.scenario import Play, Run

HALL = """<world name="hall" seed="1">
  <wall id="fence">-6,-4 6,-4 6,4 -6,4 -6,-4</wall> <circle id="post" x="0.5" y="0.2" r="0.15"/> <polygon id="crate">3,-2 4,-2 4,-1 3,-1</polygon>
  <script><at t="4"><fault device="{device}" kind="{kind}"{more}/></at></script>
</world>"""
AMOUNT = {"laser": 0.5, "sonar": 0.3, "odometry": 0.5, "imu": 0.3, "compass": 0.5, "gps": 5.0, "wrist": 0.3, "marker": 0.5, "speed": 0.5}
NAMES = {"module": "module:avoid", "leaf": "leaf:go"}

GONE = ("off", "hang", "drop")
BASE_LOST, NO_POSE, STUCK = ("STOPPED", "base-lost"), ("FAILURE", "no-pose"), ("FAILURE", "stuck")
# (device, kind) -> (result, reason), for ever so; what is in neither table must not keep the patrol from its goal
ENDS: dict[tuple[str, str], tuple[str, str]] = {
    **{("laser", kind): ("FAILURE", "laser-stale") for kind in (*GONE, "frozen", "stuck", "nan", "late")},
    **{("sonar", kind): ("FAILURE", "sonar-stale") for kind in (*GONE, "frozen", "nan", "late")},
    **{("bumpers", kind): ("FAILURE", "bumper-stale") for kind in (*GONE, "frozen", "late")},
    **{("odometry", kind): BASE_LOST for kind in (*GONE, "nan")},
    **{("odometry", kind): NO_POSE for kind in ("frozen", "late")},
    **{("base", kind): BASE_LOST for kind in GONE},
    **{("base", kind): NO_POSE for kind in ("frozen", "late")},
    **{("base", kind): ("FAILURE", "odometry-frozen") for kind in ("blocked", "stuck")},
    ("base", "slip"): STUCK,
    ("odometry", "slip"): STUCK,  # the laser sees that it comes no nearer
    ("module", "off"): ("FAILURE", "chain-stopped"),
    ("module", "raise"): ("STOPPED", "module-error"),
    ("module", "hang"): ("STOPPED", "hung"),
    ("leaf", "raise"): ("STOPPED", "leaf-error"),
    ("leaf", "hang"): ("STOPPED", "hung"),
    ("leaf", "wrong"): ("STOPPED", "leaf-error"),
}
# numbers that look right and are wrong, or come too seldom: the robot may be led astray or creep, and then says so
LIES = {
    *((device, kind) for device in ("laser", "sonar", "odometry", "imu") for kind in ("garbage", "wrong", "bias", "jump", "noise", "slow", "stuck")),
    ("base", "slow"), ("bumpers", "nan"), ("bumpers", "garbage"), ("bumpers", "slow"), ("wrist", "garbage"), ("wrist", "noise"),
    ("wrist", "wrong"), ("wrist", "bias"), ("wrist", "jump"),
}  # fmt: skip
ASTRAY = ("", "stuck", "timeout", "bumper", "sonar-stale", "bumper-stale", "laser-stale", "odometry-stale", "no-pose", "lost", "odometry-frozen")
EXITS = {"SUCCESS": 0, "FAILURE": 1, "STOPPED": 3}


def faulty(row: FaultRow, folder: Path) -> str:
    """The hall with this fault in its script."""
    given = {"value": AMOUNT.get(row.device, 1.0), "rate": 1.0, "delay": 1.0}
    more = "".join(f' {name}="{given[name]:g}"' for name in row.needs)
    path = folder / "hall.xml"
    path.write_text(HALL.format(device=NAMES.get(row.device, row.device), kind=row.kind, more=more), encoding="utf-8")
    return str(path)


def platform_for(row: FaultRow, number: int) -> str:
    """Both platforms by turns; a Pioneer has no bumpers."""
    return "atrv2" if row.device == "bumpers" else ("pioneer", "atrv2")[number % 2]


def patrol(scenario: Play, world: str, platform: str) -> Run:
    return scenario(world, mission="patrol.xml", platform=platform, start="-4.5,0,0", ports={"goals": "4,0.5", "timeout_s": 30}, max_time_s=90)


ROWS = [row for row in FAULTS if row.device not in ("marker", "speed")]  # those two are the car's: test_car.py


@pytest.mark.parametrize("number", range(len(ROWS)), ids=[f"{row.device}-{row.kind}" for row in ROWS])
def test_no_fault_makes_the_robot_touch_anything(scenario: Play, tmp_path: Path, number: int) -> None:
    row = ROWS[number]
    run = patrol(scenario, faulty(row, tmp_path), platform_for(row, number))
    assert run.collisions == 0
    assert run.runner.system.simulator.velocity == pytest.approx((0.0, 0.0), abs=1e-3), "at rest in the end"
    expected = ENDS.get((row.device, row.kind), ("SUCCESS", ""))
    if (row.device, row.kind) in LIES and expected == ("SUCCESS", ""):
        assert run.reason in ASTRAY, run.text
    else:
        assert (run.result, run.reason) == expected, run.text
    assert run.exit_code == EXITS[run.result]
    assert run.text or run.result == "SUCCESS", "whoever reads the result is told why"


def test_a_fault_that_passes_lets_the_patrol_go_on(scenario: Play, tmp_path: Path) -> None:
    """Laser and sonar are silent for three seconds: the robot stands meanwhile, and then drives on."""
    for device in ("laser", "sonar"):
        path = tmp_path / "hall.xml"
        path.write_text(HALL.format(device=device, kind="off", more=' for="3"'), encoding="utf-8")
        run = patrol(scenario, str(path), "pioneer")
        assert (run.result, run.collisions) == ("SUCCESS", 0), run.text
        assert math.dist(run.at(5.5).pose[:2], run.at(6.8).pose[:2]) < 0.01
        assert math.dist(run.final_pose[:2], (4.0, 0.5)) < 0.5
