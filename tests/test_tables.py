"""The two tables of the project, topics and modules, agree with each other and with the code that they name."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import msgspec
import pytest

from pluto_bt.blackboard import TOPICS
from pluto_bt.blackboard.topics import LATER_WRITERS
from pluto_bt.maps.platform import Platform
from pluto_bt.modules.robot_file import RobotFile
from pluto_bt.modules.topic_globals import TopicGlobals, fields_of
from pluto_bt.runtime.table import Module, in_start_order
from pluto_bt.source import PlutoError
from pluto_bt.system import INBOXES, MODULES

TOPIC_NAMES = [topic.name for topic in TOPICS]
MODULE_NAMES = [module.name for module in MODULES]


def test_names_are_unique() -> None:
    assert len(set(TOPIC_NAMES)) == len(TOPIC_NAMES)
    assert len(set(MODULE_NAMES)) == len(MODULE_NAMES)


def test_each_topic_is_written_by_a_module() -> None:
    assert [topic.name for topic in TOPICS if topic.writer not in (*MODULE_NAMES, *LATER_WRITERS)] == []
    assert not set(LATER_WRITERS) & set(MODULE_NAMES), "a module that has come is no later writer"


def test_each_topic_says_what_it_is_and_its_times_fit_together() -> None:
    assert [topic.name for topic in TOPICS if not topic.doc] == []
    assert [topic.name for topic in TOPICS if 0.0 < topic.stale_after_s < 2.0 * topic.period_s] == [], "one late value is no stale one"


def test_no_two_names_for_scripts_are_alike() -> None:
    names = list(TopicGlobals().names())
    assert len(names) == sum(1 + len(fields_of(topic.type)) for topic in TOPICS), "one name hides another"
    assert [name for name in names if name not in TOPIC_NAMES and not name.isidentifier()] == []


@pytest.mark.parametrize("module", MODULES, ids=MODULE_NAMES)
def test_a_module_can_be_loaded_and_knows_what_it_needs(module: Module) -> None:
    factory = module.load()
    assert all(callable(getattr(factory, name)) for name in ("start", "step", "stop"))
    assert [need for need in module.needs if need not in MODULE_NAMES] == []
    sources = [source.removeprefix("inbox:") for source in module.wakes]
    assert [name for name in sources if name not in (*TOPIC_NAMES, *INBOXES)] == []
    assert module.period_s > 0.0 or module.wakes, "else it never steps"


def test_no_module_is_woken_by_a_topic_that_it_writes_itself() -> None:
    writers = {topic.name: topic.writer for topic in TOPICS}
    assert [module.name for module in MODULES if module.name in map(writers.get, module.wakes)] == []


def test_each_link_above_is_a_link() -> None:
    assert [above for above in INBOXES.values() if above and above not in INBOXES] == []


def test_a_module_starts_after_all_that_it_needs() -> None:
    order = [module.name for module in in_start_order(MODULES)]
    assert sorted(order) == sorted(MODULE_NAMES)
    assert [(module.name, need) for module in MODULES for need in module.needs if order.index(need) > order.index(module.name)] == []


def test_modules_that_need_each_other_are_refused() -> None:
    circle = (Module("a", "x:A", 1.0, "io", needs=("b",)), Module("b", "x:B", 1.0, "io", needs=("a",)))
    with pytest.raises(PlutoError, match="modules need each other: a -> b -> a"):
        in_start_order(circle)


@cache
def read_anywhere() -> frozenset[str]:
    """Every attribute that the code of the package asks for."""
    package = Path(__file__).parent.parent / "pluto_bt"
    return frozenset(name for path in package.rglob("*.py") for name in re.findall(r"\.(\w+)", path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("table", sorted(set(RobotFile.__struct_fields__) - set(Platform.__struct_fields__)))
def test_each_parameter_of_a_module_is_read_by_somebody(table: str) -> None:
    kind = next(field.type for field in msgspec.structs.fields(RobotFile) if field.name == table)
    assert [name for name in kind.__struct_fields__ if name not in read_anywhere()] == []
