"""Pictures of a mission: every format of one small tree, and properties of the drawings."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from pluto_bt.trees import Mission, load_mission
from pluto_bt.trees.dump import FORMATS, dump, nodes_table, nodes_xml
from pluto_bt.trees.dump.model import drawn
from pluto_bt.trees.dump.svg import Box, _column_starts, _measured, _placed
from pluto_bt.trees.loader.registry import builtin_types

TEXT = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence name="all">
      <Script code="x := 'a &lt; b'"/>
      <SubTree ID="Part" n="{x}"/>
      <Sleep msec="100"/>
      <AlwaysSuccess _skipIf="x == 'no'"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Part"><Inverter><AlwaysFailure/></Inverter></BehaviorTree>
  <TreeNodesModel><SubTree ID="Part"><input_port name="n" default="1">how many</input_port></SubTree></TreeNodesModel>
</root>"""


@pytest.fixture
def mission() -> Mission:
    mission = load_mission(TEXT)
    mission.tick_once()
    return mission


def test_ascii(mission: Mission) -> None:
    assert dump(mission, "ascii") == (
        '{c} Sequence "all"  [* RUNNING]\n'
        "    [a] Script  code=x := 'a < b'  [o SUCCESS]\n"
        "    {t} Part  n={x}  [o SUCCESS]\n"
        "        {d} Inverter  [- IDLE]\n"
        "            [a] AlwaysFailure  [- IDLE]\n"
        "    [a] Sleep  msec=100  [* RUNNING]\n"
        "    [a] AlwaysSuccess  _skipIf=x == 'no'  [- IDLE]\n"
    )


def test_unicode_without_statuses(mission: Mission) -> None:
    assert dump(mission, "unicode", statuses=False) == (
        "▣ Sequence “all”\n"
        "├─ ▶ Script  code=x := 'a < b'\n"
        "├─ ▤ Part  n={x}\n"
        "│  └─ ◇ Inverter\n"
        "│     └─ ▶ AlwaysFailure\n"
        "├─ ▶ Sleep  msec=100\n"
        "└─ ▶ AlwaysSuccess  _skipIf=x == 'no'\n"
    )


def test_dot_names_every_node_once_and_joins_them(mission: Mission) -> None:
    text = dump(mission, "dot")
    assert text.count("label=") == 7
    assert text.count(" -> ") == 6
    assert text.startswith("digraph mission {") and text.endswith("}\n")


@pytest.mark.parametrize("form", ["svg", "xhtml", "xml"])
def test_documents_are_well_formed(mission: Mission, form: str) -> None:
    etree.fromstring(dump(mission, form).encode())


def test_the_file_for_groot_runs_as_the_original_does(mission: Mission) -> None:
    again = load_mission(dump(mission, "xml"))
    again.tick_once()
    assert again.statuses() == mission.statuses()
    assert dump(again, "xml") == dump(mission, "xml")


def test_the_file_for_groot_keeps_the_comments_inside_of_trees() -> None:
    text = TEXT.replace("<Sleep", "<!-- a while --><Sleep").replace("<AlwaysFailure/>", "<!-- on -->\n<AlwaysFailure/><!-- purpose -->")
    lines = [line.strip() for line in dump(load_mission(text), "xml").splitlines()]
    at = lines.index("<!-- a while -->")
    assert lines[at + 1] == '<Sleep msec="100"/>'
    at = lines.index("<!-- on -->")
    assert lines[at + 1 : at + 4] == ["<AlwaysFailure/>", "<!-- purpose -->", "</Inverter>"]


def test_an_unknown_format_is_refused(mission: Mission) -> None:
    with pytest.raises(ValueError, match="unknown format 'png'; one of: ascii, unicode, dot, svg, xhtml, xml"):
        dump(mission, "png")


BODIES = st.recursive(
    st.just("<AlwaysSuccess/>"), lambda inner: st.lists(inner, min_size=1, max_size=4).map(lambda parts: f"<Sequence>{''.join(parts)}</Sequence>")
)


@given(BODIES)
def test_boxes_of_a_drawing_never_overlap_and_children_stand_to_the_right(body: str) -> None:
    mission = load_mission(f'<root BTCPP_format="4"><BehaviorTree ID="T">{body}</BehaviorTree></root>')
    columns: list[float] = []
    root = _measured(drawn(mission.nodes()[0].plan, None), 0, columns)
    _placed(root, _column_starts(columns), 0.0)
    boxes = list(all_boxes(root))
    for one, other in itertools.combinations(boxes[:40], 2):
        apart_x = one.x + one.width <= other.x or other.x + other.width <= one.x
        apart_y = one.y + one.height <= other.y or other.y + other.height <= one.y
        assert apart_x or apart_y
    assert all(child.x > box.x + box.width for box in boxes for child in box.children)


def all_boxes(box: Box) -> list[Box]:
    """The box and all below."""
    return [box, *(inner for child in box.children for inner in all_boxes(child))]


def test_every_built_in_node_is_listed_with_all_its_ports() -> None:
    types = builtin_types()
    table = nodes_table(types)
    for name, node_type in types.items():
        block = table[table.index(f"{name} ") :]
        assert all(f" {port}" in block for port in node_type.ports)
    palette = etree.fromstring(nodes_xml(types, builtin=True).encode())
    assert {element.get("ID") for element in palette[0]} == set(types)


def test_the_palette_has_the_librarys_leaves_and_not_the_built_in_nodes() -> None:
    palette = etree.fromstring(nodes_xml().encode())
    names = [element.get("ID") for element in palette[0]]
    assert "GoTo" in names and "Sequence" not in names
    assert not {"ErrorCondition", "GoalCondition"} & set(names), "what nodes have in common is no node"


def test_formats_are_those_of_the_command_line() -> None:
    assert FORMATS == ("ascii", "unicode", "dot", "svg", "xhtml", "xml")
