"""`pluto replay --step`: a recorded run by hand, forward and back."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from pluto_bt.source import PlutoError

if TYPE_CHECKING:
    from pluto_bt.record.box import Box

KEYS: Final = "Enter or n = next, p = back, +N and -N = so many ticks, at T = to a time (s), c = next change, q = leave"


def go_through(box: Box, at_s: float) -> None:
    """Show tick after tick from a time on; commands are read from the input, a line each."""
    from pluto_bt.commands.moment import moment

    number, is_asked = box.number_at(at_s), sys.stdin.isatty()
    if is_asked:
        print(KEYS)
    while True:
        print(moment(box, number))
        try:
            words = input("replay> " if is_asked else "").split()
        except EOFError:
            return
        if words[:1] in (["q"], ["quit"]):
            return
        try:
            number = min(max(_moved(words)(box, number), 0), len(box) - 1)
        except (PlutoError, ValueError, OverflowError):  # "at inf" is no time either
            print(KEYS, file=sys.stderr)
        print()


def _moved(words: list[str]) -> Callable[[Box, int], int]:
    """Where a line leads. Raises: ValueError if it means nothing."""
    if not words or words == ["n"]:
        return lambda box, number: number + 1
    if words == ["p"]:
        return lambda box, number: number - 1
    if words == ["c"]:
        return _next_change
    if words[0] == "at" and len(words) == 2:
        at_s = float(words[1])
        return lambda box, number: box.number_at(at_s)
    if len(words) == 1 and words[0][0] in "+-":
        count = int(words[0])
        return lambda box, number: number + count
    raise ValueError(words[0])


def _next_change(box: Box, number: int) -> int:
    from pluto_bt.record.story import changes

    return next((change.number for change in changes(box) if change.number > number), len(box) - 1)
