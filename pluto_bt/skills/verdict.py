"""What a link says of its command: a code, a reason in one word, a sentence."""

from __future__ import annotations

from typing import NamedTuple

from pluto_bt.blackboard.codes import LinkStatus


class Verdict(NamedTuple):
    """`code` is `element[0]` of the link's status."""

    code: LinkStatus = LinkStatus.NORMAL
    reason: str = ""
    text: str = ""


ALL_WELL = Verdict()


def kept(before: Verdict, now: Verdict) -> Verdict:
    """`now`, or `before` where both say the same: a text is written once when a state begins, not anew with each figure."""
    return before if before[:2] == now[:2] else now
