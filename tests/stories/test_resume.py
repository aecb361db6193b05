"""After a crash: the robot stays still until it is decided, what was done is not done again, and the mission comes to its end."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.bench.resume import MISSION, Outcome, outcomes
from pluto_bt.doors import Doors
from pluto_bt.gateway.listen import Address
from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.playback import replay_file
from pluto_bt.result import RunResult
from pluto_bt.resume import ResumeRequest
from pluto_bt.runner import Runner, make_runner
from pluto_bt.source import InputError
from pluto_bt.system import System
from pluto_bt.trees.journal import read_journal

SEEDED_TENTH = 20  # of the kills of `pluto bench resume`

TWO = """<root BTCPP_format="4"><BehaviorTree ID="m"><Sequence>
  <Say name="first" text="one"/> <GoTo name="there" goal="4;3.5"/> <Say name="second" text="two"/> <GoTo name="back" goal="2;3.5"/>
</Sequence></BehaviorTree></root>"""


class CutOffError(BaseException):
    """Stands for the crash in tests that look at other things than the crash itself; not even supervision catches it."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "two.xml").write_text(TWO, encoding="utf-8")
    return tmp_path


def made(folder: Path, policy: str = "resume", start: str | None = None, said: list[str] | None = None, **how: Any) -> Runner:
    request = Request(str(folder / "two.xml"), world="yard.xml", platform="pioneer", start=start, set=how.pop("settings", ()))
    heard = [] if said is None else said
    asked = ResumeRequest(policy, folder / "journal", start is not None, how.pop("confirm", lambda question: False))
    how = {"max_time_s": 60.0, "on_event": lambda event: heard.append(event.text) if event.code == "say" else None, **how}
    return make_runner(read_inputs(request), resume=asked, **how)


def cut_off(folder: Path, at_s: float, said: list[str] | None = None, **how: Any) -> None:
    """A run that ends as if the process had been killed."""

    def progress(system: System) -> None:
        if system.clock.now_s() >= at_s:
            raise CutOffError

    runner = made(folder, said=said, on_progress=progress, **how)
    runner._end_journal = lambda: None  # type: ignore[method-assign]  # a killed process ends nothing
    with pytest.raises(CutOffError):
        runner.run()


def run(folder: Path, policy: str = "resume", **how: Any) -> tuple[RunResult, Runner]:
    runner = made(folder, policy, **how)
    return runner.run(), runner


def test_after_a_kill_at_any_tick_nothing_is_done_twice_and_nothing_is_left_out() -> None:
    done = list(outcomes(SEEDED_TENTH, seed=1))
    assert len(done) == SEEDED_TENTH and [one for one in done if one != Outcome(one.tick, "")] == []


def test_it_goes_on_from_where_it_was_left(folder: Path) -> None:
    said: list[str] = []
    cut_off(folder, 3.0, said)
    past = read_journal(folder / "journal")
    assert past is not None and past.finished == [("first", "SUCCESS")] and past.truth is not None and 2.3 < past.truth[0] < 3.9
    result, runner = run(folder, said=said)
    assert result.result == "SUCCESS" and said == ["one", "two"]
    assert runner.system.track.points[0].pose[0] == pytest.approx(past.truth[0], abs=0.05), "in the simulator it stands where it was left"
    after = read_journal(folder / "journal")
    assert after is not None and not after.has_begun, "a run that came to its end leaves nothing to resume"


def test_held_it_stays_still_and_the_journal_stays(folder: Path) -> None:
    cut_off(folder, 3.0)
    left = (folder / "journal").read_bytes()
    for max_time_s in (None, 9.0):
        result, runner = run(folder, "hold", max_time_s=max_time_s)
        assert runner.system.clock.now_s() < 1.0 and (folder / "journal").read_bytes() == left
        assert (result.result, result.reason, result.exit_code, result.distance_m) == ("STOPPED", "held", 1, 0.0)
        assert "pluto shell resume" in result.text
    assert run(folder)[0].result == "SUCCESS"


def test_an_operator_lets_a_held_mission_go_on(folder: Path) -> None:
    said: list[str] = []
    cut_off(folder, 3.0, said)
    let_go: list[float] = []

    def progress(system: System) -> None:
        if system.clock.now_s() >= 2.0 and not let_go:
            let_go.append(system.simulator.distance_m)
            system.operator_resume()

    result, _ = run(folder, "hold", on_progress=progress, said=said, doors=Doors(gateway=Address(port=0)))
    assert let_go == [0.0] and result.result == "SUCCESS" and said == ["one", "two"]


@pytest.mark.parametrize(("answer", "result"), [(True, "SUCCESS"), (False, "STOPPED")])
def test_asked_a_person_decides(folder: Path, answer: bool, result: str) -> None:
    cut_off(folder, 3.0)
    questions: list[str] = []

    def confirm(question: str) -> bool:
        questions.append(question)
        return answer

    assert run(folder, "ask", confirm=confirm, max_time_s=None)[0].result == result
    assert len(questions) == 1 and "was cut off" in questions[0]


def age(folder: Path) -> None:
    lines = (folder / "journal").read_text(encoding="utf-8").splitlines()
    old = [json.dumps({**json.loads(line), "wall_ns": 1}) for line in lines]
    (folder / "journal").write_text("\n".join(old) + "\n", encoding="utf-8")


DOUBTS = {
    "the mission has changed": lambda folder: (folder / "two.xml").write_text(TWO.replace("4;3.5", "3;3.5"), encoding="utf-8"),
    "s are allowed (resume.max_age_s)": age,
}


@pytest.mark.parametrize("doubt", DOUBTS)
def test_what_is_not_sane_is_held_whatever_the_policy(folder: Path, doubt: str) -> None:
    cut_off(folder, 3.0)
    DOUBTS[doubt](folder)
    for _ in range(2):  # and again: what was in doubt once is not forgotten by the next start
        result, _ = run(folder, max_time_s=None)
        assert (result.reason, result.distance_m) == ("held", 0.0) and doubt in result.text


def damage(folder: Path, number: int, old: bytes = b"{", new: bytes = b"X") -> None:
    """Spoil one line of the journal, counted from 1."""
    lines = (folder / "journal").read_bytes().splitlines(keepends=True)
    assert old in lines[number - 1]
    lines[number - 1] = lines[number - 1].replace(old, new, 1)
    (folder / "journal").write_bytes(b"".join(lines))


DAMAGES = [(1, b"begin", b"bogin"), (1, b"{", b""), (2, b"{", b"X"), (4, b'"pose"', b'"nose"'), (4, b"[", b"[1"), (5, b"{", b"\xff")]


@pytest.mark.parametrize(("number", "old", "new"), DAMAGES)
def test_a_damaged_journal_is_held_whatever_the_policy_and_stays_as_it_is(folder: Path, number: int, old: bytes, new: bytes) -> None:
    cut_off(folder, 3.0)
    damage(folder, number, old, new)
    found = (folder / "journal").read_bytes()
    for policy in ("resume", "hold"):
        result, _ = run(folder, policy, max_time_s=None)
        assert (result.reason, result.distance_m) == ("held", 0.0) and f"the journal is damaged at line {number}" in result.text
        assert (folder / "journal").read_bytes() == found


def test_a_journal_without_its_first_line_is_damaged(folder: Path) -> None:
    cut_off(folder, 3.0)
    (folder / "journal").write_bytes((folder / "journal").read_bytes().split(b"\n", 1)[1])
    result, _ = run(folder, max_time_s=None)
    assert result.reason == "held" and "damaged at line 1" in result.text and "has changed" not in result.text


def test_let_go_with_a_damaged_journal_no_side_effect_is_repeated_and_a_copy_stays(folder: Path) -> None:
    """The line that tells that `there` was reached is lost: it drives there again, but what was said stays said."""
    said: list[str] = []
    cut_off(folder, 8.0, said)
    assert said == ["one", "two"]
    lines = (folder / "journal").read_bytes().splitlines()
    damage(folder, next(i for i, line in enumerate(lines, 1) if b'["there","SUCCESS"]' in line))
    found = (folder / "journal").read_bytes()
    result, _ = run(folder, "hold", on_progress=lambda system: system.operator_resume(), said=said, doors=Doors(gateway=Address(port=0)))
    assert result.result == "SUCCESS" and said == ["one", "two"]
    assert (folder / "journal.damaged").read_bytes() == found
    past = read_journal(folder / "journal")
    assert past is not None and not past.has_begun and not past.damaged_line


@pytest.mark.parametrize("notes", [b"notes\n", b"notes", b"\n", b'{"t": 1, "tick": 2}\n', b"\x89PNG\r\n\x1a\n"])
def test_a_file_that_is_no_journal_is_refused_and_not_written_over(folder: Path, notes: bytes) -> None:
    (folder / "journal").write_bytes(notes)
    with pytest.raises(InputError, match="no journal of a mission") as told:
        made(folder, "hold")
    assert [fault.code for fault in told.value.faults] == ["no-journal"] and (folder / "journal").read_bytes() == notes


def test_that_it_goes_on_is_told(folder: Path) -> None:
    cut_off(folder, 3.0)
    heard: list[tuple[str, str]] = []
    run(folder, on_event=lambda event: heard.append((event.code, event.text)))
    text = next(text for code, text in heard if code == "resumed")
    assert "was cut off" in text and text.endswith("after first had ended; it goes on there")


def test_a_robot_that_was_moved_meanwhile_is_held(folder: Path) -> None:
    cut_off(folder, 3.0)
    result, _ = run(folder, start="8,3,0", max_time_s=None)
    assert result.reason == "held" and "m and" in result.text and "from where it was left" in result.text
    past = read_journal(folder / "journal")
    assert past is not None and past.pose is not None
    result, _ = run(folder, start=f"{past.pose[0] + 0.2},{past.pose[1]},0")
    assert result.result == "SUCCESS", "a little is no matter"


def test_another_platform_is_held(folder: Path) -> None:
    cut_off(folder, 3.0)
    result, _ = run(folder, settings=["avoid.margin_m=0.2"], max_time_s=None)
    assert result.reason == "held" and "the platform has changed" in result.text


def test_a_side_effect_that_had_begun_when_the_crash_came_is_not_repeated(folder: Path) -> None:
    """The key is on the disk before the words are said; the tick's line was never written."""
    said: list[str] = []
    runner = made(folder, said=said)
    keeper = runner.system.executive.keeper
    assert keeper is not None

    def crash(ticks: int, line: str) -> None:
        raise CutOffError

    keeper.after_tick = crash  # type: ignore[method-assign]
    runner._end_journal = lambda: None  # type: ignore[method-assign]
    with pytest.raises(CutOffError):
        runner.run()
    lines = [json.loads(line) for line in (folder / "journal").read_text(encoding="utf-8").splitlines()]
    assert [line["kind"] for line in lines] == ["begin", "act"] and lines[1]["keys"] == ["first#1"]
    result, _ = run(folder, said=said)
    assert result.result == "SUCCESS" and said.count("one") <= 1 and said.count("two") == 1


def test_a_mission_that_an_operator_ended_is_not_resumed(folder: Path) -> None:
    """Ended, and killed a moment later."""

    def progress(system: System) -> None:
        if 2.0 <= system.clock.now_s() < 2.4:
            system.executive.core.abort("operator")

    result, _ = run(folder, on_progress=progress)
    assert result.reason == "stopped"
    past = read_journal(folder / "journal")
    assert past is not None and not past.has_begun


def test_a_run_that_went_on_can_be_replayed(folder: Path) -> None:
    cut_off(folder, 3.0)
    result, _ = run(folder, record=folder / "a.mcap")
    assert result.result == "SUCCESS" and replay_file(folder / "a.mcap") == []


def test_without_the_option_there_is_no_journal(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(folder / "state"))
    make_runner(read_inputs(Request(MISSION, world="yard.xml")), max_time_s=1.0).run()
    assert not os.path.exists(folder / "state")
