"""A person at a real terminal: the program runs in a pseudo-terminal of its own, and what it writes there and reads from there is looked at."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

MISSION = """<root BTCPP_format="4"><BehaviorTree ID="m"><Sequence name="all of it">
  <Sleep name="wait" msec="{0}"/><Say name="greet" text="there"/><Sleep name="rest" msec="{0}"/></Sequence></BehaviorTree></root>"""
SHORT_MS, LONG_MS = 1500, 300_000
"""Five minutes of the robot's time are a second of ours at the least: either wait is drawn, however busy the machine is, or idle."""
LONG_S = 60.0


@pytest.fixture
def at_a_terminal(tmp_path: Path) -> Callable[..., tuple[str, int]]:
    """Runs `pluto …` and answers questions; gives all that the screen was told, and the exit code."""
    (tmp_path / "m.xml").write_text(MISSION.format(SHORT_MS), encoding="utf-8")
    (tmp_path / "long.xml").write_text(MISSION.format(LONG_MS), encoding="utf-8")

    def run(*words: str, answer: str = "") -> tuple[str, int]:
        ours, theirs = pty.openpty()
        env = {**os.environ, "TERM": "xterm", "COLUMNS": "100", "LINES": "30", "PYTHONPATH": str(Path(__file__).parents[2])}
        process = subprocess.Popen([sys.executable, "-m", "pluto_bt", *words], stdin=theirs, stdout=theirs, stderr=theirs, cwd=tmp_path, env=env)
        os.close(theirs)
        text = ""
        while select.select([ours], [], [], LONG_S)[0]:
            try:
                data = os.read(ours, 65536)
            except OSError:  # the program has let go of the terminal
                break
            text += data.decode("utf-8", "replace")
            if answer and "[y/N]" in text:
                os.write(ours, f"{answer}\n".encode())
                answer = ""
        os.close(ours)
        return text, process.wait(LONG_S)

    return run


def test_the_live_tree_is_drawn_over_itself_and_the_summary_stays(at_a_terminal: Callable[..., tuple[str, int]]) -> None:
    text, code = at_a_terminal("run", "long.xml", "--watch")
    assert code == 0
    assert "\x1b[1A" in text, "the lines of the moment before are taken back"
    assert re.search(r"● Sleep “wait”.*RUNNING", text) and re.search(r"✓ Say “greet”", text)
    assert "SUCCESS" in text[text.rindex("\x1b[") :], "the summary stays on the screen"


@pytest.mark.parametrize(("answer", "code", "told"), [("y", 0, "SUCCESS"), ("n", 1, "held")])
def test_after_a_crash_a_person_is_asked(at_a_terminal: Callable[..., tuple[str, int]], tmp_path: Path, answer: str, code: int, told: str) -> None:
    """The journal of a run that was cut off in the middle: its last line is the one before the end."""
    journal = tmp_path / "j"
    at_a_terminal("run", "m.xml", "--resume", "hold", "--journal", str(journal))
    lines = journal.read_text(encoding="utf-8").splitlines(keepends=True)
    after_wait = next(i for i, line in enumerate(lines) if '"wait"' in line or "/wait" in line)
    journal.write_text("".join(lines[: after_wait + 1]), encoding="utf-8")
    text, ended = at_a_terminal("run", "m.xml", "--resume", "ask", "--journal", str(journal), answer=answer)
    assert ended == code and told in text
    assert re.search(r"was cut off \d+ s ago, after greet had ended\. Go on where it was\? \[y/N\]", text)
