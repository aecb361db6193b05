"""The loader and the checker: broken missions give faults with places; formatting a mission changes nothing that the checker says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pluto_bt.modules.topic_globals import TopicGlobals
from pluto_bt.source import Faults
from pluto_bt.source.xml_reader import read_document
from pluto_bt.source.xml_writer import written
from pluto_bt.trees import MissionError, TickError, check_mission, load_mission
from tests.broken.missions import MISSIONS, SOUND
from tests.fuzz.effort import effort

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
FILES = sorted([*(ROOT / "missions").glob("*.xml"), *(ROOT / "pluto_bt/trees/library").glob("*.xml")])
CORPUS = [path.read_text(encoding="utf-8") for path in FILES]
PIECES = [
    "<", ">", "/>", "</", '"', "'", "&", "=", "{", "}", "{=}", "{@x}", "@", ";", "-1", "1e999", "nan", "Sequence", "<Sequence>", "</Sequence>",
    "<SubTree ID=",
    ' _skipIf="', ' _while="1"', ' name="', "<!--", "-->", "<![CDATA[", "]]>", "<?", "?>", "\x00", "\x01", "\ud7ff", "&#10;", "&#x110000;",
    "<include path=",
    '<include path="."/>', "<TreeNodesModel>", "num_cycles", ":=", "?", "(", "é", "\u2028", "\n", "\t", 'ID="', "Parallel", "LoopInt", "root", "Main",
]  # fmt: skip
VALUES = ["", "{", "{}", "{=}", "=", "{@}", "{@@a}", "{ x }", "-1", "0", "1e999", "nan", "inf", "1;2", "1;;2", "a&amp;b", "x := x", "x := 1",
    "true", "' '", "9" * 50]
TAGS = ["Parallel", "IfThenElse", "Repeat", "Inverter", "LoopString", "SubTree", "Script", "GoTo", "Action", "BehaviorTree", "include", "Foo",
    "TryCatch", "Switch2"]
_VALUE, _TAG = re.compile(r'="([^"<>]*)"'), re.compile(r"<([A-Za-z]+)(?=[^<>]*/>)")


@st.composite
def mutated(draw: st.DrawFn) -> str:
    """A sound mission with some pieces cut out, doubled, or put in."""
    text = draw(st.sampled_from(CORPUS))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(text)))
        length = draw(st.integers(0, 60))
        kind = draw(st.sampled_from(["cut", "double", "insert", "swap", "value", "value", "tag"]))
        piece = text[at : at + length]
        if kind == "cut":
            text = text[:at] + text[at + length :]
        elif kind == "double":
            text = text[:at] + piece + text[at:]
        elif kind == "insert":
            text = text[:at] + draw(st.sampled_from(PIECES)) + text[at:]
        elif kind in ("value", "tag"):  # the XML stays sound, so that more of the checker is reached
            spans = [one.span(1) for one in (_VALUE if kind == "value" else _TAG).finditer(text)]
            if spans:
                start, end = draw(st.sampled_from(spans))
                other = slice(*draw(st.sampled_from(spans)))
                word = draw(st.sampled_from([*(VALUES if kind == "value" else TAGS), text[other]]))
                text = text[:start] + word + text[end:]
        else:
            to = draw(st.integers(0, len(text)))
            text = text[:at] + text[at + length :]
            text = text[:to] + piece + text[to:]
    return as_document(text)


def as_document(text: str) -> str:
    """A text that does not begin with `<` would be the name of a file."""
    return text if text.lstrip("\ufeff \t\r\n").startswith("<") else f"<{text}"


def survives(text: str) -> None:
    """Checked, loaded, ticked, formatted: nothing but the errors that are promised."""
    faults = check_mission(text, topics=TopicGlobals(), ports={})
    assert all(fault.message and (fault.line > 0 or fault.code == "too-many-faults") for fault in faults)
    loads = True
    try:
        mission = load_mission(text)
    except MissionError as error:
        loads = False
        assert any(fault.severity == "error" for fault in error.faults)
    if loads:
        try:
            for _ in range(3):
                mission.tick_exactly_once()
            mission.halt()
        except TickError as error:
            assert error.reason
    _formats(text)


def _formats(text: str) -> None:
    reading = Faults()
    document = read_document(text, "", reading)
    if document is None or reading:
        return
    again = written(document)
    before, after = ([(fault.code, fault.severity) for fault in check_mission(one, ports={})] for one in (text, again))
    assert sorted(before) == sorted(after)


@given(mutated())
@effort(150)
def test_a_broken_mission_is_met_with_faults(text: str) -> None:
    survives(text)


@pytest.mark.parametrize("name", [*(name for name, case in MISSIONS.items() if isinstance(case[0], str) and len(case[0]) < 50_000), *SOUND])
def test_formatting_changes_no_fault(name: str) -> None:
    text = SOUND[name] if name in SOUND else MISSIONS[name][0]
    if isinstance(text, str) and text.lstrip("\ufeff \t\r\n").startswith("<") and "include" not in text:
        _formats(text)


@pytest.mark.parametrize("path", sorted((HERE / "found").glob("*.xml")), ids=lambda path: path.name)
def test_what_was_found_once(path: Path) -> None:
    survives(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_shipped_missions_survive_as_they_are(path: Path) -> None:
    survives(path.read_text(encoding="utf-8"))
