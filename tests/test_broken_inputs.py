"""Bad input is harmless: exit 2, every fault with its place and a word for programs, never a traceback, nothing heavy imported."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.cli import main
from tests.broken.missions import MISSIONS, SOUND, tree
from tests.broken.platforms import PLATFORMS
from tests.broken.platforms import SOUND as SOUND_PLATFORM
from tests.broken.worlds import ARNL, IMAGES, MAPS, WORLDS, ros_map, world

HELLO = "t01_say_hello.xml"


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def write(name: str, content: str | bytes) -> str:
    Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return name


def errors_of(answer: dict[str, Any]) -> list[dict[str, Any]]:
    errors = [fault for fault in answer["faults"] if fault["severity"] == "error"]
    assert all(fault["message"] and (fault["expected"] or fault["found"] or fault["mend"]) for fault in errors), errors
    return errors


def refused(capsys: pytest.CaptureFixture[str], *command: str) -> list[dict[str, Any]]:
    """The errors that `pluto run … --json` refuses with; they stand on stderr too."""
    assert main(["run", "--json", *command]) == 2
    out, err = capsys.readouterr()
    answer = json.loads(out.splitlines()[-1])
    assert (answer["result"], answer["reason"]) == ("REFUSED", "bad-input")
    assert "Traceback" not in err
    errors = errors_of(answer)
    assert err.count(": error: ") >= len(errors) > 0
    return errors


def checked(capsys: pytest.CaptureFixture[str], *command: str) -> list[dict[str, Any]]:
    """The errors that `pluto check … --format json` finds."""
    code = main(["check", *command, "--format", "json"])
    out = capsys.readouterr().out
    errors = errors_of(json.loads(out))
    assert code == (2 if errors else 0)
    return errors


def places(errors: list[dict[str, Any]]) -> str:
    return " ".join(f"{fault['line']}:{fault['column']} {fault['code']}" for fault in errors)


@pytest.mark.parametrize("name", MISSIONS)
def test_a_broken_mission_is_refused_at_the_place(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    text, told = MISSIONS[name]
    write("m.xml", text)
    errors = refused(capsys, "m.xml")
    assert places(errors) == told
    assert {fault["file"] for fault in errors} == {"m.xml"}
    assert places(checked(capsys, "m.xml")) == told
    assert main(["tree", "m.xml"]) == 2


@pytest.mark.parametrize("name", SOUND)
def test_what_other_parsers_refuse_may_be_sound(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert checked(capsys, write("m.xml", SOUND[name])) == []
    assert main(["tree", "m.xml"]) == 0


@pytest.mark.parametrize("name", WORLDS)
def test_a_broken_world_is_refused_at_the_place(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    text, told = WORLDS[name]
    errors = refused(capsys, HELLO, "--world", write("w.xml", text))
    assert places(errors) == told
    assert {fault["file"] for fault in errors} == {"w.xml"}
    if name != "a mission":
        assert places(checked(capsys, HELLO, "--world", "w.xml")) == told


@pytest.mark.parametrize("option", ["--world", "--map"])
@pytest.mark.parametrize("name", MAPS)
def test_a_broken_ros_map_is_refused_at_the_place(name: str, option: str, capsys: pytest.CaptureFixture[str]) -> None:
    for image, content in IMAGES.items():
        write(image, content)
    os.mkfifo("pipe.pgm")
    text, told = MAPS[name]
    assert places(refused(capsys, HELLO, option, write("m.yaml", text))) == told
    assert places(checked(capsys, "m.yaml")) == told


@pytest.mark.parametrize("name", ARNL)
def test_a_broken_arnl_map_is_refused_at_the_place(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    text, told = ARNL[name]
    assert places(refused(capsys, HELLO, "--world", write("m.map", text))) == told
    assert places(checked(capsys, "m.map")) == told


@pytest.mark.parametrize("name", PLATFORMS)
def test_a_broken_platform_file_is_refused_at_the_place(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    text, told = PLATFORMS[name]
    assert places(refused(capsys, HELLO, "--platform", write("p.toml", text))) == told
    assert places(checked(capsys, "p.toml")) == told


OPTIONS = {
    "--start": ["", "nan,0,0", "1,2", "1,2,3,4", "a,b,c", "1e400,0,0", "1e30,0,0"],
    "--port": ["goals", "=3", "zzz=3", ""],
    "--set": ["x=1", "=3", "limits.max_speed_mps", "limits.max_speed_mps=fast", "limits.max_speed_mps=-1", "limits.max_speed_mps=NaN",
              "limits.max_speed_mps=1e999", "limits=3", "devices.laser.beams=1e9", "limits.max_speed_mps=" + "[" * 9000],
    "--seed": ["", "-1", "1e99", "²", "9" * 5000, "0x1"],
    "--max-time": ["", "0", "-3", "nan", "inf", "abc", "1e300"],
    "--platform": ["", "Atrv2", "nope.toml", "/", "\0.toml"],
    "--world": ["", "/", "nope.xml", "a" * 5000, "\0"],
    "--map": ["", "/", "nope.yaml"],
    "--plugin": ["", "nope", "a..b", "\0"],
    "--gateway": ["rubbish:xx", "127.0.0.1:99999", "0.0.0.0:0"],
    "--trace": ["", "/", "nowhere/x.jsonl", "mission.xml", "\0", "a" * 5000],
    "--plot": ["", "a.gif", "nowhere/a.png", "\0.png"],
    "--tree": ["", "zzz"],
    "--speed": ["2"],
}  # fmt: skip


@pytest.mark.parametrize(("option", "value"), [(option, value) for option, values in OPTIONS.items() for value in values])
def test_rubbish_in_an_option_is_a_fault_that_names_it(option: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    errors = refused(capsys, HELLO, option, value)
    assert len(errors) == 1
    assert errors[0]["file"].startswith(option) or errors[0]["file"] == value or errors[0]["file"].endswith(' ""')


@pytest.mark.parametrize("words", [["--port"], ["--wat"], ["--watc"], ["extra"], ["--json=3"], ["--speed"]])
def test_a_command_line_that_cannot_be_understood_is_refused_in_json_too(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert [fault["code"] for fault in refused(capsys, HELLO, *words)] == ["bad-usage"]


def test_run_without_arguments_shows_the_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run"]) == 2
    assert "usage: pluto run" in capsys.readouterr().err


def test_the_faults_of_all_files_and_options_are_told_together(capsys: pytest.CaptureFixture[str]) -> None:
    write("m.xml", tree("<Foo/>"))
    write("w.xml", world('<circle x="nan" y="1" r="1"/>'))
    write("p.toml", SOUND_PLATFORM.replace("0.5", "nan", 1))
    write("m.yaml", ros_map(image="none.png"))
    errors = refused(capsys, "m.xml", "--world", "w.xml", "--platform", "p.toml", "--map", "m.yaml", "--start", "x", "--seed", "y", "--trace", "/",
                     "--port", "p", "--max-time", "0", "--gateway", "a:b", "--set", "q=1", "--plugin", "nope", "--plot", "x.gif")  # fmt: skip
    files = [fault["file"] for fault in errors]
    assert sorted(files) == sorted([
        "m.xml", "w.xml", "p.toml", "m.yaml", "--start x", "--seed y", "--trace /", "--port p", "--max-time 0", "--gateway", "--set q=1",
        "--plugin nope", "--plot x.gif",
    ])  # fmt: skip


def test_an_included_file_is_named_in_its_own_faults(capsys: pytest.CaptureFixture[str]) -> None:
    Path("parts").mkdir()
    write("parts/b.xml", '<root BTCPP_format="4">\n<BehaviorTree ID="B">\n  <Foo/>\n</BehaviorTree></root>')
    write("m.xml", tree("<Bar/>", more='<include path="parts/b.xml"/>'))
    errors = refused(capsys, "m.xml")
    assert [(fault["file"], fault["line"], fault["column"]) for fault in errors] == [("parts/b.xml", 3, 3), ("m.xml", 3, 5)]


def test_a_chain_of_includes_ends(capsys: pytest.CaptureFixture[str]) -> None:
    for i in range(60):
        write(f"m{i}.xml", f'<root BTCPP_format="4"><include path="m{i + 1}.xml"/></root>')
    write("m60.xml", tree("<AlwaysSuccess/>"))
    assert [fault["code"] for fault in refused(capsys, "m0.xml")][:1] == ["too-deep"]


@pytest.mark.parametrize("name", ["d.xml", "d.yaml", "d.map", "d.toml"])
def test_folders_pipes_and_loops_are_no_files(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path(name).mkdir()
    os.mkfifo("pipe" + name)
    os.symlink("loop" + name, "loop" + name)
    write("binary" + name, bytes(range(256)) * 20)
    for strange in (name, "pipe" + name, "loop" + name, "binary" + name):
        assert len(checked(capsys, strange)) == 1, strange


def test_a_sparse_file_of_a_terabyte_is_refused_unread(capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("s.xml", "s.yaml", "s.map", "s.toml"):
        with Path(name).open("wb") as file:
            file.truncate(1 << 40)
        assert [fault["code"] for fault in checked(capsys, name)] == ["too-large"], name


def test_a_thousand_faults_are_enough(capsys: pytest.CaptureFixture[str]) -> None:
    write("m.xml", tree("<Sequence>" + "<Foo/>" * 5000 + "</Sequence>"))
    errors = refused(capsys, "m.xml")
    assert (len(errors), errors[-1]["code"]) == (1000, "too-many-faults")


def test_a_flood_of_warnings_hides_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    write("m.xml", tree("<Sequence>" + '<AlwaysSuccess _x="1"/>' * 2000 + "<Foo/></Sequence>"))
    assert [fault["code"] for fault in refused(capsys, "m.xml")] == ["unknown-node"]


def test_a_hundred_thousand_nodes_are_over_the_limit(capsys: pytest.CaptureFixture[str]) -> None:
    write("m.xml", tree("<Sequence>" + "<AlwaysSuccess/>\n" * 100_000 + "</Sequence>"))
    assert places(refused(capsys, "m.xml")) == "50000:1 too-many-nodes"


def test_the_text_of_a_fault_plays_no_tricks_on_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", write("m.xml", tree("<Foo\x1b[2J/>"))]) == 2
    assert main(["run", HELLO, "--start", "\x1b[2J"]) == 2
    assert "\x1b" not in capsys.readouterr().err


def test_a_name_that_is_no_unicode_text_can_be_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, HELLO, "--start", "\udcff")[0]["file"] == "--start \\udcff"


def test_warnings_alone_are_shown_and_let_it_run(capsys: pytest.CaptureFixture[str]) -> None:
    write("m.xml", "<root>" + tree("<AlwaysSuccess/>").partition("\n")[2])
    assert main(["check", "m.xml"]) == 0
    assert "m.xml:1:1: warning: BTCPP_format is missing" in capsys.readouterr().out
    assert main(["run", "m.xml", "--json"]) == 0
    out, err = capsys.readouterr()
    assert [fault["code"] for fault in json.loads(out.splitlines()[-1])["faults"]] == ["no-format"]
    assert "m.xml:1:1: warning: BTCPP_format is missing" in err


def test_check_says_that_all_is_well(capsys: pytest.CaptureFixture[str]) -> None:
    write("good.png", IMAGES["good.png"])
    files = [HELLO, "yard.xml", write("p.toml", SOUND_PLATFORM), write("m.yaml", ros_map()), write("w.xml", world(""))]
    assert main(["check", *files[:1], *files[2:]]) == 0
    assert "4 checked, 0 errors, 0 warnings" in capsys.readouterr().err
    assert main(["check", *files[2:], "--format", "json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"faults": []}


def test_the_json_of_check_has_exactly_the_fields_of_the_contract(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", write("m.xml", tree("<Foo/>")), "--format", "json"]) == 2
    (fault,) = json.loads(capsys.readouterr().out)["faults"]
    assert list(fault) == ["file", "line", "column", "severity", "code", "message", "expected", "found", "mend"]
    assert (fault["file"], fault["line"], fault["column"], fault["severity"]) == ("m.xml", 3, 5, "error")
