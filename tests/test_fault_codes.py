"""Every code that a mission's faults can have stands in docs/checking.md."""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TREES = ROOT / "pluto_bt/trees"
SOURCES = [*(TREES / "loader").glob("*.py"), *(TREES / "checks").glob("*.py"), ROOT / "pluto_bt/inputs/legs_in_world.py"]
NOT_OF_THE_FILE = {"leaf-failed", "setup-failed"}  # a leaf's own code failed: docs/leaves.md
TELLS = {"error", "warning", "late", "tell", "report", "_error"}


def codes_in(path: Path) -> set[str]:
    """The second argument of every call that tells a fault."""
    calls = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call) and len(node.args) > 1]
    named = [(call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", ""), call.args[1]) for call in calls]
    return {code.value for name, code in named if name in TELLS and isinstance(code, ast.Constant) and isinstance(code.value, str)}


def test_every_code_of_a_mission_is_documented() -> None:
    text = (ROOT / "docs/checking.md").read_text(encoding="utf-8")
    documented = set(re.findall(r"`([a-z]+(?:-[a-z]+)*)`", text))
    found = {code for path in SOURCES for code in codes_in(path)} | {"goal-blocked", "unset-key", "unknown-topic"}
    assert len(found) > 40
    assert sorted(found - documented - NOT_OF_THE_FILE) == []
