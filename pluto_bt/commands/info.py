"""`pluto info FILE`: what a black box holds."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pluto_bt.commands.options import Parser

if TYPE_CHECKING:
    from pluto_bt.record.box import Box


def main(argv: list[str]) -> int:
    """Print the facts."""
    parser = Parser(prog="pluto info", description="Tell what a black box holds.")
    parser.add_argument("file", metavar="FILE.mcap|FILE.log")
    parser.add_argument("--json", action="store_true", help="one JSON object")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_box

    box = read_box(args.file, needs_ticks=False)
    facts = facts_of(box)
    print(json.dumps(facts) if args.json else "\n".join(_lines(facts)))
    return 0


def facts_of(box: Box) -> dict[str, Any]:
    """Everything worth telling, as JSON knows it."""
    run, counts, sizes = box.run, Counter[str](), Counter[str]()
    for line in box.file.lines():
        counts[line.topic] += 1
        sizes[line.topic] += len(line.data)
    times_ns = box.times_ns or [line.time_ns for line in box.file.lines()] or [0]
    first_s, last_s = times_ns[0] / 1e9, times_ns[-1] / 1e9
    return {
        "file": box.file.shown, "bytes": Path(box.file.shown).stat().st_size, "is_whole": box.file.is_whole,
        "is_damaged": box.file.is_damaged, "version": run.version, "mode": run.mode,
        "mission": run.mission, "world": run.world, "map": run.map, "platform": run.platform, "seed": run.seed, "start": list(run.start),
        "tree": run.tree, "ports": run.ports, "settings": list(run.settings), "plugins": list(run.plugins), "ticks": len(box), "from_s": first_s,
        "to_s": last_s, "is_from_start": box.is_from_start, "result": box.result.get("result", ""), "reason": box.result.get("reason", ""),
        "trace_sha256": box.result.get("trace_sha256", ""), "hashes": run.hashes,
        "topics": {name: {"messages": count, "bytes": sizes[name]} for name, count in sorted(counts.items())},
        "files": {name: len(attachment.data) for name, attachment in sorted(box.file.attachments.items())},
    }  # fmt: skip


def _lines(facts: dict[str, Any]) -> list[str]:
    cut = "" if facts["is_whole"] else f", {'damaged' if facts['is_damaged'] else 'cut short'} (`pluto repair` makes it whole)"
    old = "" if facts["is_from_start"] else f", the first ticks {'are lost' if facts['is_damaged'] else 'were dropped for want of room'}"
    outcome = facts["result"] + (f" ({facts['reason']})" if facts["reason"] else "") or "not known: the run did not come to its end"
    ports = " ".join(f"{name}={value}" for name, value in facts["ports"].items())
    if facts["mode"] == "watched":
        heard = f"  from outside, {facts['mission'] or 'no mission'}, {facts['from_s']:.1f} s to {facts['to_s']:.1f} s"
        return [f"{facts['file']}: {facts['bytes'] / 1e6:.2f} MB{cut}", heard, *_topic_lines(facts)]
    lines = [
        f"{facts['file']}: {facts['bytes'] / 1e6:.2f} MB{cut}",
        f"  run       {facts['mission']} in {facts['world']} with {facts['platform']}, seed {facts['seed']}, {facts['mode']}",
        f"  ticks     {facts['ticks']}, {facts['from_s']:.1f} s to {facts['to_s']:.1f} s{old}",
        f"  outcome   {outcome}",
    ]
    lines += [f"  ports     {ports}"] if ports else []
    lines += [f"  settings  {' '.join(facts['settings'])}"] if facts["settings"] else []
    lines += [f"  {name:<36} {digest[:16]}…" for name, digest in facts["hashes"].items()]
    return lines + _topic_lines(facts)


def _topic_lines(facts: dict[str, Any]) -> list[str]:
    return [f"  {name:<36} {one['messages']:>8} messages {one['bytes'] / 1e3:>10.1f} kB" for name, one in facts["topics"].items()]
