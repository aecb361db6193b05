"""The shared yardsticks that ratios are taken against; they lie beside the repository, or where PLUTO_SHARED says, and may be absent."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
from typing import Any


def load_baseline(name: str) -> Any:
    """The module `bench/NAME.py` of the folder `shared`; None where it is absent."""
    shared = Path(os.environ.get("PLUTO_SHARED") or Path(__file__).resolve().parents[2].parent / "shared")
    file = shared / "bench" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, file) if file.is_file() else None
    if spec is None or spec.loader is None:
        return None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
