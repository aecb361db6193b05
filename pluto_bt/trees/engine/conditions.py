"""Pre- and post-conditions: the eight script attributes that any node may have.

Only nodes that have them pay: their `step` and `halt` are replaced on the instance.
Order of the pre-conditions: `_failureIf`, `_successIf`, `_skipIf` (only of an IDLE node), `_while` (also of a RUNNING one).
After SUCCESS `_onSuccess` and `_post` run, after FAILURE `_onFailure` and `_post`, on halt only `_onHalted`; SKIPPED runs none.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.script import ScriptRunner

PRE_CONDITIONS: Final[tuple[str, ...]] = ("_failureIf", "_successIf", "_skipIf", "_while")
POST_CONDITIONS: Final[tuple[str, ...]] = ("_onHalted", "_onFailure", "_onSuccess", "_post")
CONDITIONS: Final = PRE_CONDITIONS + POST_CONDITIONS


def guard(node: Any, scripts: Mapping[str, ScriptRunner], skip: Callable[[Any], Result]) -> None:
    """Give `node` its conditions. `skip(node)` notes that it was skipped and answers SKIPPED."""
    step: Callable[[], Result] = node.step
    halt: Callable[[], None] = node.halt
    pre = [(name, scripts[name]) for name in PRE_CONDITIONS if name in scripts]
    after: dict[Result, list[ScriptRunner]] = {
        SUCCESS: [scripts[name] for name in ("_onSuccess", "_post") if name in scripts],
        FAILURE: [scripts[name] for name in ("_onFailure", "_post") if name in scripts],
    }
    on_halted = scripts.get("_onHalted")

    def guarded_halt() -> None:
        halt()
        if on_halted is not None:
            on_halted.run(node)

    def guarded_step() -> Result:
        result = _forced(node, pre) if pre else None
        if result is SKIPPED:
            return skip(node)
        if result is None:
            result = step()
        for script in after.get(result, ()):
            script.run(node)
        if result is not SKIPPED:
            node.status = result
        return result

    node.step, node.halt = guarded_step, guarded_halt


def _forced(node: Any, pre: list[tuple[str, ScriptRunner]]) -> Result | None:
    """The answer that the pre-conditions force, or None; a RUNNING node whose `_while` turned false is halted."""
    if node.status is IDLE:
        return _forced_when_idle(node, pre)
    name, script = pre[-1]
    if node.status is RUNNING and name == "_while" and not script.is_true(node):
        node.halt()
        return SKIPPED
    return None


def _forced_when_idle(node: Any, pre: list[tuple[str, ScriptRunner]]) -> Result | None:
    answers: dict[str, Result] = {"_failureIf": FAILURE, "_successIf": SUCCESS, "_skipIf": SKIPPED}
    for name, script in pre:
        if script.is_true(node) is (name != "_while"):
            return answers.get(name, SKIPPED)
    return None
