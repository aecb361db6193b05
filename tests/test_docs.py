"""The guides tell the truth: tables are those of the program, links lead somewhere, commands and code work as they stand."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from pluto_bt.behaviours.reasons import REASONS
from pluto_bt.cli import main
from pluto_bt.maps.load import load_world
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.result import INTERRUPTED, SUPERVISION
from pluto_bt.trees.loader.registry import node_types
from tests.doc_tables import PAGES, ROOT, TABLES, names_in, updated
from tests.doc_texts import RUN_REASONS

XS = "{http://www.w3.org/2001/XMLSchema}"
FENCE = re.compile(r"^```(\w*)[ ]?(\S*)\n(.*?)^```", re.DOTALL | re.MULTILINE)
NOT_ALONE = ("--realtime", "pluto shell", "pluto ps", "pluto record", "pluto bench")  # need a running robot, or minutes


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def blocks(path: Path) -> Iterator[tuple[str, str, str]]:
    """(language, file name, content) of every code block."""
    return ((found[1], found[2], found[3]) for found in FENCE.finditer(text_of(path)))


def commands(path: Path) -> list[str]:
    """Every `pluto …` line of the plain blocks, in order."""
    return [line for language, _, text in blocks(path) if not language for line in text.splitlines() if line.startswith("pluto ")]


def quick(path: Path) -> list[str]:
    return [line for line in commands(path) if not any(word in line for word in NOT_ALONE)]


def write_files(path: Path, folder: Path) -> None:
    """The code blocks with a file name, as files; and the folder `out` that README writes into."""
    for _, name, text in blocks(path):
        if "." in name:
            (folder / name).write_text(text, encoding="utf-8")
    (folder / "out").mkdir(exist_ok=True)


by_page = pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)


# ---------------------------------------------------------------------- tables and links


@by_page
def test_the_tables_are_those_of_the_program(page: Path) -> None:
    assert text_of(page) == updated(text_of(page)), "python -m tests.doc_tables writes them anew"


def test_every_table_stands_somewhere() -> None:
    assert sorted(name for page in PAGES for name in names_in(text_of(page))) == sorted(TABLES)


@by_page
def test_links_lead_to_files_and_headings(page: Path) -> None:
    for target, anchor in re.findall(r"\]\((?!https?:)([^)#]*)#?([^)]*)\)", text_of(page)):
        file = page.parent / target if target else page
        assert file.exists(), target
        if anchor:
            heads = [line.lstrip("# ").lower() for line in text_of(file).splitlines() if line.startswith("#")]
            headings = [re.sub(r"[^\w -]", "", head).replace(" ", "-") for head in heads]
            assert anchor in headings, f"{target}#{anchor}"


@by_page
def test_a_page_names_no_machine_and_no_missing_file(page: Path) -> None:
    text = text_of(page)
    assert not re.search(r"/(work|home|root|tmp)/", text)
    for name in re.findall(r"`((?:pluto_bt|sim|tests|missions|docs|estimation|drivers)/[\w./]+)`", text):
        assert (ROOT / name).exists(), name


def test_every_node_stands_in_the_page_on_missions() -> None:
    text = text_of(ROOT / "docs" / "missions.md") + text_of(ROOT / "docs" / "nav2.md")
    assert [node.name for node in node_types().values() if node.is_ours and f"| `{node.name}` |" not in text] == []


def test_every_word_of_a_run_has_its_row() -> None:
    assert {*SUPERVISION, INTERRUPTED, "max-time", "stopped", "bad-input"} <= set(RUN_REASONS)
    assert all(meaning or word in REASONS for word, (_, meaning, _) in RUN_REASONS.items())


# ---------------------------------------------------------------------- worlds


def world_tables() -> dict[str, dict[str, str]]:
    """Of docs/worlds.md: element → attribute → default, as the tables under its headings say."""
    found: dict[str, dict[str, str]] = {}
    tags: list[str] = []
    for line in text_of(ROOT / "docs" / "worlds.md").splitlines():
        if line.startswith("#"):
            tags = re.findall(r"`<(\w+)>`", line)
            found |= {tag: {} for tag in tags}
        elif tags and (row := re.match(r"\| `(\w+)` \| [^|]* \| ([^|]*) \|", line)):
            for tag in tags:
                found[tag][row[1]] = row[2].strip().strip("`")
    return found


def schema_attributes() -> dict[str, dict[str, bool]]:
    """Of the schema: element → attribute → must it be given."""
    schema = ET.parse(ROOT / "pluto_bt" / "maps" / "world.xsd").getroot()
    types = {one.get("name", ""): one for kind in ("complexType", "attributeGroup") for one in schema.findall(XS + kind)}

    def attributes(node: ET.Element) -> dict[str, bool]:
        found: dict[str, bool] = {}
        for child in node:
            if child.tag == XS + "attribute":
                found[child.get("name", "")] = child.get("use") == "required"
            elif child.tag == XS + "attributeGroup":
                found |= attributes(types[child.get("ref", "")])
            elif child.tag == XS + "extension":
                found |= attributes(types[child.get("base", "")]) if child.get("base") in types else {}
                found |= attributes(child)
            elif child.tag in (XS + "simpleContent", XS + "complexContent"):
                found |= attributes(child)
        return found

    found = {}
    for element in schema.iter(XS + "element"):
        name, kind = element.get("name"), element.get("type", "")
        inner = element.find(XS + "complexType")
        if name:
            found[name] = attributes(types.get(kind, inner if inner is not None else element))
    return found


def test_every_element_and_attribute_of_the_schema_is_described() -> None:
    described = {tag: {name: default == "must be given" for name, default in rows.items()} for tag, rows in world_tables().items()}
    assert described == schema_attributes()


LEAST = {  # the least that each element needs, and where it stands
    "world": "<world{0}/>", "wall": "<world><wall{0}>0,0 1,0</wall></world>", "polygon": "<world><polygon{0}>0,0 1,0 1,1</polygon></world>",
    "hole": "<world><hole{0}>0,0 1,0 1,1</hole></world>", "circle": '<world><circle x="1" y="2" r="1"{0}/></world>',
    "actor": '<world><actor r="1" speed="1"{0}>0,0</actor></world>', "terrain": "<world><terrain{0}>0,0 1,0 1,1</terrain></world>",
    "area": '<world><area kind="named"{0}>0,0 1,0 1,1</area></world>', "marker": '<world><marker id="1" x="1" y="1"{0}/></world>',
    "robot": '<world><robot x="0" y="0"{0}/></world>', "when": '<world><area id="a" kind="named">0,0 1,0 1,1</area><wall id="w">0,0 1,0</wall>'
    '<script><when inside="a"{0}><remove id="w"/></when></script></world>',
    "fault": '<world><script><at t="1"><fault device="gps" kind="off"{0}/></at></script></world>',
}  # fmt: skip
DEFAULTS = [(tag, name, default) for tag, rows in world_tables().items() for name, default in rows.items()
            if default not in ("must be given", "none", "invented", "all", "the file's name")]  # fmt: skip


@pytest.mark.parametrize(("tag", "name", "default"), DEFAULTS)
def test_a_default_of_the_page_is_that_of_the_reader(tag: str, name: str, default: str, tmp_path: Path) -> None:
    """The world with the default written out is the world without it."""
    worlds = []
    for number, given in enumerate(("", f' {name}="{default}"')):
        path = tmp_path / f"{number}.xml"
        path.write_text(LEAST[tag].format(given), encoding="utf-8")
        worlds.append(re.sub(r"Place\([^)]*\)", "", repr(replace(load_world(path, "w.xml"), file="", files=()))))
    assert worlds[0] == worlds[1]


# ---------------------------------------------------------------------- commands and code


@pytest.mark.parametrize("page", [page for page in PAGES if quick(page)], ids=lambda path: path.name)
def test_the_commands_of_a_page_work_as_they_stand(page: Path, tmp_path: Path) -> None:
    """In order, in one empty folder; those with a plugin in a process of their own, for a node type stays registered for good."""
    write_files(page, tmp_path)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        for line in quick(page):
            for part in line.split(" && "):
                words = shlex.split(part)[1:]
                if "--plugin" in words:
                    done = subprocess.run([sys.executable, "-m", "pluto_bt", *words], capture_output=True, text=True, timeout=120,
                                          env={**os.environ, "PYTHONPATH": str(ROOT)}, check=False)  # fmt: skip
                    assert done.returncode == 0, f"{part}\n{done.stdout}{done.stderr}"
                else:
                    assert main(words) == 0, part


def test_the_robot_file_of_the_page_is_whole(tmp_path: Path) -> None:
    write_files(ROOT / "docs" / "platforms.md", tmp_path)
    robot: Any = load_robot_file(str(tmp_path / "cart.toml"))
    assert (robot.name, robot.devices.laser is not None, robot.devices.sonar) == ("cart", True, None)


def test_the_leaf_of_the_page_is_short(tmp_path: Path) -> None:
    write_files(ROOT / "docs" / "leaves.md", tmp_path)
    assert len(text_of(tmp_path / "way_is_clear.py").splitlines()) <= 40


@pytest.mark.parametrize(("page", "test", "passed"), [("leaves", "test_way_is_clear.py", 2), ("tutorial", "test_round.py", 1)])
def test_the_test_of_a_page_passes(tmp_path: Path, page: str, test: str, passed: int) -> None:
    write_files(ROOT / "docs" / f"{page}.md", tmp_path)
    (tmp_path / "conftest.py").write_text("", encoding="utf-8")
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", test]
    done = subprocess.run([sys.executable, *words], cwd=tmp_path, env={**os.environ, "PYTHONPATH": f"{ROOT}:{tmp_path}"},
                          capture_output=True, text=True, timeout=300, check=False)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{passed} passed" in done.stdout


def shape_of(output: str) -> str:
    """A run's output without its figures, which every change of the chain moves a little, and without the line that each minute of it prints."""
    output = re.sub(r"^ +[\d.]+ s +× .*\n", "", output, flags=re.MULTILINE)
    return re.sub(r"[0-9a-f]{16}…|-?[\d.]*\d|\s+", "#", output)


def test_the_sample_of_the_readme_is_what_the_command_prints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sample = next(text for language, _, text in blocks(ROOT / "README.md") if language == "text" and "SUCCESS" in text)
    line = next(line for line in commands(ROOT / "README.md") if "--plot" in line)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path)
        assert main(shlex.split(line)[1:]) == 0
    assert shape_of(capsys.readouterr().out.strip()) == shape_of(sample.strip())


@by_page
def test_python_code_without_a_file_name_runs(page: Path) -> None:
    for language, name, code in blocks(page):
        if language == "python" and not name:
            exec(compile(code, page.name, "exec"), {})
