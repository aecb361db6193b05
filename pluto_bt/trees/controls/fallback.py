"""Fallback, AsyncFallback: one child after the other until one succeeds."""

from __future__ import annotations

from pluto_bt.trees.controls.in_order import InOrder
from pluto_bt.trees.engine.status import FAILURE, SUCCESS


class Fallback(InOrder):
    """SUCCESS with the first child that succeeds, FAILURE when all have failed; SKIPPED if all were skipped."""

    PASSES_ON = KEEPS_PLACE = True
    GOES_ON, DECIDES = FAILURE, SUCCESS


class AsyncFallback(Fallback):
    """A Fallback that can be interrupted between children: it yields after each that started and failed in one tick."""

    YIELDS = True
