"""Names that scripts and the cases of Switch read as whole numbers, brought by plugins: `ENUMS = {"RED": 0, "GREEN": 1}` in the module.

Like the node types of a plugin they are known in the whole process from its import on; what `load_mission` is given stands above them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import ModuleType
from typing import Any, Final

from pluto_bt.trees.values import INT32

ATTRIBUTE: Final = "ENUMS"
_NAME = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")
_known: dict[str, tuple[int, str]] = {}  # name → (number, the module that brought it)


def plugin_enums() -> dict[str, int]:
    """All that the plugins imported so far have brought."""
    return {name: number for name, (number, _) in _known.items()}


def learn_enums(module: ModuleType) -> list[str]:
    """Take over what a module brings; if something is wrong nothing, and a sentence for each entry that is."""
    brought: Any = getattr(module, ATTRIBUTE, {})
    if not isinstance(brought, Mapping):
        return [f'{ATTRIBUTE} is a {type(brought).__name__}, not a dict such as {{"RED": 0, "GREEN": 1}}']
    problems = [problem for name, number in brought.items() if (problem := _problem(name, number, module.__name__))]
    if not problems:
        _known.update({name: (int(number), module.__name__) for name, number in brought.items()})
    return problems


def _problem(name: Any, number: Any, module: str) -> str:
    """Why a name cannot mean this number, or ""."""
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name in ("true", "false"):
        return f"{ATTRIBUTE}: {name!r} is no name that a script can read: a letter first, then letters, digits and _"
    if not isinstance(number, int) or isinstance(number, bool) or not INT32[0] <= number <= INT32[1]:
        return f"{ATTRIBUTE}: {name} = {number!r} is no whole number of 32 bits"
    known, owner = _known.get(name, (number, module))
    return "" if known == number else f"{ATTRIBUTE}: {name} is {known} in {owner} and {number} here"
