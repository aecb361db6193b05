"""`pluto run --watch` and `pluto tree` of a run: plain lines when piped, a tree that moves on a terminal, a black box, a live robot."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from lxml import etree

from pluto_bt.cli import main
from pluto_bt.commands.watch import LiveTree, tree_lines
from pluto_bt.scenario import Play
from pluto_bt.trees.dump import Drawn, folded

MISSION = """<root BTCPP_format="4"><BehaviorTree ID="main"><Sequence name="all">
  <Fallback name="way"><GoTo name="out" goal="{goal}" timeout_s="2"/><Sleep name="rest" msec="1200"/></Fallback>
  <MoveTo name="on" goal="3;0"/></Sequence></BehaviorTree></root>"""


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def node(name: str, status: str, *children: Drawn, feedback: str = "") -> Drawn:
    return Drawn("Control" if children else "Action", "Sequence" if children else "GoTo", name, [], [], status, feedback, 3.24, list(children))


TREE = node("root", "RUNNING", node("done", "IDLE", *(node(f"d{i}", "IDLE") for i in range(5)), feedback="well"),
            node("work", "RUNNING", node("first", "SUCCESS"), node("now", "RUNNING", feedback="2 m to go"), node("then", "IDLE")))  # fmt: skip


@pytest.fixture
def mission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.setenv("LINES", "30")
    Path("m.xml").write_text(MISSION.replace("{goal}", "0;9"), encoding="utf-8")
    return "m.xml"


# ---------------------------------------------------------------------- lines


def test_a_tree_that_fits_is_shown_whole() -> None:
    assert [line.plain for line in tree_lines(TREE, 11)] == [
        "● Sequence “root”  RUNNING 3.2 s",
        "├─ · Sequence “done” – well",
        *(f"│  {'└' if i == 4 else '├'}─ · GoTo “d{i}”" for i in range(5)),
        "└─ ● Sequence “work”  RUNNING 3.2 s",
        "   ├─ ✓ GoTo “first”  SUCCESS 3.2 s",
        "   ├─ ● GoTo “now”  RUNNING 3.2 s – 2 m to go",
        "   └─ · GoTo “then”",
    ]


def test_what_is_not_running_is_folded_when_there_is_no_room() -> None:
    assert [line.plain for line in tree_lines(TREE, 10)][1] == "├─ · Sequence “done” – well, 5 nodes below"
    assert len(tree_lines(TREE, 10)) == 6
    assert [child.name for child in folded(TREE, 10).children[1].children] == ["first", "now", "then"]


def test_with_hardly_any_room_the_lines_round_the_work_are_left() -> None:
    assert [line.plain.strip() for line in tree_lines(TREE, 3)] == [
        "├─ ✓ GoTo “first”  SUCCESS 3.2 s", "├─ ● GoTo “now”  RUNNING 3.2 s – 2 m to go", "└─ · GoTo “then”",
    ]  # fmt: skip


# ---------------------------------------------------------------------- runs


def test_when_piped_beginnings_and_ends_are_lines_in_order(mission: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", mission, "--world", "ideal.xml", "--watch"]) == 0
    told = re.findall(r"^\[ *([\d.]+) s\]   ((?:out|rest|on)[^ ]*: \w+)", capsys.readouterr().out, re.MULTILINE)
    assert [words for _, words in told] == ["out: RUNNING", "out: FAILURE", "rest: RUNNING", "rest: SUCCESS", "on: RUNNING", "on: SUCCESS"]
    assert [float(at_s) for at_s, _ in told[:5]] == pytest.approx([0.0, 2.0, 2.0, 3.2, 3.2], abs=0.11)


def test_on_a_terminal_the_tree_moves_and_the_job_stands_below_its_leaf(mission: str, scenario: Play) -> None:
    run = scenario("ideal.xml", mission=mission, max_time_s=5.0)
    terminal = Terminal()
    live = LiveTree(terminal)
    live.show(run.runner.system)
    live.line("above it")
    live.end(run.runner.result)
    text = re.sub(r"\x1b\[[\d;?]*[a-zA-Z]", "", terminal.getvalue())
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if "● MoveTo “on”  RUNNING 1.8 s" in line)
    assert lines[at + 1].startswith("   └─ ● Sequence “moveto”  RUNNING"), "the tree of the job hangs below the leaf that waits for it"
    assert "above it" in text
    assert text.rstrip().splitlines()[-6].startswith("STOPPED (max-time)")


@pytest.fixture
def box(mission: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["run", mission, "--world", "ideal.xml", "--record", "m.mcap"]) == 0
    capsys.readouterr()
    return "m.mcap"


def test_a_black_box_shows_the_tree_at_any_time(box: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tree", box, "--at", "2.5", "--format", "unicode"]) == 0
    assert capsys.readouterr().out == (
        "▣ Sequence “all”  [● RUNNING 2.5 s]\n"
        "├─ ▣ Fallback “way”  [● RUNNING 2.5 s]\n"
        "│  ├─ ▶ GoTo “out”  goal=0;9 timeout_s=2  [✗ FAILURE 0.5 s – timeout: 2 s are over]\n"
        "│  └─ ▶ Sleep “rest”  msec=1200  [● RUNNING 0.5 s]\n"
        "└─ ▶ MoveTo “on”  goal=3;0  [· IDLE]\n\n"
    )
    assert main(["tree", box, "--format", "ascii"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "RUNNING" in lines[0] and 'MoveTo "on"' in lines[4] and 'Sequence "moveto"' in lines[5], "at the last moment at work, with the job"


def test_every_picture_tells_status_time_and_words(box: str, capsys: pytest.CaptureFixture[str]) -> None:
    for form in ("ascii", "unicode", "dot", "svg", "xhtml"):
        assert main(["tree", box, "--at", "2.5", "--format", form]) == 0
        text = capsys.readouterr().out
        assert "FAILURE 0.5 s" in text and "timeout: 2 s are over" in text, form
        if form in ("svg", "xhtml"):
            etree.fromstring(text.encode())


@pytest.mark.parametrize(
    ("words", "told"),
    [([], "tree takes a file, or --gateway"), (["t01_say_hello.xml", "--gateway", "x:1"], "tree takes a file, or --gateway"),
     (["t01_say_hello.xml", "--at", "3"], "--at goes with a black box"), (["no.mcap"], "no.mcap"),
     (["x.mcap", "--format", "xml"], "xml is the form of a mission"), (["x.mcap", "--tree", "T"], "--tree goes with a mission file"),
     (["--gateway", "here:nonsense"], "nonsense")],
)  # fmt: skip
def test_what_cannot_be_shown_is_refused(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tree", *words]) == 2
    assert told in capsys.readouterr().err


def test_a_gateway_that_is_not_there_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tree", "--gateway", "127.0.0.1:1"]) == 1
    assert capsys.readouterr().err.startswith("pluto tree: no gateway at 127.0.0.1:1")
