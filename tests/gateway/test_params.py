"""Parameters while the robot runs: all or nothing, in bounds, taken back if nobody confirms, saved for the next run; and what a run makes of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from pluto_bt.gateway.port import RefusedError
from pluto_bt.gateway.requests import Params
from pluto_bt.modules.live_parameters import NAMES, RULES, broken_rules, value_of
from pluto_bt.modules.robot_file import SHIPPED, RobotFile, load_robot_file
from pluto_bt.modules.tuning import Tuning
from pluto_bt.runtime.parameters import describe
from pluto_bt.source import InputError

ROBOT = load_robot_file("atrv2")


class Desk:
    """A `Tuning` and all that it applied."""

    def __init__(self, path: Path | None = None, robot: RobotFile = ROBOT) -> None:
        self.applied: list[RobotFile] = []
        self.tuning = Tuning(robot, self.applied.append, path)

    def ask(self, now_s: float = 0.0, **what: Any) -> Any:
        return self.tuning.answer(Params(**what), now_s)[0]

    def set(self, now_s: float = 0.0, confirm_s: float = 0.0, rev: int | None = None, **values: str) -> Any:
        named = {name.replace("__", "."): value for name, value in values.items()}
        return self.ask(now_s, op="set", confirm_s=confirm_s, rev=rev, values=named)

    @property
    def margin_m(self) -> float:
        (row,) = self.ask(name="avoid.margin_m").rows
        return float(row.value)


def test_every_parameter_is_shown_with_unit_and_range() -> None:
    state = Desk().ask()
    assert [row.name for row in state.rows] == [row.name for row in describe(RobotFile)]
    (row,) = Desk().ask(name="avoid.goto_speed_mps").rows
    assert (row.value, row.unit, row.range, row.default, row.live) == ("0.5", "m/s", "> 0", "0.5", True)
    assert {row.name for row in state.rows if row.live} == NAMES


def test_only_the_last_character_of_a_name_may_be_a_star() -> None:
    assert [row.name for row in Desk().ask(name="avoid.margin*").rows] == ["avoid.margin_m"]
    for pattern in ("*margin_m", "avoid.[m]argin_m", "avoid.?argin_m"):
        with pytest.raises(RefusedError, match="unknown parameter"):
            Desk().ask(name=pattern)


def test_of_thousands_of_unknown_names_the_first_are_told() -> None:
    with pytest.raises(RefusedError) as refused:
        Desk().set(**{f"avoid__margn_{number}": "1" for number in range(2000)})
    told = [refused.value, *refused.value.more]
    assert {one.code for one in told} == {"unknown-param"} and len(told) == 21
    assert told[-1].text == "1980 more parameters are unknown"


@pytest.mark.parametrize("platform", SHIPPED)
def test_shipped_robots_keep_the_rules(platform: str) -> None:
    robot = load_robot_file(platform)
    names = frozenset(name for rule in RULES for name in (rule.low, rule.high))
    assert all(value_of(robot, name) is not None for name in NAMES | names)
    assert broken_rules(robot, names) == []


def test_a_change_is_applied_and_counted() -> None:
    desk = Desk()
    state = desk.set(avoid__margin_m="0.12", wall__distance_m="1")
    assert (state.rev, {row.name: row.value for row in state.rows}) == (2, {"avoid.margin_m": "0.12", "wall.distance_m": "1.0"})
    (robot,) = desk.applied
    assert (robot.avoid.margin_m, robot.wall.distance_m, robot.body) == (0.12, 1.0, ROBOT.body)
    assert desk.set(avoid__margin_m="0.12").rev == 2 and len(desk.applied) == 1, "nothing has changed"


@pytest.mark.parametrize(
    ("values", "codes"),
    [
        ({"avoid__margim_m": "0.1"}, ["unknown-param"]),
        ({"avoid__margin_m": "wide"}, ["bad-value"]),
        ({"avoid__margin_m": "-1"}, ["out-of-range"]),
        ({"avoid__margin_m": "NaN"}, ["out-of-range"]),
        ({"avoid__margin_m": "1e400"}, ["bad-value"]),
        ({"avoid__margin_m": "0.3"}, ["bad-value"]),  # above moving_margin_m
        ({"filter__enabled": "false"}, ["read-only"]),
        ({"drive__max_speed_mps": "9"}, ["bad-value"]),  # above the platform's
        (
            {"avoid__margin_m": "-1", "filter__margin_m": "0", "no": "1", "wall__look_m": "[]"},
            ["read-only", "unknown-param", "out-of-range", "bad-value"],
        ),
    ],
)
def test_all_or_nothing_and_every_fault_is_told(values: dict[str, str], codes: list[str]) -> None:
    desk = Desk()
    with pytest.raises(RefusedError) as refusal:
        desk.set(wall__fillet_m="0.5", **values)
    assert sorted([refusal.value.code, *(more.code for more in refusal.value.more)]) == sorted(codes)
    assert desk.applied == [] and desk.ask().rev == 1


def test_two_who_change_at_once_collide() -> None:
    desk = Desk()
    desk.set(rev=1, avoid__margin_m="0.1")
    with pytest.raises(RefusedError, match='expected rev="2", found "1"'):
        desk.set(rev=1, avoid__margin_m="0.2")
    assert desk.margin_m == 0.1


def test_what_nobody_confirms_goes_back() -> None:
    desk = Desk()
    assert desk.set(0.0, confirm_s=30.0, avoid__margin_m="0.1").confirm_s == 30.0
    desk.set(10.0, confirm_s=30.0, avoid__margin_m="0.2")
    assert desk.tuning.step(39.9) == {} and desk.margin_m == 0.2
    assert desk.tuning.step(40.0) == {"avoid.margin_m": "0.08"}
    assert (desk.margin_m, desk.ask(50.0).rev) == (0.08, 4)


def test_an_empty_set_confirms() -> None:
    desk = Desk()
    desk.set(0.0, confirm_s=5.0, avoid__margin_m="0.1")
    assert desk.set(4.0).confirm_s == 0.0
    assert desk.tuning.step(100.0) == {} and desk.margin_m == 0.1
    with pytest.raises(RefusedError, match="none waits for it"):
        desk.set(101.0)


def test_a_change_can_be_taken_back_once() -> None:
    desk = Desk()
    desk.set(avoid__margin_m="0.1")
    desk.set(avoid__margin_m="0.2")
    assert desk.ask(op="rollback").rows[0].value == "0.1"
    with pytest.raises(RefusedError, match="no change to take back"):
        desk.ask(op="rollback")


def test_what_is_saved_counts_in_the_next_run(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    with pytest.raises(RefusedError, match="start the run with --params"):
        Desk().ask(op="save")
    desk = Desk(path)
    desk.set(0.0, confirm_s=5.0, avoid__margin_m="0.1")
    desk.ask(1.0, op="save")
    assert desk.tuning.step(100.0) == {}
    again = load_robot_file("atrv2", overlay=path)
    assert again.avoid.margin_m == 0.1 and load_robot_file("atrv2", ["avoid.margin_m=0.2"], overlay=path).avoid.margin_m == 0.2
    later = Desk(path, again)
    later.set(wall__distance_m="1")
    later.ask(op="save")
    saved = load_robot_file("atrv2", overlay=path)
    assert (saved.avoid.margin_m, saved.wall.distance_m) == (0.1, 1.0)


def test_a_bad_file_of_parameters_is_told_at_its_lines(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("avoid.margin_m = -1\n[wall]\ndistanze_m = 1\n", encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_robot_file("atrv2", overlay=path)
    assert [(fault.file, fault.line, fault.code) for fault in error.value.faults] == [
        (str(path), 1, "bad-value"), (str(path), 3, "unknown-parameter"),
    ]  # fmt: skip
    with pytest.raises(InputError, match="no such folder"):
        load_robot_file("atrv2", overlay=tmp_path / "none" / "mine.toml")
