"""Plugins: what a module may bring, and how it is told what is wrong with it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import py_trees.ports
import pytest

from pluto_bt.behaviours.say import Say
from pluto_bt.inputs.plugins import load_plugins
from pluto_bt.runtime import VirtualClock
from pluto_bt.source import Fault, Faults
from pluto_bt.trees import check_mission, enums, load_mission
from pluto_bt.trees.loader.registry import node_types

Load = Callable[[str], tuple[Fault, ...]]

HEAD = "from pluto_bt.behaviours.leaf import Leaf\nfrom pluto_bt.behaviours.ports import Port\n"
LEAF = "class {name}(Leaf):\n    INPUT_PORTS = {{}}\n    OUTPUT_PORTS = {{}}\n    def update(self): return self.succeed()\n"


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Load]:
    """Loads a text as a plugin and gives its faults; what it registers is forgotten after the test."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    monkeypatch.setattr(py_trees.ports, "_REGISTRY", py_trees.ports.get_ports_registry())
    monkeypatch.setattr(enums, "_known", {})
    loaded: list[str] = []

    def run(text: str) -> tuple[Fault, ...]:
        name = f"plugin_of_a_test_{len(loaded)}"
        loaded.append(name)
        (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
        faults = Faults()
        load_plugins([name], faults)
        return faults.in_order()

    yield run
    for name in loaded:
        sys.modules.pop(name, None)


COLOURS = """<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>
<Script code="colour := RED; answer := THE_ANSWER"/>
<Precondition if="colour != BLUE" else="FAILURE"><Switch2 variable="{colour}" case_1="BLUE" case_2="RED">
  <AlwaysFailure/> <AlwaysSuccess/> <AlwaysFailure/></Switch2></Precondition>
</Sequence></BehaviorTree></root>"""


def test_a_module_brings_names_for_numbers(load: Load) -> None:
    assert {fault.code for fault in check_mission(COLOURS)} == {"unset-key"}
    assert load('ENUMS = {"RED": 0, "BLUE": 1, "THE_ANSWER": 42}\n') == ()
    assert check_mission(COLOURS) == () == check_mission(COLOURS.replace("colour := RED", "colour := 3; colour := RED")), "a number takes a number"
    mission = load_mission(COLOURS, clock=VirtualClock())
    assert mission.tick_once() == "SUCCESS" and mission.blackboard["answer"] == 42.0
    own = load_mission(COLOURS, clock=VirtualClock(), enums={"THE_ANSWER": 7})
    own.tick_once()
    assert own.blackboard["answer"] == 7.0, "what the caller says stands above"


def test_a_misspelt_enum_is_recognised(load: Load) -> None:
    load('ENUMS = {"RED": 0, "BLUE": 1, "THE_ANSWER": 42}\n')
    (fault,) = check_mission(COLOURS.replace("!= BLUE", "!= BLEU"))
    assert (fault.line, fault.code, fault.mend) == (3, "unset-key", 'did you mean "BLUE"?')


NO_ENUMS = ['["RED"]', '{"RED": 1.5}', '{"RED": True}', '{"RED": "1"}', '{"a b": 1}', '{"true": 1}', "{4: 1}", '{"RED": 2**40}']


@pytest.mark.parametrize("brought", NO_ENUMS)
def test_what_is_no_enum_is_refused(load: Load, brought: str) -> None:
    (fault,) = load(f"ENUMS = {brought}\n")
    assert (fault.code, fault.severity) == ("bad-enum", "error") and enums.plugin_enums() == {}


def test_two_plugins_must_mean_the_same_number(load: Load) -> None:
    assert load('ENUMS = {"RED": 0}\n') == () and load('ENUMS = {"RED": 0, "BLUE": 1}\n') == ()
    (fault,) = load('ENUMS = {"BLUE": 2}\n')
    assert fault.message == "ENUMS: BLUE is 1 in plugin_of_a_test_1 and 2 here"


@pytest.mark.parametrize("name", ["Say", "GoTo", "Sequence", "Script", "RecoveryNode"])
def test_a_leaf_cannot_take_the_name_of_a_node(load: Load, name: str) -> None:
    (fault,) = load(HEAD + LEAF.format(name=name))
    assert (fault.code, fault.severity, fault.found) == ("taken-name", "error", name)
    assert node_types()["Say"].make is Say and node_types()[name].is_ours, "the library's own stays"


def test_a_leaf_may_have_the_name_of_a_node_that_our_robots_lack(load: Load) -> None:
    lacking = next(name for name, node in node_types().items() if node.missing)
    assert load(HEAD + LEAF.format(name=lacking)) == ()
    assert node_types()[lacking].make is not None


def test_the_second_plugin_with_a_name_is_refused(load: Load) -> None:
    assert load(HEAD + LEAF.format(name="LeafOfATest")) == ()
    (fault,) = load(HEAD + LEAF.format(name="LeafOfATest"))
    assert fault.message == "leaf LeafOfATest of plugin_of_a_test_1 has the name of a node of plugin_of_a_test_0"


@pytest.mark.parametrize(("declared", "missing"), [("INPUT_PORTS", "OUTPUT_PORTS"), ("OUTPUT_PORTS", "INPUT_PORTS")])
def test_the_ports_that_are_not_declared_are_named(load: Load, declared: str, missing: str) -> None:
    (fault,) = load(f"{HEAD}class LeafOfATest(Leaf):\n    {declared} = {{}}\n    def update(self): return self.succeed()\n")
    assert fault.message == f"leaf LeafOfATest does not declare {missing}, so it is no node yet"
    assert fault.mend == f"add {missing} = {{}} to the class, or the ports it has"


def test_a_module_that_brings_nothing_is_a_warning(load: Load) -> None:
    (fault,) = load("x = 1\n")
    assert (fault.code, fault.severity) == ("no-nodes", "warning")
