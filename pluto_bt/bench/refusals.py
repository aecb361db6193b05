"""What broken input costs until it is refused: wall time and peak memory of `pluto run` on the worst files that we know."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from pluto_bt.bench.row import BenchRow
from pluto_bt.runtime.clock import wall_ns

REPEATS = 3
HEAD = '<root BTCPP_format="4" main_tree_to_execute="T0">'


def run() -> list[BenchRow]:
    """Best of a few starts each, the largest memory."""
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for title, command in _cases(Path(name)):
            taken = [_refuse(command) for _ in range(REPEATS)]
            seconds, mebibytes = min(pair[0] for pair in taken), max(pair[1] for pair in taken)
            rows += [BenchRow(f"{title}: time", seconds, "s", "<= 1"), BenchRow(f"{title}: memory", mebibytes, "MiB", "<= 286", "300 MB")]
    return rows


def _refuse(command: list[str]) -> tuple[float, float]:
    """(wall seconds, peak MiB) of one refused run."""
    begun_ns = wall_ns()
    child = subprocess.Popen([sys.executable, "-m", "pluto_bt", "run", *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 2:
        raise RuntimeError(f"exit {child.returncode} of pluto run {' '.join(command)}")
    return (wall_ns() - begun_ns) / 1e9, usage.ru_maxrss / 1024


def _cases(folder: Path) -> Iterator[tuple[str, list[str]]]:
    """(what it is, the arguments of `pluto run`)."""
    for title, text in _missions():
        path = folder / "mission.xml"
        path.write_text(text, encoding="utf-8")
        yield title, [str(path)]
    (folder / "map.png").write_bytes(_cut_off_png(7900))
    (folder / "map.yaml").write_text("image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\n", encoding="utf-8")
    yield "62 million pixels, cut off", ["t01_say_hello.xml", "--world", str(folder / "map.yaml")]


def _missions() -> Iterator[tuple[str, str]]:
    yield "unknown node", f'{HEAD}<BehaviorTree ID="T0"><Foo/></BehaviorTree></root>'
    yield "100 000 nodes", f'{HEAD}<BehaviorTree ID="T0"><Sequence>' + '<Say text="x"/>\n' * 100_000 + "</Sequence></BehaviorTree></root>"
    yield "10^8 nodes by SubTrees", HEAD + "".join(map(_tens, range(8))) + '<BehaviorTree ID="T8"><AlwaysSuccess/></BehaviorTree></root>'
    yield "40 000 unknown nodes", f'{HEAD}<BehaviorTree ID="T0"><Sequence>' + "<Foo/>" * 40_000 + "</Sequence></BehaviorTree></root>"
    yield "a value of 15 MiB", f'{HEAD}<BehaviorTree ID="T0"><GoTo goal="{"1;" * (15 << 19)}"/></BehaviorTree></root>'
    yield "an entity bomb", '<!DOCTYPE a [<!ENTITY b "b"><!ENTITY c "&b;&b;&b;">]><root>&c;</root>'


def _tens(i: int) -> str:
    """A tree that holds the next one ten times."""
    inside = f'<SubTree ID="T{i + 1}"/>' * 10
    return f'<BehaviorTree ID="T{i}"><Sequence>{inside}</Sequence></BehaviorTree>'


def _cut_off_png(side: int) -> bytes:
    """A white grey picture whose pixels end a little too early."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer = zlib.compressobj(1)
    row = b"\0" + b"\xfe" * side
    pixels = b"".join(packer.compress(row) for _ in range(side)) + packer.flush()
    head = struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", pixels[:-100]) + chunk(b"IEND", b"")
