"""World files: what is read, which faults are found and where, and that reader and XSD agree."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree
from shared_data import shared_file

from pluto_bt.maps import fault_table
from pluto_bt.maps.load import load_world
from pluto_bt.maps.script import At, Carry, FaultAction, Put, Remove, SetTopic, When
from pluto_bt.maps.world import World
from pluto_bt.source import Fault, Faults, InputError

ROOT = Path(__file__).resolve().parent.parent
SHIPPED = sorted((ROOT / "sim" / "worlds").glob("*.xml"))
XSD = etree.XMLSchema(etree.parse(str(ROOT / "pluto_bt" / "maps" / "world.xsd")))

EVERYTHING = """\
<world name="all" seed="42">
  <wall id="fence">0,0 10,0 10,5</wall>
  <polygon id="house" height="3">2,2 6,2 6,4 2,4 2,2</polygon> <circle id="tree" x="1" y="3" r="0.3" height="0.15"/>
  <hole id="pit">7,7 8,7 8,8</hole>
  <circle id="box" x="0" y="0" r=".5" absent="true"/>
  <area id="kitchen" kind="named">0,0 1,0 1,1</area>
  <area id="east" kind="one-way" theta_deg="90">0,0 1,0 1,1</area>
  <line id="l1" kind="restrictive">0,0 1,0</line>
  <goal id="dock" x="1" y="2" theta_deg="90"/> <goal id="any" x="-1e1" y="+2."/> <home x="0" y="0" theta_deg="180"/>
  <marker id="7" x="0" y="9" theta_deg="0"/> <shadow sensor="gps">0,0 1,0 1,1</shadow>
  <actor id="person" r="0.25" speed="1.0" loop="true">1,1 8,1</actor>
  <terrain id="mud" slip="0.3" roll_deg="1" pitch_deg="5" magnetic_deg="10">0,0 2,0 2,2</terrain>
  <script>
    <at t="30"><remove id="fence"/></at> <at t="45"><place id="box" x="3" y="1"/><place id="box"/></at>
    <at t="50"><place id="pluto" x="4" y="5" theta_deg="90"/><place id="pluto" x="1" y="2"/></at>
    <at t="60"><fault device="laser" kind="fatal" for="20"/><fault device="sonar" kind="noise" value="0.1" beams="2-5"/></at>
    <when inside="kitchen" once="true"><set topic="world/alarm" value="true"/></when>
    <when inside="mud"><fault device="module:sick" kind="slow" delay="0.2"/></when>
  </script>
  <robot name="pluto" platform="atrv2" x="-1" y="-2" theta_deg="-90" ideal="1"/>
</world>
"""


def world_of(tmp_path: Path, text: str) -> World:
    path = tmp_path / "w.xml"
    path.write_text(text, encoding="utf-8")
    return load_world(path, "w.xml")


def faults_of(tmp_path: Path, text: str) -> tuple[Fault, ...]:
    with pytest.raises(InputError) as caught:
        world_of(tmp_path, text)
    return caught.value.faults


def test_every_element_and_attribute_is_read(tmp_path: Path) -> None:
    world = world_of(tmp_path, EVERYTHING)
    assert (world.name, world.seed, world.file) == ("all", 42, "w.xml")
    assert [(shape.id, shape.kind, shape.radius_m, shape.height_m, shape.absent) for shape in world.shapes] == [
        ("fence", "wall", 0.0, 2.0, False), ("house", "polygon", 0.0, 3.0, False), ("tree", "circle", 0.3, 0.15, False),
        ("pit", "hole", 0.0, 2.0, False), ("box", "circle", 0.5, 2.0, True),
    ]  # fmt: skip
    assert world.shapes[1].points.tolist() == [[2, 2], [6, 2], [6, 4], [2, 4]]  # the closing corner is not a corner
    assert not world.shapes[1].points.flags.writeable
    assert [(area.id, area.kind, area.theta_rad) for area in world.areas] == [("kitchen", "named", 0.0), ("east", "one-way", math.pi / 2)]
    assert [(line.id, line.kind) for line in world.lines] == [("l1", "restrictive")]
    assert [(goal.id, goal.x_m, goal.y_m, goal.theta_rad) for goal in world.goals] == [("dock", 1.0, 2.0, math.pi / 2), ("any", -10.0, 2.0, None)]
    assert world.home is not None and world.home.theta_rad == math.pi
    assert [(marker.id, marker.y_m) for marker in world.markers] == [(7, 9.0)]
    assert [shadow.sensor for shadow in world.shadows] == ["gps"]
    (person,) = world.actors
    assert (person.id, person.radius_m, person.speed_mps, person.loop, person.height_m) == ("person", 0.25, 1.0, True, 1.8)
    (mud,) = world.terrains
    assert (mud.slip, mud.roll_rad, mud.pitch_rad, mud.magnetic_rad) == (0.3, math.radians(1), math.radians(5), math.radians(10))
    assert (world.robot.name, world.robot.platform, world.robot.pose, world.robot.ideal) == ("pluto", "atrv2", (-1.0, -2.0, -math.pi / 2), True)


def test_scripts_are_read(tmp_path: Path) -> None:
    first, second, carried, third, entering, again = world_of(tmp_path, EVERYTHING).script
    assert isinstance(first, At) and first.t_s == 30 and isinstance(first.actions[0], Remove) and first.actions[0].id == "fence"
    assert isinstance(second, At) and [(put.x_m, put.y_m) for put in second.actions if isinstance(put, Put)] == [(3.0, 1.0), (None, None)]
    assert isinstance(carried, At)
    assert [(one.x_m, one.y_m, one.theta_rad) for one in carried.actions if isinstance(one, Carry)] == [(4.0, 5.0, math.pi / 2), (1.0, 2.0, None)]
    assert isinstance(third, At)
    fatal, noise = third.actions
    assert isinstance(fatal, FaultAction) and (fatal.device, fatal.kind, fatal.for_s) == ("laser", "fatal", 20.0)
    assert isinstance(noise, FaultAction) and (noise.value, noise.beams, noise.for_s) == (0.1, (2, 5), 0.0)
    assert isinstance(entering, When) and entering.inside == "kitchen" and entering.once
    assert isinstance(entering.actions[0], SetTopic) and entering.actions[0].value == "true"
    assert isinstance(again, When) and not again.once
    assert isinstance(again.actions[0], FaultAction) and again.actions[0].delay_s == 0.2


def test_places_point_at_the_element(tmp_path: Path) -> None:
    world = world_of(tmp_path, EVERYTHING)
    assert (world.shapes[2].place.line, world.shapes[2].place.column, world.robot.place.line) == (3, 64, 20)


def test_what_has_no_id_gets_one_that_nobody_writes(tmp_path: Path) -> None:
    world = world_of(tmp_path, '<world>\n<wall>0,0 1,0</wall><wall>0,0 1,1</wall><wall id="wall2">0,0 1,2</wall></world>')
    assert [shape.id for shape in world.shapes] == ["wall@2", "wall@2:21", "wall2"]
    assert world.name == "w"


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_worlds_are_faultless(path: Path) -> None:
    warnings = Faults()
    world = load_world(path, warnings=warnings)
    assert not warnings
    assert world.name == path.stem and world.robot.pose is not None
    assert XSD.validate(etree.parse(str(path))), XSD.error_log


def test_the_car_is_shipped_with_its_corridor() -> None:
    world = load_world(ROOT / "sim" / "worlds" / "corridor.xml")
    assert world.bounds_m() == (0.0, 0.0, 3.13, 19.78)
    assert [area.points.tolist() for area in world.areas if area.kind == "map"] == [[[0, 0], [3.13, 0], [3.13, 19.78], [0, 19.78]]]
    assert world.robot.pose == (0.5, 12.0, math.pi / 2) and len(world.markers) == 20


def test_the_real_yard_is_read() -> None:
    world = load_world(shared_file("data", "worlds", "kth_yard.xml"))
    assert len(world.shapes) == 19 and world.bounds_m() == (0.0, 0.0, 183.26, 239.42)
    assert world.robot.pose == (115.0, 222.0, math.radians(-90))


# --- faults: line, column, code, message; the last column says whether the XSD sees it too ---

BAD = [
    ('<wal id="a">0,0 1,0</wal>', 2, 1, "unknown-element", "unknown element <wal> in <world>", True),
    ('<wall id="a" hight="1">0,0 1,0</wall>', 2, 14, "unknown-attribute", 'unknown attribute "hight" of <wall>', True),
    ('<circle id="a" x="1" r="1"/>', 2, 1, "missing-attribute", '<circle> needs the attribute "y"', True),
    ('<circle id="a" x="1" y="b" r="1"/>', 2, 25, "bad-value", 'attribute "y" must be a number', True),
    ('<circle id="a" x="1" y="nan" r="1"/>', 2, 25, "bad-value", 'attribute "y" must be a number', True),
    ('<circle id="a" x="1" y="inf" r="1"/>', 2, 25, "bad-value", 'attribute "y" must be a number', True),
    ('<circle id="a" x="1" y="1e999" r="1"/>', 2, 25, "bad-value", 'attribute "y" must be from -1e+06 to 1e+06', True),
    ('<circle id="a" x="1" y="1" r="-1"/>', 2, 31, "bad-value", 'attribute "r" must be greater than 0', True),
    ('<circle id="a" x="1" y="1" r="0"/>', 2, 31, "bad-value", 'attribute "r" must be greater than 0', True),
    ('<circle id="a" x="1" y="1" r="1" height="0"/>', 2, 42, "bad-value", 'attribute "height" must be greater than 0', True),
    ('<circle id="a" x="1" y="1" r="1" absent="yes"/>', 2, 42, "bad-value", 'attribute "absent" must be true or false', True),
    ('<circle id="" x="1" y="1" r="1"/>', 2, 13, "bad-value", 'attribute "id" is empty', True),
    ('<circle id="a" x="1" y="1" r="1">1,1</circle>', 2, 34, "unexpected-text", "<circle> has no text", True),
    ('<wall id="a">0,0</wall>', 2, 14, "too-few-points", "<wall> needs at least 2 points", True),
    ('<wall id="a"/>', 2, 1, "too-few-points", "<wall> needs at least 2 points", True),
    ('<wall id="a">0,0 1;0 2,0</wall>', 2, 18, "bad-point", "this is no point", True),
    ('<wall id="a">0,0 1,nan</wall>', 2, 18, "bad-point", "this is no point", True),
    ('<wall id="a">0,0 1,2,3</wall>', 2, 18, "bad-point", "this is no point", True),
    ('<wall id="a">1,1 1,1</wall>', 2, 14, "zero-length", "this wall has no length", False),
    ('<polygon id="a">0,0 1,0</polygon>', 2, 17, "too-few-points", "<polygon> needs at least 3 points", True),
    ('<polygon id="a">0,0 1,0 0,0</polygon>', 2, 17, "zero-area", "this <polygon> has no area", False),
    ('<polygon id="a">0,0 1,1 2,2 3,3</polygon>', 2, 17, "zero-area", "this <polygon> has no area", False),
    ('<polygon id="a">0,0 2,2 2,0 0,2</polygon>', 2, 17, "self-crossing", "the border of this <polygon> crosses itself at 1,1", False),
    ('<hole id="a">0,0 4,0 4,4 2,0 0,4</hole>', 2, 14, "self-crossing", "the border of this <hole> crosses itself at 2,0", False),
    ('<area id="a" kind="map">0,0 3,0 1,0 1,1</area>', 2, 25, "self-crossing", "the border of this <area> crosses itself at 3,0", False),
    ('<area id="a" kind="maps">0,0 3,0 1,1</area>', 2, 20, "bad-value", 'unknown kind "maps"', True),
    ('<area id="a">0,0 3,0 1,1</area>', 2, 1, "missing-attribute", '<area> needs the attribute "kind"', True),
    ('<wall id="a">0,0 1,0</wall>\n<circle id="a" x="0" y="0" r="1"/>', 3, 13, "duplicate-id", 'the id "a" stands twice', True),
    ('<area id="a" kind="map">0,0 3,0 1,1</area>\n<terrain id="a">0,0 3,0 1,1</terrain>', 3, 14, "duplicate-id", 'the id "a" stands twice', True),
    ('<goal id="a" x="0" y="0"/><goal id="a" x="0" y="0"/>', 2, 37, "duplicate-id", 'the id "a" stands twice', True),
    ('<marker id="1" x="0" y="0"/><marker id="1" x="0" y="0"/>', 2, 41, "duplicate-id", 'the id "1" stands twice', True),
    ('<marker id="-1" x="0" y="0"/>', 2, 13, "bad-value", 'attribute "id" must be a whole number', True),
    ('<home x="0" y="0"/>\n<home x="0" y="0" theta_deg="9"/>', 3, 1, "duplicate-element", "a second <home>", False),
    ('<robot x="0" y="0"/>\n<robot x="0" y="0"/>', 3, 1, "duplicate-element", "a second <robot>", False),
    ('<robot x="0"/>', 2, 1, "missing-attribute", '<robot> needs the attribute "y"', False),
    ('<terrain id="a" slip="1.5">0,0 3,0 1,1</terrain>', 2, 23, "bad-value", 'attribute "slip" must be from 0 to 1', True),
    ('<terrain id="a" pitch_deg="90">0,0 3,0 1,1</terrain>', 2, 28, "bad-value", 'attribute "pitch_deg" must be from -89 to 89', True),
    ('<actor id="a" r="1" speed="-1">0,0</actor>', 2, 28, "bad-value", 'attribute "speed" must be from 0 to 100', True),
    ('<shadow sensor="gsp">0,0 3,0 1,1</shadow>', 2, 17, "bad-value", 'unknown sensor "gsp"', True),
    ('<map src="no.yaml"/>', 2, 11, "no-file", 'there is no file "no.yaml"', False),
    ('<map src="w.xml"/>', 2, 11, "bad-value", "a world cannot include a world", False),
    ('<script><at t="-1"><remove id="d"/></at></script>', 2, 16, "bad-value", 'attribute "t" must be from 0 to 1e+09', True),
    ('<script><at t="1"/></script>', 2, 9, "no-action", "<at> does nothing", True),
    ('<script><at t="1"><remov id="d"/></at></script>', 2, 19, "unknown-element", "unknown element <remov> in <at>", True),
    ('<script><on t="1"/></script>', 2, 9, "unknown-element", "unknown element <on> in <script>", True),
    ('<script><at t="1"><remove id="dor"/></at></script>', 2, 31, "unknown-id", 'there is no wall, shape or actor "dor"', False),
    ('<script><when inside="k"><remove id="d"/></when></script>', 2, 23, "unknown-id", 'there is no area or terrain "k"', False),
    ('<script><at t="1"><place id="d" x="1"/></at></script>', 2, 19, "missing-attribute", '<place> needs the attribute "y"', False),
    ('<script><at t="1"><set topic="world/alarm"/></at></script>', 2, 19, "missing-attribute", '<set> needs the attribute "value"', True),
    ('<script><at t="1"><fault device="lasser" kind="off"/></at></script>', 2, 34, "unknown-device", 'unknown device "lasser"', True),
    ('<script><at t="1"><fault device="module" kind="off"/></at></script>', 2, 34, "unknown-device", 'unknown device "module"', True),
    ('<script><at t="1"><fault device="laser:x" kind="off"/></at></script>', 2, 34, "unknown-device", 'unknown device "laser:x"', True),
    ('<script><at t="1"><fault device="laser" kind="of"/></at></script>', 2, 47, "unknown-fault-kind", 'unknown kind of fault "of"', True),
    ('<script><at t="1"><fault device="gps" kind="fatal"/></at></script>', 2, 45, "unknown-fault-kind",
     'a fault "fatal" makes no sense for gps', False),
    ('<script><at t="1"><fault device="gps" kind="late"/></at></script>', 2, 19, "missing-attribute", '<fault> needs the attribute "delay"', False),
    ('<script><at t="1"><fault device="gps" kind="off" value="1"/></at></script>', 2, 50, "unknown-attribute",
     'fault "off" of gps has no attribute "value"', False),
    ('<script><at t="1"><fault device="gps" kind="noise" value="1" beams="1-2"/></at></script>', 2, 62, "unknown-attribute",
     'fault "noise" of gps has no attribute "beams"', False),
    ('<script><at t="1"><fault device="sonar" kind="nan" beams="5-2"/></at></script>', 2, 59, "bad-value", "these are no beams", False),
    ('<script><at t="1"><fault device="sonar" kind="slow" rate="0"/></at></script>', 2, 59, "bad-value",
     'attribute "rate" must be greater than 0', False),
    ('<script><at t="1"><fault device="sonar" kind="drop" rate="2"/></at></script>', 2, 59, "bad-value",
     'attribute "rate" must be from 0 to 1', False),
    ('<script><at t="1"><fault device="gps" kind="off" for="-1"/></at></script>', 2, 55, "bad-value",
     'attribute "for" must be from 0 to 1e+09', True),
]  # fmt: skip


@pytest.mark.parametrize(("text", "line", "column", "code", "message", "in_xsd"), BAD)
def test_each_fault_is_told_with_its_place(tmp_path: Path, text: str, line: int, column: int, code: str, message: str, in_xsd: bool) -> None:
    source = f'<world name="w">\n{text}\n<wall id="d">0,0 1,0</wall></world>'
    (fault,) = faults_of(tmp_path, source)
    assert (fault.file, fault.line, fault.column, fault.code, fault.message) == ("w.xml", line, column, code, message)
    assert fault.expected and fault.found
    assert XSD.validate(etree.fromstring(source)) is not in_xsd


@pytest.mark.parametrize("seed", ["-1", "1.5", "x", "", "9223372036854775808", "nan", "+1"])
def test_a_bad_seed_is_a_fault(tmp_path: Path, seed: str) -> None:
    source = f'<world seed="{seed}"/>'
    (fault,) = faults_of(tmp_path, source)
    assert (fault.line, fault.column, fault.message) == (1, 14, 'attribute "seed" must be a whole number')
    if seed != "+1":
        assert not XSD.validate(etree.fromstring(source))


def test_mends(tmp_path: Path) -> None:
    def mend(text: str) -> str:
        return faults_of(tmp_path, f"<world><wall id='door'>0,0 1,0</wall>{text}</world>")[0].mend

    assert mend("<circl x='1' y='1' r='1'/>") == 'did you mean "circle"?'
    assert mend("<circle x='1' y='1' R='1'/>") == 'is "R" meant to be "r"?'
    assert mend("<goal id='a' x='1' y='1' thetadeg='1'/>") == 'did you mean "theta_deg"?'
    assert mend("<wall>0, 0 1,1</wall>") == "no blank before or after the comma"
    assert mend("<script><at t='1'><remove id='Door'/></at></script>") == 'did you mean "door"?'
    assert mend("<script><at t='1'><fault device='lazer' kind='off'/></at></script>") == 'did you mean "laser"?'
    assert mend("<script><at t='1'><fault device='gps' kind='noize' value='1'/></at></script>") == 'did you mean "noise"?'
    assert faults_of(tmp_path, "<root/>")[0].mend == "this is a mission: give it as MISSION.xml, not as a world"


def test_all_faults_are_told_at_once_and_in_order(tmp_path: Path) -> None:
    text = '<world sed="1">\n<circle x="a" y="b" r="-1"/>\n<script><at t="x"><remove id="q"/></at></script>\n<polygon>0,0 1,1</polygon>\n</world>'
    assert [(fault.line, fault.column) for fault in faults_of(tmp_path, text)] == [(1, 8), (2, 12), (2, 18), (2, 24), (3, 16), (3, 31), (4, 10)]


def test_a_report_in_full(tmp_path: Path) -> None:
    (fault,) = faults_of(tmp_path, '<world>\n  <polygon id="a">0,0 2,2 2,0 0,2</polygon>\n</world>')
    assert fault.as_text() == (
        "w.xml:2:19: error: the border of this <polygon> crosses itself at 1,1\n"
        '        <polygon id="a">0,0 2,2 2,0 0,2</polygon>\n'
        "                        ^\n"
        "      expected  corners in the order of the border\n"
        "      found     edges 1 and 3 meet"
    )


# --- the table of faults ---


@pytest.mark.parametrize("row", fault_table.FAULTS, ids=lambda row: f"{row.device}-{row.kind}")
def test_every_row_of_the_fault_table_can_be_written(tmp_path: Path, row: fault_table.FaultRow) -> None:
    device = f"{row.device}:x" if row.device in fault_table.NAMED else row.device
    example = {"value": "0.5", "rate": "0.5", "delay": "0.5", "beams": "0-3"}
    for names in (row.needs, (*row.needs, *row.takes)):
        attributes = "".join(f' {name}="{example[name]}"' for name in names)
        text = f'<world><script><at t="1"><fault device="{device}" kind="{row.kind}"{attributes}/></at></script></world>'
        assert world_of(tmp_path, text).script
        assert XSD.validate(etree.fromstring(text)), XSD.error_log


def test_the_fault_table_and_the_schema_name_the_same_kinds() -> None:
    tree = etree.parse(str(ROOT / "pluto_bt" / "maps" / "world.xsd"))
    values = tree.xpath('//*[@name="fault"]/*[@name="kind"]//@value')
    assert values == list(fault_table.KINDS)
    assert len(fault_table.ROWS) == len(fault_table.FAULTS)
    assert set(fault_table.KINDS) == {
        "off", "frozen", "stuck", "nan", "garbage", "wrong", "slow", "late", "drop", "fatal", "noise", "bias", "slip", "jump", "blocked",
        "hang", "raise",
    }  # fmt: skip


# --- included maps ---


def test_a_map_is_included_and_its_names_count(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    objects = 'Cairn: Goal 1000 2000 0 "" ICON "desk"\nCairn: RobotHome 0 0 90 "" ICON "h"\n'
    (tmp_path / "maps" / "m.map").write_text(f"2D-Map\n{objects}LINES\n0 0 1000 0\n")
    text = '<world>{}<map src="maps/m.map"/><script><at t="1"><remove id="line1"/></at></script></world>'
    world = world_of(tmp_path, text.format(""))
    assert [shape.id for shape in world.shapes] == ["line1"] and [goal.id for goal in world.goals] == ["desk"]
    assert world.robot.pose == (0.0, 0.0, math.pi / 2) and world.home is not None
    (fault,) = faults_of(tmp_path, text.format("<goal id='desk' x='0' y='0'/>"))
    assert (fault.code, fault.line, fault.found) == ("duplicate-id", 1, "the first is in maps/m.map")


def test_faults_of_an_included_map_have_their_own_place(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text("image: m.pgm\nresolution: 0\norigin: [0, 0, 0]\n")
    faults = faults_of(tmp_path, '<world>\n<map src="m.yaml"/><wal/>\n</world>')
    assert sorted((fault.file, fault.line, fault.column, fault.code) for fault in faults) == [
        ("m.yaml", 1, 8, "no-file"), ("m.yaml", 2, 13, "bad-value"), ("w.xml", 2, 20, "unknown-element"),
    ]  # fmt: skip


# --- properties ---

COORDINATES = st.floats(-1000, 1000).map(lambda x: round(x, 3))
IDS = st.text("abcäß-_ 1", min_size=1, max_size=6).filter(lambda name: name.strip() == name)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=50)
@given(
    st.lists(st.tuples(COORDINATES, COORDINATES, st.floats(0.01, 5).map(lambda r: round(r, 3)), st.booleans()), max_size=5),
    st.dictionaries(IDS, st.tuples(COORDINATES, COORDINATES, st.none() | st.floats(-360, 360)), max_size=4),
    st.lists(st.lists(st.tuples(COORDINATES, COORDINATES), min_size=2, max_size=6, unique=True), max_size=4),
    st.integers(0, 2**63 - 1),
)
def test_what_is_written_is_read_back(tmp_path: Path, circles: list, goals: dict, walls: list, seed: int) -> None:  # type: ignore[type-arg]
    root = etree.Element("world", seed=str(seed))
    for x, y, r, absent in circles:
        etree.SubElement(root, "circle", x=repr(x), y=repr(y), r=repr(r), absent=str(absent).lower())
    for name, (x, y, theta_deg) in goals.items():
        etree.SubElement(root, "goal", {"id": name, "x": repr(x), "y": repr(y)} | ({} if theta_deg is None else {"theta_deg": repr(theta_deg)}))
    for wall in walls:
        etree.SubElement(root, "wall").text = "\n ".join(f"{x!r},{y!r}" for x, y in wall)
    world = world_of(tmp_path, etree.tostring(root, encoding="unicode", pretty_print=True))
    assert world.seed == seed
    shapes = world.shapes
    assert [(*shape.points[0].tolist(), shape.radius_m, shape.absent) for shape in shapes if shape.kind == "circle"] == circles
    assert [list(map(tuple, shape.points.tolist())) for shape in shapes if shape.kind == "wall"] == walls
    read = {goal.id: (goal.x_m, goal.y_m, None if goal.theta_rad is None else math.degrees(goal.theta_rad)) for goal in world.goals}
    assert list(read) == list(goals)
    for name, (x, y, theta_deg) in goals.items():
        assert read[name][:2] == (x, y)
        assert read[name][2] == (theta_deg if theta_deg is None else pytest.approx(theta_deg, abs=1e-9))


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=100)
@given(st.data())
def test_a_damaged_world_is_read_or_refused_but_never_crashes(tmp_path: Path, data: st.DataObject) -> None:
    text = EVERYTHING
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(text)))
        text = text[:at] + data.draw(st.text("<>/=\"' ,.-1eax&\n", max_size=3)) + text[at + data.draw(st.integers(0, 6)) :]
    try:
        world_of(tmp_path, text)
    except InputError as error:
        assert all(fault.line > 0 or fault.code == "no-file" for fault in error.faults)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=100)
@given(st.binary(max_size=200), st.sampled_from(["a.xml", "a.map", "a.yaml", "a.pgm", "a.png", "a"]), st.sampled_from([b"", b"2D-Map\n", b"<world>"]))
def test_random_bytes_are_read_or_refused(tmp_path: Path, data: bytes, name: str, start: bytes) -> None:
    (tmp_path / name).write_bytes(start + data)
    try:
        load_world(tmp_path / name)
    except InputError as error:
        assert error.faults


def test_heavy_libraries_are_not_loaded_by_reading_a_world() -> None:
    code = (
        "import sys; from pluto_bt.maps.load import load_world; load_world('sim/worlds/yard.xml');"
        "print([m for m in ('numba','scipy','matplotlib','shapely','lxml','PIL') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True, env={"PYTHONPATH": str(ROOT)})
    assert done.stdout.strip() == "[]"


def test_polygons_agree_with_a_geometry_library() -> None:
    from shapely import Polygon

    from pluto_bt.maps.polygons import _crossing_of_many, crossing, is_flat, without_repeats

    generator = np.random.default_rng(1)
    valid = 0
    for _ in range(300):
        corners = without_repeats(generator.integers(0, 6, (int(generator.integers(3, 8)), 2)).astype(float))
        if len(corners) >= 3:
            is_good = not is_flat(corners) and crossing(corners) is None
            assert is_good == bool(Polygon(corners).is_valid), corners.tolist()
            assert (crossing(corners) is None) == (_crossing_of_many(corners) is None), corners.tolist()
            valid += is_good
    assert 30 < valid < 270
