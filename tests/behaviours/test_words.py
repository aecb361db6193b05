"""Each node that fails or waits gives one documented word and one sentence: read from the sources, and played with a chain that holds the robot."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

import pytest

import pluto_bt.behaviours
import pluto_bt.skills
from pluto_bt.behaviours.make_turn import MakeTurn
from pluto_bt.behaviours.reasons import REASONS, SENSORS, WAITING, may_pass, sentence
from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.blackboard.messages import FVectorState, Pose
from pluto_bt.skills import reasons as chain
from pluto_bt.skills.reasons import CHAIN_REASONS

NO_FAILURE = {"laser", "sonar"}  # the chain's words for what a leaf drives round or waits for as long as its time allows
CODE_OF_WORD = {"bumper": LinkStatus.FRONT_BUMPER, "laser-fatal": LinkStatus.LASER_FATAL, "chain-stopped": LinkStatus.STOPPED_THREAD}
LEAVES = {  # each leaf that drives, with the ports it needs
    "GoTo": 'goal="3;4"', "MakeTurn": 'angle_deg="90"', "DriveVelocity": 'speed_mps="0.3"', "HoldHeading": 'heading_deg="0" speed_mps="0.3"',
    "WallFollow": 'side="left"',
}  # fmt: skip
JOBS = {"MoveTo": 'goal="3;4"', "Explore": 'rectangle="2;3"', "Investigate": "", "Resume": ""}


def modules_of(package: Any) -> list[Path]:
    return sorted(path for folder in package.__path__ for path in Path(folder).rglob("*.py"))


def words_of(path: Path, function: str, position: int) -> list[tuple[int, str]]:
    """(line, word) of each call of `function` whose argument is a plain string."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) == function and len(node.args) > position:
            argument = node.args[position]
            found += [(node.lineno, one.value) for one in ast.walk(argument) if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return found


def test_every_word_that_a_leaf_fails_with_is_documented() -> None:
    used = [(path, line, word) for path in modules_of(pluto_bt.behaviours) for line, word in words_of(path, "fail", 0)]
    unknown = [f"{path.name}:{line}: {word}" for path, line, word in used if word and word not in REASONS]
    assert not unknown
    assert len(used) > 30, "the test still finds them"


def test_every_word_of_the_chain_is_documented_and_a_leaf_may_fail_with_it() -> None:
    constants = {value for name, value in vars(chain).items() if name.isupper() and isinstance(value, str)}
    assert constants == set(CHAIN_REASONS)
    assert set(CHAIN_REASONS) - NO_FAILURE <= set(REASONS)
    plain = [f"{path.name}:{line}: {word}" for path in modules_of(pluto_bt.skills) for line, word in words_of(path, "Verdict", 1)]
    assert not plain, "verdicts name the constants of pluto_bt.skills.reasons"


def test_every_word_has_a_meaning_and_a_cure_and_no_two_the_same() -> None:
    assert all(reason.meaning and reason.cure for reason in REASONS.values())
    assert len({reason.meaning for reason in REASONS.values()}) == len(REASONS)


def drive(stage: Any, xml: str, status: FVectorState, seconds: float) -> tuple[str, Any]:
    """Tick while the chain says `status`: the last status of the mission, and the mission."""
    mission = stage.load(xml)
    stage.robot.says = status
    result = "RUNNING"
    for _ in range(round(seconds * 10)):
        stage.robot.is_at(0.0, 0.0)
        stage.robot.values["Localization/Dead-Reckoning"] = Pose(stage.clock.now_s())
        result = stage.tick(mission)
        if result != "RUNNING":
            break
    return result, mission


def held(word: str) -> FVectorState:
    code = int(CODE_OF_WORD.get(word, LinkStatus.NORMAL))
    return FVectorState(0.0, (0.0, 0.0), (code, -1, 0, 3), word, "a sentence of the chain")


HELD = [(leaf, word) for leaf in LEAVES for word in sorted({*WAITING, "laser", "sonar", "unseen", "operator-stop"})]


@pytest.mark.parametrize(("leaf", "word"), [pair for pair in HELD if pair != ("MakeTurn", "laser-fatal")])  # a turn is over after 30 s anyway
def test_a_leaf_that_is_held_back_says_word_and_sentence_and_fails_with_them_in_the_end(stage: Any, leaf: str, word: str) -> None:
    patience_s = {**WAITING, **(MakeTurn.PATIENCE_S if leaf == "MakeTurn" else {})}.get(word, 1.0)
    xml = f'<{leaf} {LEAVES[leaf]} reason="{{why}}"/>'
    if patience_s > 0.3:
        result, mission = drive(stage, xml, held(word), min(patience_s, 5.0) - 0.2)
        assert result == "RUNNING"
        node = mission.node_states()[-1]
        assert f"{word}: a sentence of the chain" in node.feedback, node.feedback
    if word in WAITING:
        result, mission = drive(stage, xml, held(word), patience_s + 1.0)
        assert (result, mission.blackboard["why"]) == ("FAILURE", word)
        assert mission.deciding_text().endswith(f"failed: {word}: a sentence of the chain")


@pytest.mark.parametrize("word", ["laser-fatal", "lost", "no-pose", "operator-stop"])
@pytest.mark.parametrize("leaf", JOBS)
def test_a_job_says_what_holds_the_robot_back(stage: Any, leaf: str, word: str) -> None:
    result, mission = drive(stage, f'<{leaf} {JOBS[leaf]} reason="{{why}}"/>', held(word), 1.5)
    assert result == "RUNNING"
    assert f"{word}: a sentence of the chain" in mission.node_states()[-1].feedback


@pytest.mark.parametrize("word", ["no-path", "no-object", "lost", "outside-rectangle"])
@pytest.mark.parametrize("leaf", JOBS)
def test_a_job_that_ended_badly_fails_with_motions_word_and_sentence(stage: Any, leaf: str, word: str) -> None:
    ended = FVectorState(0.0, (0.0, 0.0), (0, 0, 0, 0), word, "a sentence of motion")
    result, mission = drive(stage, f'<{leaf} {JOBS[leaf]} reason="{{why}}"/>', ended, 1.5)
    assert (result, mission.blackboard["why"]) == ("FAILURE", word)
    assert mission.deciding_text().endswith(f"{word}: a sentence of motion")


def test_a_word_without_a_sentence_of_its_own_is_given_the_documented_one(stage: Any) -> None:
    silent = FVectorState(0.0, (0.0, 0.0), (0, -1, 0, 3), "no-pose", "")
    result, mission = drive(stage, '<GoTo goal="3;4" reason="{why}"/>', silent, 4.0)
    assert result == "FAILURE"
    assert mission.deciding_text().endswith(sentence("no-pose"))


TRIES = {
    **dict.fromkeys(("bumper", "stuck", "no-path", "timeout", "walker", "", "a-word-of-my-own"), "SUCCESS"),
    **dict.fromkeys(("laser-stale", "wrist-stale", "sonar-stale", "bumper-stale", "laser-fatal", "lost", "no-pose", "chain-stopped"), "FAILURE"),
    **dict.fromkeys(("odometry-frozen", "outside-map", "outside-rectangle", "no-device", "bad-command", "estop", "stopped"), "FAILURE"),
}  # fmt: skip


@pytest.mark.parametrize(("word", "expected"), TRIES.items())
def test_another_try_is_worth_it_only_after_what_may_pass(stage: Any, word: str, expected: str) -> None:
    mission = stage.load(f'<WouldRetryHelp reason="{word}"/>')
    assert stage.tick(mission) == expected
    assert word in mission.node_states()[-1].feedback, "and it says of what it speaks"


def test_where_no_leaf_has_given_a_reason_a_try_is_worth_it(stage: Any) -> None:
    assert stage.tick(stage.load('<WouldRetryHelp reason="{nobody_wrote_it}"/>')) == "SUCCESS"


def test_no_word_that_is_waited_for_as_a_sensor_is_worth_another_try() -> None:
    assert [word for word in SENSORS if may_pass(word)] == []
