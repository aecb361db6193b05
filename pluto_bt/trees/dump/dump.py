"""`dump`: one function for all formats."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from pluto_bt.trees.dump.dot import dot
from pluto_bt.trees.dump.groot import groot
from pluto_bt.trees.dump.model import Drawn, drawn
from pluto_bt.trees.dump.svg import svg
from pluto_bt.trees.dump.text import ascii_tree, unicode_tree
from pluto_bt.trees.dump.xhtml import xhtml
from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.mission import Mission

_PICTURES: Final[dict[str, Callable[[Drawn], str]]] = {"ascii": ascii_tree, "unicode": unicode_tree, "dot": dot, "svg": svg, "xhtml": xhtml}
PICTURES: Final = tuple(_PICTURES)
FORMATS: Final = (*PICTURES, "xml")


def dump(what: Mission | Plan, form: str = "unicode", *, statuses: bool = True) -> str:
    """The tree as text in one of `FORMATS`; of a Mission with the statuses of its last tick, unless `statuses` is False.

    `xml` is the mission as one file that Groot2 opens. Raises ValueError for an unknown format.
    """
    if form not in FORMATS:
        raise ValueError(f"unknown format {form!r}; one of: {', '.join(FORMATS)}")
    tracked = what.nodes() if isinstance(what, Mission) else []
    plan = what if isinstance(what, Plan) else tracked[0].plan
    if form == "xml":
        return groot(plan)
    states = dict(zip((one.plan.uid for one in tracked), what.node_states(), strict=True)) if statuses and isinstance(what, Mission) else None
    return draw(drawn(plan, states, what.now_s() if isinstance(what, Mission) else 0.0), form)


def draw(root: Drawn, form: str) -> str:
    """A tree that is drawn already, in one of `PICTURES`."""
    return _PICTURES[form](root)
