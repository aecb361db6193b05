"""Binds a py_trees leaf to the engine: gives the instance `step()` and `halt()` with the life cycle that missions promise.

`initialise` unless it is RUNNING, `update`, then `terminate(new)` while `status` is still the old one if the work has ended.
`update()` returning INVALID means SKIPPED; None, another value or an exception ends the tick with an error. But a leaf of the library whose
required input has no value, because nothing wrote its entry on this way, fails with the reason `no-input`.
A leaf that overrides `tick` itself is ticked by its own `tick_once()`.
"""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.ports import NoDataAvailable

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result, Skip
from pluto_bt.trees.errors import RAISED, PortMisfit, StepError


def bind_leaf(leaf: Any, context: Context) -> None:
    """Give the instance what the engine calls: `step`, `halt`, `last`."""
    leaf.last = IDLE
    foreign = type(leaf).tick is not Behaviour.tick
    leaf.step = _foreign_step(leaf, context) if foreign else _own_step(leaf, context)
    leaf.halt = _halt(leaf)


def _own_step(leaf: Any, context: Context) -> Callable[[], Result]:
    """The step of a leaf; those that have neither `initialise` nor `terminate` do not pay for them."""
    # not by looking into `__dict__`: that alone makes every later look-up on the leaf slower
    has_start = getattr(leaf.initialise, "__func__", None) is not Behaviour.initialise
    has_end = getattr(leaf.terminate, "__func__", None) is not Behaviour.terminate
    return _full_step(leaf, context) if has_start or has_end else _plain_step(leaf, context)


def _plain_step(leaf: Any, context: Context) -> Callable[[], Result]:
    update = leaf.update

    def step() -> Result:
        context.current = leaf
        try:
            new: Status = update()
        except RAISED as error:
            return _without_input(leaf, error)
        if new is SUCCESS or new is FAILURE or new is RUNNING:
            leaf.status = new
            return new
        return _no_status(leaf, context, new)

    return step


def _full_step(leaf: Any, context: Context) -> Callable[[], Result]:
    update, initialise, terminate = leaf.update, leaf.initialise, leaf.terminate

    def step() -> Result:
        context.current = leaf
        try:
            if leaf.status is not RUNNING:
                initialise()
            new: Status = update()
            if new is SUCCESS or new is FAILURE:
                terminate(new)
                leaf.status = new
                return new
        except RAISED as error:
            return _without_input(leaf, error)
        if new is RUNNING:
            leaf.status = new
            return new
        return _no_status(leaf, context, new)

    return step


def _no_status(leaf: Any, context: Context, answer: object) -> Skip:
    """INVALID is SKIPPED; everything else breaks the promise."""
    if answer is IDLE:
        return _skipped(leaf, context)
    raise StepError(leaf, f"update() returned {answer!r}, which is no status")


def _without_input(leaf: Any, error: BaseException) -> Status:
    """FAILURE of a leaf of ours that lacks an input. Raises: StepError for every other error, and of other people's leaves."""
    if not (isinstance(error, NoDataAvailable) and isinstance(leaf, Leaf)):
        raise _blamed(leaf, error) from error
    leaf.fail("no-input", str(error))
    try:
        leaf.terminate(FAILURE)
    except RAISED as another:
        raise _blamed(leaf, another) from another
    leaf.status = FAILURE
    return FAILURE


def _blamed(leaf: Any, error: BaseException) -> StepError:
    return error if isinstance(error, StepError) else StepError(leaf, told(error))


def _foreign_step(leaf: Any, context: Context) -> Callable[[], Result]:
    def step() -> Result:
        context.current = leaf
        try:
            leaf.tick_once()
        except RAISED as error:
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
            except RAISED as error:
                raise StepError(leaf, told(error)) from error
            finally:
                leaf.status = IDLE

    return halt


def told(error: BaseException) -> str:
    """An exception in one line, with the place in the leaf's own file where it was raised; of a port's value only what is wrong with it."""
    if isinstance(error, (PortMisfit, NoDataAvailable)):
        return str(error)
    what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    places = [frame for frame in traceback.extract_tb(error.__traceback__) if "/pluto_bt/trees/" not in frame.filename.replace(os.sep, "/")]
    return f"{what} ({os.path.basename(places[-1].filename)}:{places[-1].lineno})" if places else what
