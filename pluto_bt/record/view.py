"""A moment of a black box as text: the trees with their statuses, the blackboard, the commands."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import msgspec

from pluto_bt.record.box import Box, Now, TreeNow

MARKS = {"IDLE": "·", "RUNNING": "●", "SUCCESS": "✓", "FAILURE": "✗", "SKIPPED": "»"}
LONGEST = 96  # characters of a feedback or a value


def moment(box: Box, now: Now) -> list[str]:
    """The whole of one tick."""
    tick = now.tick
    pose = "" if tick.pose is None else f"   pose {tick.pose[0]:.2f}, {tick.pose[1]:.2f}, {tick.pose[2] * 57.29577951308232:.0f}°"
    lines = [f"tick {now.number + 1} of {len(box)}   {tick.t_s:.2f} s{pose}"]
    if now.paused:
        lines.append(f"paused: {now.paused}")
    lines += [f"order: {verb} {text}".rstrip() for verb, _, text in tick.orders]
    for tree in now.at_work():
        lines += ["", f"{tree.tree.role} {tree.tree.name}, its tick {tree.tick}{_end(tree)}", *_tree(tree, tick.t_ns)]
        lines += [f"  {{{key}}} = {_short(value)}" for key, value in sorted(tree.board.items())]
    lines += [f"command to {one.to}: flags {one.flags}, position {_numbers(one.position)}, velocity {_numbers(one.velocity)}"
              + (f" (refused: {one.refused})" if one.refused else "") for one in tick.commands]  # fmt: skip
    return lines


def _tree(tree: TreeNow, now_ns: int) -> Iterator[str]:
    for row, status, feedback, since_ns in tree.rows():
        title = row.kind if row.name == row.kind else f"{row.kind} “{row.name}”"
        words = f" – {_short(feedback)}" if feedback else ""
        since = "" if status == "IDLE" else f" since {(now_ns - since_ns) / 1e9:.1f} s"
        yield f"{'   ' * (row.depth - 1)}{MARKS[status]} {title}  {'' if status == 'IDLE' else status}{since}{words}".rstrip()


def _end(tree: TreeNow) -> str:
    return "" if tree.state == "running" else f": {tree.state}" + (f" ({tree.reason})" if tree.reason else "")


def _short(value: Any) -> str:
    text = " ".join((value if isinstance(value, str) else msgspec.json.encode(value).decode()).split())
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.2f}" for value in values)
