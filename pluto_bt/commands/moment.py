"""A moment of a black box as text: the tree as `pluto tree` draws it, the blackboard, orders and commands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import msgspec

from pluto_bt.commands.tree_now import form_of_terminal, of_box
from pluto_bt.record.box import Box, Now, TreeNow
from pluto_bt.record.entries import Posted
from pluto_bt.trees.dump import draw
from pluto_bt.trees.dump.text import one_line

LONGEST: Final = 96  # characters of a value


def moment(box: Box, number: int) -> str:
    """The whole of one tick."""
    now, root = box.now(number), of_box(box, number)
    lines = [_head(box, now)]
    if now.paused:
        lines.append(f"paused: {now.paused}")
    lines += [f"order: {verb} {text}".rstrip() for verb, _, text in now.tick.orders]
    lines += [f"{tree.tree.role} {tree.tree.name}, its tick {tree.tick}{_end(tree)}" for tree in now.at_work()]
    lines += ["", draw(root, form_of_terminal())] if root is not None else []
    lines += [f"{{{key}}} = {_value(value)}" for tree in now.at_work() for key, value in sorted(tree.board.items())]
    return "\n".join([*lines, *map(_command, now.tick.commands)])


def _head(box: Box, now: Now) -> str:
    pose = now.tick.pose
    where = "" if pose is None else f"   pose {pose[0]:.2f}, {pose[1]:.2f}, {math.degrees(pose[2]):.0f}°"
    return f"tick {now.number + 1} of {len(box)}   {now.tick.t_s:.2f} s{where}"


def _end(tree: TreeNow) -> str:
    return "" if tree.state == "running" else f": {tree.state}" + (f" ({tree.reason})" if tree.reason else "")


def _command(posted: Posted) -> str:
    refused = f" (refused: {posted.refused})" if posted.refused else ""
    return f"command to {posted.to}: flags {posted.flags}, position {_numbers(posted.position)}, velocity {_numbers(posted.velocity)}{refused}"


def _value(value: Any) -> str:
    return one_line(value if isinstance(value, str) else msgspec.json.encode(value).decode(), LONGEST)


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.2f}" for value in values)
