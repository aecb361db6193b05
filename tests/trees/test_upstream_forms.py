"""The ways in which files of other tools write the same mission: every built-in node in every form, and what surrounds it."""

from __future__ import annotations

from pathlib import Path

import pytest

from pluto_bt.trees import MissionError, check_mission, load_mission
from pluto_bt.trees.loader.registry import builtin_types
from pluto_bt.trees.mission import Mission

PORTS = {  # what a node needs besides its children
    "Sleep": 'msec="0"', "Timeout": 'msec="1000"', "Delay": 'delay_msec="0"', "Repeat": 'num_cycles="2"', "RetryUntilSuccessful": 'num_attempts="2"',
    "Script": 'code="v := 1"', "ScriptCondition": 'code="1 == 1"', "Precondition": 'if="true"', "SetBlackboard": 'value="1" output_key="k"',
    "UnsetBlackboard": 'key="k"', "WasEntryUpdated": 'entry="{k}"', "SkipUnlessUpdated": 'entry="{k}"', "WaitValueUpdate": 'entry="{k}"',
    "LoopInt": 'queue="1;2" value="{v}"',
    "LoopBool": 'queue="true" value="{v}"', "LoopDouble": 'queue="1.5" value="{v}"',
    "LoopString": 'queue="a;b" value="{v}"',
    **{f"Switch{n}": 'variable="1" ' + " ".join(f'case_{i}="{i}"' for i in range(1, n + 1)) for n in range(2, 7)},
}  # fmt: skip
CHILD = "<AlwaysSuccess/>"
FORMS = {
    "compact": "<{name} {ports}>{inner}</{name}>",
    "explicit": '<{kind} ID="{name}" {ports}>{inner}</{kind}>',
    "explicit, of another kind": '<Action ID="{name}" {ports}>{inner}</Action>',
    "named": '<{name} name="my {name}" {ports}>{inner}</{name}>',
    "as Groot2 writes it": '<{name} {ports} _description="what it does" _uid="7" _fullpath="a/b">\n\t\t{inner}\n\t</{name}>',
    "with comments and text": "<!-- a --><{name} {ports}><!-- b --> text {inner}<!-- c --></{name}><!-- d -->",
    "conditions with raw signs": '<{name} {ports} _skipIf="1 < 0 && 2 > 1" _onSuccess="done := 1 < 2">{inner}</{name}>',
    "single quotes and lines": "<{name}\n   {ports}\n   _post='a := 1;\n b := 2'\n>{inner}</{name}\n>",
}


def document(body: str) -> str:
    return f'<?xml version="1.0"?>\n<root BTCPP_format="4">\n<BehaviorTree ID="Main">{body}</BehaviorTree>\n</root>'


def written(name: str, form: str) -> str:
    node_type = builtin_types()[name]
    count = {"Decorator": 1, "Control": max(2, node_type.children[0])}.get(node_type.kind, 0)
    return document(FORMS[form].format(name=name, kind=node_type.kind, ports=PORTS.get(name, ""), inner=CHILD * count))


def ends(mission: Mission) -> list[str]:
    return [mission.tick_once() for _ in range(3)]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", builtin_types())
def test_every_built_in_node_in_every_form(name: str, form: str) -> None:
    """The form changes nothing in what the node does."""
    text = written(name, form)
    assert [fault for fault in check_mission(text) if fault.severity == "error"] == []
    assert ends(load_mission(text)) == ends(load_mission(written(name, "compact")))


NAMES = ["ROOT", "Küche 2", "a-b_c", "日本", "x" * 200, "Ünï", "with blank", "1st"]


@pytest.mark.parametrize("name", NAMES)
def test_names_outside_ascii(name: str) -> None:
    tree = name.replace(" ", "_")
    body = f'<BehaviorTree ID="{tree}"><Sequence name="{name}">{CHILD}</Sequence></BehaviorTree>'
    text = f'<root BTCPP_format="4" main_tree_to_execute="{tree}">{body}</root>'
    mission = load_mission(text)
    assert mission.tick_once() == "SUCCESS" and next(iter(mission.statuses())) == name


ROOTS = [
    '<root BTCPP_format="4" project_name="p">{}</root>',
    '<root BTCPP_format="4" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xsi:noNamespaceSchemaLocation="tree.xsd">{}</root>',
    '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n<!-- head -->\n<root\n  BTCPP_format="4"\n  >\n{}\n</root>\n\n',
    '<root BTCPP_format="4">{}<TreeNodesModel><Action ID="Foreign" editable="true"><input_port name="a" type="int" default="1">word</input_port>'
    '<bidirectional_port name="b"/><MetadataFields><Metadata key="value"/></MetadataFields></Action></TreeNodesModel></root>',
    "<root>{}</root>",
    '<root BTCPP_format="x">{}</root>',
    "\ufeff<root BTCPP_format='4'>{}</root>",
]  # fmt: skip


@pytest.mark.parametrize("root", ROOTS)
def test_what_stands_around_the_tree(root: str) -> None:
    text = root.format(f'<BehaviorTree ID="Main">{CHILD}</BehaviorTree>')
    assert [fault for fault in check_mission(text) if fault.severity == "error"] == []
    assert load_mission(text).tick_once() == "SUCCESS"


RAW = [
    ("a<b && b>=a", 1.0), ("a&lt;b &amp;&amp; b&gt;=a", 1.0), ("a & 1", 1.0), ("a || b", 1.0), ("a==1&&b==2", 1.0), ("'&lt;' == '<'", 1.0),
    ("&apos;x&apos; == &quot;y&quot;", None), ("&#97; == 1", 1.0), ("&#x61;==1", 1.0), ("a\n==\n\t1", 1.0), ("RED == 3 && GREEN < RED", 1.0),
     ("c := RED", 3.0),
]  # fmt: skip


@pytest.mark.parametrize(("script", "value"), RAW)
def test_scripts_as_files_have_them(script: str, value: float | None) -> None:
    text = document(f'<Script code="a:=1; b:=1+1; b=2; ok := ({script})"/>')
    if value is None:  # texts stand in single quotes
        with pytest.raises(MissionError):
            load_mission(text)
        return
    mission = load_mission(text, enums={"RED": 3, "GREEN": 1})
    mission.tick_once()
    assert mission.blackboard["ok"] == value


def files(folder: Path, **texts: str) -> Path:
    for name, text in texts.items():
        path = folder / (name.replace("__", "/") + ".xml")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder / "main.xml"


INCLUDED = '<root BTCPP_format="4">{}<BehaviorTree ID="B">{}</BehaviorTree></root>'
INCLUDES = {
    "beside it": {"main": '<root BTCPP_format="4" main_tree_to_execute="B"><include path="b.xml"/></root>', "b": INCLUDED.format("", CHILD)},
    "in a folder, which includes from its own": {
        "main": '<root BTCPP_format="4" main_tree_to_execute="B"><include path="sub/b.xml"/></root>',
        "sub__b": INCLUDED.format('<include path="more/c.xml"/>', '<SubTree ID="C"/>'),
        "sub__more__c": INCLUDED.format("", CHILD).replace('"B"', '"C"')},
    "upwards": {
        "main": '<root BTCPP_format="4" main_tree_to_execute="B"><include path="sub/b.xml"/></root>',
        "sub__b": INCLUDED.format('<include path="../c.xml"/>', '<SubTree ID="C"/>'), "c": INCLUDED.format("", CHILD).replace('"B"', '"C"')},
    "the same twice": {
        "main": '<root BTCPP_format="4" main_tree_to_execute="B"><include path="b.xml"/><include path="./b.xml"/></root>',
        "b": INCLUDED.format("", CHILD)},
    "after the tree that needs it": {
        "main": '<root BTCPP_format="4" main_tree_to_execute="A"><BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree><include path="b.xml"/></root>',
        "b": INCLUDED.format("", CHILD)},
    "a project file": {
        "main": '<root BTCPP_format="4" project_name="p"><include path="b.xml"/><include path="m.xml"/></root>',
        "b": INCLUDED.format("", CHILD), "m": '<root BTCPP_format="4"><TreeNodesModel/></root>'},
    "its own main tree does not count": {
        "main": '<root BTCPP_format="4" main_tree_to_execute="A"><include path="b.xml"/><BehaviorTree ID="A"><SubTree ID="B"/></BehaviorTree></root>',
        "b": INCLUDED.format("", CHILD).replace("<root ", '<root main_tree_to_execute="B" ')},
}  # fmt: skip


@pytest.mark.parametrize("name", INCLUDES)
def test_includes(name: str, tmp_path: Path) -> None:
    main = files(tmp_path, **INCLUDES[name])
    assert [fault for fault in check_mission(main) if fault.severity == "error"] == []
    assert load_mission(main).tick_once() == "SUCCESS"


def test_an_absolute_path_ignores_the_ros_package(tmp_path: Path) -> None:
    (tmp_path / "b.xml").write_text(INCLUDED.format("", CHILD))
    text = f'<root BTCPP_format="4"><include ros_pkg="nav" path="{tmp_path / "b.xml"}"/></root>'
    assert [fault.code for fault in check_mission(text)] == ["ros-package"]
    assert load_mission(text).tick_once() == "SUCCESS"
