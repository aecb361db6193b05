"""`pluto fmt` and `pluto diff` as programs; the canonical form itself is fuzzed in tests/fuzz."""

from __future__ import annotations

import io
import os
from pathlib import Path

import pytest

from pluto_bt.cli import main
from pluto_bt.source import Faults
from pluto_bt.source.xml_reader import read_document
from pluto_bt.source.xml_writer import written
from pluto_bt.trees import load_mission

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def formatted(text: str) -> str:
    document = read_document(text, "", Faults())
    assert document is not None
    return written(document)


CARELESS = """<?xml version='1.0'?><!-- what it is -->
<root   BTCPP_format='4'
><!-- on the line of the root -->



<BehaviorTree ID="A"><Sequence name = 'a "quoted" name'>
  <!-- own line,
       two of them -->
  <Script code="a := 1;
b := a < 2 && a > 0"/><Say text="one&#10;two"/> <!-- behind -->

  <AlwaysSuccess></AlwaysSuccess></Sequence></BehaviorTree>
  <TreeNodesModel><SubTree ID="A"><input_port name="goal" type="point" default="1;2">
  where to </input_port></SubTree></TreeNodesModel></root>
<!-- the end -->"""

CANONICAL = """<?xml version="1.0" encoding="UTF-8"?> <!-- what it is -->
<root BTCPP_format="4"> <!-- on the line of the root -->

  <BehaviorTree ID="A">
    <Sequence name="a &quot;quoted&quot; name">
      <!-- own line,
           two of them -->
      <Script code="a := 1;
b := a &lt; 2 &amp;&amp; a > 0"/>
      <Say text="one&#10;two"/> <!-- behind -->

      <AlwaysSuccess/>
    </Sequence>
  </BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="A">
      <input_port name="goal" type="point" default="1;2">where to</input_port>
    </SubTree>
  </TreeNodesModel>
</root>
<!-- the end -->
"""


def test_the_canonical_form() -> None:
    assert formatted(CARELESS) == CANONICAL
    assert formatted(CANONICAL) == CANONICAL


def test_attributes_fill_lines_under_one_another_in_their_order() -> None:
    ports = " ".join(f'port_{i}="{"x" * 20}"' for i in range(8))
    lines = formatted(f"<a><Node {ports}/></a>").splitlines()[1:-1]
    assert len(lines) == 2 and all(len(line) <= 140 for line in lines)
    assert lines[1].startswith(" " * len("  <Node ") + "port_")
    assert " ".join(" ".join(lines).split()) == f"<Node {ports}/>"


RUNNING_TEXT = [
    # as it is written                                         as it stays
    ("<d>Text of <b>x</b>\n   more</d>", "<d>Text of <b>x</b>\n   more</d>"),
    ("<d><b  k='1'/>, then &lt; <i>y <u/> z</i><!-- c --> </d>", '<d><b k="1"/>, then &lt; <i>y <u/> z</i><!-- c --></d>'),
    ("<d>\n  first\n  <b/>\n  then\n</d>", "<d>\n    first\n    <b/>\n    then\n  </d>"),
]


@pytest.mark.parametrize(("text", "stays"), RUNNING_TEXT)
def test_markup_in_the_midst_of_a_line_of_text_stays_there(text: str, stays: str) -> None:
    assert formatted(f"<a>{text}</a>") == f"<a>\n  {stays}\n</a>\n"
    assert formatted(formatted(f"<a>{text}</a>")) == formatted(f"<a>{text}</a>")


def test_a_formatted_mission_runs_as_before() -> None:
    one, two = (load_mission(text) for text in (CARELESS, CANONICAL))
    assert one.tick_once() == two.tick_once()
    assert one.statuses() == two.statuses()
    assert dict(one.blackboard) == dict(two.blackboard)


def test_fmt_rewrites_only_what_needs_it_and_keeps_mode_and_links(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text(CARELESS)
    Path("b.xml").write_text(CANONICAL)
    os.chmod("a.xml", 0o640)
    os.symlink("a.xml", "link.xml")
    before = Path("b.xml").stat().st_mtime_ns
    assert main(["fmt", "--check", "link.xml", "b.xml"]) == 1
    assert capsys.readouterr().out == "link.xml: not in canonical form\n"
    assert Path("a.xml").read_text() == CARELESS
    assert main(["fmt", "link.xml", "b.xml"]) == 0
    assert capsys.readouterr().out == "link.xml: rewritten\n"
    assert Path("a.xml").read_text() == CANONICAL and Path("link.xml").is_symlink()
    assert Path("a.xml").stat().st_mode & 0o777 == 0o640
    assert Path("b.xml").stat().st_mtime_ns == before
    assert main(["fmt", "--check", "a.xml", "b.xml"]) == 0
    assert sorted(os.listdir()) == ["a.xml", "b.xml", "link.xml"]


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "iso-8859-1"])
def test_fmt_writes_utf_8_whatever_it_reads(encoding: str) -> None:
    text = f'<?xml version="1.0" encoding="{encoding.removesuffix("-sig")}"?>\r\n<root name="Küche"/>\r\n'
    Path("a.xml").write_bytes(text.encode(encoding))
    assert main(["fmt", "a.xml"]) == 0
    assert Path("a.xml").read_bytes() == '<?xml version="1.0" encoding="UTF-8"?>\n<root name="Küche"/>\n'.encode()


def test_fmt_refuses_what_it_cannot_read_and_leaves_it_alone(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text('<root a="1" a="2"/>')
    Path("b.xml").write_text("<root>")
    Path("c.xml").write_text("<root ></root>")
    assert main(["fmt", "a.xml", "b.xml", "nope.xml", "c.xml"]) == 2
    out, err = capsys.readouterr()
    assert out == "c.xml: rewritten\n"
    assert "a.xml:1:13: error" in err and "b.xml:1:1: error" in err and 'no file "nope.xml"' in err
    assert Path("a.xml").read_text() == '<root a="1" a="2"/>'


def test_fmt_of_a_stream(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(CARELESS))
    assert main(["fmt", "-"]) == 0
    assert capsys.readouterr().out == CANONICAL


@pytest.mark.parametrize("folder", ["missions", "sim/worlds", "pluto_bt/trees/library"])
def test_shipped_files_are_in_canonical_form(folder: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fmt", "--check", *map(str, sorted((ROOT / folder).glob("*.xml")))]) == 0, capsys.readouterr().out


OLD = """<root BTCPP_format="4" main_tree_to_execute="M">
<BehaviorTree ID="M"><Sequence name="top">
  <GoTo name="out" goal="1;2" timeout_s="60"/>
  <Say text="there"/>
  <SubTree ID="S" x="1"/>
</Sequence></BehaviorTree>
<BehaviorTree ID="S"><AlwaysSuccess/></BehaviorTree>
</root>"""

DIFFERENCES = [
    # what it shows                    replaced, by                                                        told
    ("layout, comments, form", "<GoTo name=", '<!-- x --><Action   ID="GoTo"\n name=', []),
    ("a port changed", 'timeout_s="60"', 'timeout_s="90"', ['~ tree "M": Sequence "top" / GoTo "out"', '    timeout_s: "60" → "90"']),
    ("a port gone, another new", 'timeout_s="60"', 'avoid="laser"',
     ['~ tree "M": Sequence "top" / GoTo "out"', '    timeout_s: "60" → not given', '    avoid: not given → "laser"']),
    ("a node renamed", 'name="out"', 'name="away"', ['~ tree "M": Sequence "top" / GoTo "away"', '    name: "out" → "away"']),
    ("a node new", "<Say", '<Sleep msec="5"/><Say', ['+ tree "M": Sequence "top" / Sleep', '    msec="5"']),
    ("a node gone", '<Say text="there"/>', "", ['- tree "M": Sequence "top" / Say']),
    ("another type", '<Say text="there"/>', "<AlwaysFailure/>", ['- tree "M": Sequence "top" / Say', '+ tree "M": Sequence "top" / AlwaysFailure']),
    ("a node around another", '<Say text="there"/>', '<Inverter><Say text="there"/></Inverter>',
     ['> tree "M": Say: Sequence "top" → Sequence "top" / Inverter', '+ tree "M": Sequence "top" / Inverter']),
    ("moved within its parent", '<Say text="there"/>\n  <SubTree ID="S" x="1"/>', '<SubTree ID="S" x="1"/>\n  <Say text="there"/>',
     ['> tree "M": SubTree S: Sequence "top" → Sequence "top"']),
    ("moved and changed", '<GoTo name="out" goal="1;2" timeout_s="60"/>\n  <Say text="there"/>',
        '<Say text="there"/>\n  <GoTo name="out" goal="1;3"/>',
     ['> tree "M": GoTo "out": Sequence "top" → Sequence "top"', '    goal: "1;2" → "1;3"', '    timeout_s: "60" → not given']),
    ("a condition", "<AlwaysSuccess/>", '<AlwaysSuccess _skipIf="x"/>', ['~ tree "S": AlwaysSuccess', '    _skipIf: not given → "x"']),
    ("another main tree", 'execute="M"', 'execute="S"', ["~ main tree", '    main_tree_to_execute: "M" → "S"']),
    ("a tree renamed", '<BehaviorTree ID="S">', '<BehaviorTree ID="T">', ['> tree "S" is now "T"']),
    ("a tree new", "</root>", '<BehaviorTree ID="N"><AlwaysSuccess _skipIf="1"/></BehaviorTree></root>', ['+ tree "N"']),
    ("an input declared", "</root>", '<TreeNodesModel><SubTree ID="M"><input_port name="a"/></SubTree></TreeNodesModel></root>', ["+ model of M"]),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "told"), [row[1:] for row in DIFFERENCES], ids=[row[0] for row in DIFFERENCES])
def test_diff(old: str, new: str, told: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text(OLD)
    Path("b.xml").write_text(OLD.replace(old, new, 1))
    assert main(["diff", "a.xml", "b.xml"]) == bool(told)
    assert [line.split("  a.xml")[0].split("  b.xml")[0] for line in capsys.readouterr().out.splitlines()] == told


def test_diff_names_the_places_in_both_files_also_in_included_ones(capsys: pytest.CaptureFixture[str]) -> None:
    Path("part.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="S">\n <AlwaysFailure/></BehaviorTree></root>')
    Path("a.xml").write_text(OLD)
    body = '<BehaviorTree ID="S"><AlwaysSuccess/></BehaviorTree>'
    Path("b.xml").write_text(OLD.replace(body, "").replace("<BehaviorTree ID", '<include path="part.xml"/><BehaviorTree ID', 1))
    assert main(["diff", "a.xml", "b.xml"]) == 1
    assert capsys.readouterr().out.splitlines() == ['- tree "S": AlwaysSuccess  a.xml:7:22', '+ tree "S": AlwaysFailure  part.xml:2:2']


def test_diff_of_files_that_cannot_be_read(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text("<root")
    assert main(["diff", "a.xml", "nope.xml"]) == 2
    err = capsys.readouterr().err
    assert "a.xml:1:1: error" in err and "nope.xml: error" in err


def test_diff_of_long_missions_takes_no_time(capsys: pytest.CaptureFixture[str]) -> None:
    rows = [f'<Say text="{i}"/><GoTo name="g{i}" goal="{i};0"/>' for i in range(2000)]
    for name, some in (("a.xml", rows), ("b.xml", rows[:700] + rows[720:1500] + rows[:20] + rows[1500:])):
        Path(name).write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M"><Sequence>{"".join(some)}</Sequence></BehaviorTree></root>')
    assert main(["diff", "a.xml", "b.xml"]) == 1
    signs = [line[0] for line in capsys.readouterr().out.splitlines() if line[0] in "+->~"]
    assert signs.count("-") == signs.count("+") == 40


def test_nesting_as_deep_as_is_allowed_is_no_trouble(capsys: pytest.CaptureFixture[str]) -> None:
    depth = 250
    body = "<Sequence><ForceSuccess>" * (depth // 2) + '<GoTo goal="3;3.5"/>' + "</ForceSuccess></Sequence>" * (depth // 2)
    for name, goal in (("a.xml", "3;3.5"), ("b.xml", "3;3.6")):
        Path(name).write_text(f'<root BTCPP_format="4"><BehaviorTree ID="M">{body.replace("3;3.5", goal)}</BehaviorTree></root>')
    assert main(["check", "a.xml", "--world", "yard.xml"]) == 0
    assert main(["fmt", "a.xml"]) == 0
    assert main(["diff", "a.xml", "b.xml"]) == 1
    for form in ("ascii", "unicode", "dot", "svg", "xhtml", "xml"):
        assert main(["tree", "a.xml", "--format", form]) == 0
    capsys.readouterr()
