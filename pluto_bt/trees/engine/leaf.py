"""Binds a py_trees leaf to the engine: gives the instance `step()` and `halt()` with the life cycle that missions promise.

`initialise` unless it is RUNNING, `update`, then `terminate(new)` while `status` is still the old one if the work has ended.
`update()` returning INVALID means SKIPPED; None, another value or an exception ends the tick with an error.
A leaf that overrides `tick` itself is ticked by its own `tick_once()`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.errors import StepError
from pluto_bt.trees.engine.status import IDLE, RUNNING, SKIPPED, SUCCESS, Result, Skip


def bind_leaf(leaf: Any, context: Context) -> None:
    """Give the instance what the engine calls: `step`, `halt`, `last`."""
    leaf.last = IDLE
    foreign = type(leaf).tick is not Behaviour.tick
    leaf.step = _foreign_step(leaf, context) if foreign else _own_step(leaf, context)
    leaf.halt = _halt(leaf)


def _own_step(leaf: Any, context: Context) -> Callable[[], Result]:
    update, initialise, terminate = leaf.update, leaf.initialise, leaf.terminate
    has_start = type(leaf).initialise is not Behaviour.initialise or "initialise" in leaf.__dict__
    has_end = type(leaf).terminate is not Behaviour.terminate or "terminate" in leaf.__dict__

    def step() -> Result:
        context.current = leaf
        try:
            if has_start and leaf.status is not RUNNING:
                initialise()
            new: Status = update()
            if new is SUCCESS or new is Status.FAILURE:
                if has_end:
                    terminate(new)
                leaf.status = new
                return new
        except StepError:
            raise
        except Exception as error:
            raise StepError(leaf, told(error)) from error
        if new is RUNNING:
            leaf.status = new
            return new
        if new is IDLE:
            return _skipped(leaf, context)
        raise StepError(leaf, f"update() returned {new!r}, which is no status")

    return step


def _foreign_step(leaf: Any, context: Context) -> Callable[[], Result]:
    def step() -> Result:
        context.current = leaf
        try:
            leaf.tick_once()
        except Exception as error:
            raise StepError(leaf, told(error)) from error
        status: Status = leaf.status
        if status is IDLE:
            return _skipped(leaf, context)
        if not isinstance(status, Status):
            raise StepError(leaf, f"its tick left status {status!r}, which is no status")
        return status

    return step


def _skipped(leaf: Any, context: Context) -> Skip:
    leaf.last = SKIPPED
    context.skipped.append(leaf)
    return SKIPPED


def _halt(leaf: Any) -> Callable[[], None]:
    def halt() -> None:
        if leaf.status is RUNNING:
            try:
                if type(leaf).stop is Behaviour.stop:
                    leaf.terminate(IDLE)
                else:
                    leaf.stop(IDLE)
            except Exception as error:
                raise StepError(leaf, told(error)) from error
            finally:
                leaf.status = IDLE

    return halt


def told(error: Exception) -> str:
    """An exception in one line."""
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
