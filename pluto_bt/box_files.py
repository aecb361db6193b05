"""What the black box says of a run before it begins: the request, and every file it is made of, so that it can be played anywhere."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

from pluto_bt import __version__
from pluto_bt.inputs.reading import Inputs
from pluto_bt.modules.robot_file import SHIPPED
from pluto_bt.record.entries import Run
from pluto_bt.resume import Resumption
from pluto_bt.run_options import RecordRequest
from pluto_bt.trees import Mission


def record_request(path: Path, inputs: Inputs, mission: Mission, is_realtime: bool, resumption: Resumption | None = None) -> RecordRequest:
    """What the recorder is given. Raises: OSError if a file of the run cannot be read any more."""
    files: dict[str, bytes] = {}
    main = _pack("mission", mission.origin.files, files)
    world = _pack("world", inputs.world.files, files)
    a_priori = "" if inputs.map is None else _pack("map", inputs.map.files, files)
    files["platform.toml"] = _platform_text(inputs.platform)
    hashes = {name: hashlib.sha256(data).hexdigest() for name, data in files.items()}
    hashes["parameters"] = hashlib.sha256(b"\n".join([files["platform.toml"], *(setting.encode() for setting in inputs.settings)])).hexdigest()
    run = Run(
        version=__version__, mode="threads" if is_realtime else "lockstep", mission=main, world=world, map=a_priori, platform=inputs.platform,
        seed=inputs.seed, start=inputs.start, tree=inputs.tree, ports=inputs.ports, settings=inputs.settings, plugins=inputs.plugins, hashes=hashes,
        resumed=resumption.past.state if resumption is not None and resumption.is_resumed else {},
    )  # fmt: skip
    return RecordRequest(path, run, files)


def _pack(folder: str, paths: Sequence[str], files: dict[str, bytes]) -> str:
    """Add files under `folder`, placed to one another as they are on disk; the name of the first."""
    full = [os.path.realpath(path) for path in paths]
    if not full:
        return ""
    common = os.path.commonpath([os.path.dirname(path) for path in full])
    names = [f"{folder}/{os.path.relpath(path, common)}" for path in full]
    for name, path in zip(names, full, strict=True):
        files[name] = Path(path).read_bytes()
    return names[0]


def _platform_text(name: str) -> bytes:
    return (resources.files("pluto_bt") / "platforms" / f"{name}.toml").read_bytes() if name in SHIPPED else Path(name).read_bytes()
