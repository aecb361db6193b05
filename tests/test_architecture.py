"""The floors of DESIGN.md, section 2: a file imports only from its own floor or below. Read from the imports themselves."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
OURS = ("pluto_bt", "drivers", "estimation", "sim")

# What a package may import of the project, besides itself. Everything not listed here is forbidden.
MAY = {
    "pluto_bt.source": (),
    "pluto_bt.maps": ("pluto_bt.source",),
    "pluto_bt.blackboard": ("pluto_bt.source",),
    "pluto_bt.runtime": ("pluto_bt.source",),
    "pluto_bt.record": ("pluto_bt.source", "pluto_bt.blackboard", "pluto_bt.runtime"),
    "drivers": (),
    "estimation": ("pluto_bt.maps",),
    "sim": ("pluto_bt.maps", "pluto_bt.source", "drivers"),
    "pluto_bt.skills": ("pluto_bt.source", "pluto_bt.maps", "pluto_bt.blackboard", "pluto_bt.runtime", "estimation"),
    "pluto_bt.gateway": ("pluto_bt.source", "pluto_bt.blackboard", "pluto_bt.runtime"),
    "pluto_bt.behaviours": ("pluto_bt.source", "pluto_bt.maps", "pluto_bt.blackboard", "pluto_bt.runtime", "pluto_bt.skills", "estimation"),
    "pluto_bt.trees": ("pluto_bt.source", "pluto_bt.maps", "pluto_bt.blackboard", "pluto_bt.runtime", "pluto_bt.record", "pluto_bt.skills",
                       "pluto_bt.behaviours", "estimation"),
    "pluto_bt.groot": ("pluto_bt.source", "pluto_bt.behaviours", "pluto_bt.trees"),
}  # fmt: skip
# … and every file directly in pluto_bt/
TOP_FLOOR = ("pluto_bt.modules", "pluto_bt.inputs", "pluto_bt.commands", "pluto_bt.bench", "pluto_bt.platforms")


def package_of(name: str) -> str:
    """`pluto_bt.maps.world` belongs to `pluto_bt.maps`, `sim.simulator` to `sim`."""
    parts = name.split(".")
    return ".".join(parts[:2]) if parts[0] == "pluto_bt" else parts[0]


def imports_of(path: Path) -> set[str]:
    """Every module of the project that a file imports, at the top or inside a function."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{path}: relative import"
            found |= {f"{node.module}.{alias.name}" for alias in node.names} if node.module == "pluto_bt" else {node.module}
    return {name for name in found if name.split(".")[0] in OURS}


FILES = sorted(path for package in OURS for path in (ROOT / package).rglob("*.py"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_file_imports_only_from_its_own_floor_or_below(path: Path) -> None:
    module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    package = package_of(module)
    if package in TOP_FLOOR or path.parent == ROOT / "pluto_bt":
        return
    assert package in MAY, f"{package} stands on no floor: add it to DESIGN and to this table"
    allowed = (*MAY[package], package)
    wrong = sorted(name for name in imports_of(path) if package_of(name) not in allowed and name != "pluto_bt.__version__")
    assert not wrong, f"{module} must not import {', '.join(wrong)}"


# Of the top floor: package → who may use it
USED_BY = {
    "pluto_bt.commands": ("pluto_bt.commands", "pluto_bt.cli"),
    "pluto_bt.bench": ("pluto_bt.bench", "pluto_bt.commands"),
    "pluto_bt.inputs": ("pluto_bt.inputs", "pluto_bt.commands", "pluto_bt.bench", "pluto_bt.runner", "pluto_bt.scenario", "pluto_bt.resume",
                        "pluto_bt.box_files", "pluto_bt.playback", "pluto_bt.contract_report"),
}  # fmt: skip


@pytest.mark.parametrize("package", USED_BY)
def test_the_top_floor_has_an_order_too(package: str) -> None:
    modules = {path: ".".join(path.relative_to(ROOT).with_suffix("").parts) for path in FILES}
    users = {package_of(module) for path, module in modules.items() if package in {package_of(name) for name in imports_of(path)}}
    assert sorted(users - set(USED_BY[package])) == []


def test_every_package_is_described_in_the_architecture_page() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    folders = sorted({package_of(".".join(path.relative_to(ROOT).with_suffix("").parts)) for path in FILES if path.parent != ROOT / "pluto_bt"})
    missing = [folder for folder in folders if folder.replace(".", "/") + "/" not in text]
    assert not missing, f"docs/architecture.md says nothing of {missing}"
