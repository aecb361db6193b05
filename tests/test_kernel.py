"""Kernels are compiled late, link to each other across modules, and are compiled anew when what they call has changed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pluto_bt.maps.kernel import inline_kernel, kernel


@inline_kernel
def twice(x: float) -> float:
    return 2.0 * x


@kernel
def twice_and_one(x: float, one: float = 1.0) -> float:
    """Says what it does."""
    return twice(x) + one


@kernel
def reciprocal(x: float) -> float:
    return 1.0 / x


def test_a_kernel_calls_kernels_and_keeps_its_defaults_and_name():
    assert twice_and_one(3.0) == 7.0
    assert twice_and_one(3.0, one=5.0) == 11.0
    assert (twice_and_one.__name__, twice_and_one.__doc__) == ("twice_and_one", "Says what it does.")


def test_the_compiled_function_is_made_once():
    assert twice_and_one.compiled() is twice_and_one.compiled()
    assert twice_and_one.compiled()(1.0) == 3.0


def test_division_by_zero_follows_numpy():
    assert reciprocal(0.0) == float("inf")


def python(folder: Path, code: str) -> str:
    root = Path(__file__).resolve().parents[1]
    environment = os.environ | {"PYTHONPATH": f"{root}{os.pathsep}{folder}", "NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def test_reading_a_module_of_kernels_does_not_import_numba(tmp_path):
    (tmp_path / "late.py").write_text("from pluto_bt.maps.kernel import kernel\n@kernel\ndef f(x):\n    return x\n")
    assert python(tmp_path, "import sys, late; print('numba' in sys.modules)") == "False"


def test_a_change_in_a_called_module_is_noticed_by_the_cache(tmp_path):
    head = "from pluto_bt.maps.kernel import kernel\n"
    (tmp_path / "upper.py").write_text(head + "from lower import low\n@kernel\ndef up(x):\n    return low(x) + 1\n")
    ask = "from upper import up; up(1); print(up(1), sum(up.compiled().stats.cache_hits.values()))"
    (tmp_path / "lower.py").write_text(head + "@kernel\ndef low(x):\n    return 10\n")
    assert python(tmp_path, ask) == "11 0"
    assert python(tmp_path, ask) == "11 1"
    (tmp_path / "lower.py").write_text(head + "@kernel\ndef low(x):\n    return 200\n")
    assert python(tmp_path, ask) == "201 0"


def test_compilation_is_told_once_and_not_where_the_cache_has_it(tmp_path):
    head = "from pluto_bt.maps.kernel import kernel\n"
    (tmp_path / "cold.py").write_text(head + "@kernel\ndef f(x):\n    return x + 1\n@kernel\ndef g(x):\n    return f(x)\n")
    imports = "from pluto_bt.maps.kernel import telling_of_compilation as telling\nfrom cold import f, g\n"
    ask = imports + "with telling(lambda: print('cold')):\n    print(f(1), g(1))"
    assert python(tmp_path, ask) == "cold\n2 2"
    assert python(tmp_path, ask) == "2 2"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_kernel_works_where_nothing_can_be_written(tmp_path):
    (tmp_path / "lonely.py").write_text("from pluto_bt.maps.kernel import kernel\n@kernel\ndef f(x):\n    return x + 1\n")
    (tmp_path / "cache").touch(mode=0o400)
    assert python(tmp_path, "from lonely import f; print(f(1))") == "2"
