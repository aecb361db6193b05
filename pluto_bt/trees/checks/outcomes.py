"""How a node can end: with S(UCCESS), F(AILURE), K (skipped); an empty set is a node that never ends.

A node of which nothing is known can end in any way, so what is missing from a set is certain. Worked out from the leaves up, each node
from what its children can do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from pluto_bt.trees.loader.expand import Plan
from pluto_bt.trees.script import ScriptSyntaxError, parse_script
from pluto_bt.trees.script.names import names_used
from pluto_bt.trees.script.terms import Env
from pluto_bt.trees.script.values import ScriptError, truth
from pluto_bt.trees.values import parse_int

Ends = frozenset[str]
ANY: Final[Ends] = frozenset("SFK")
S, F, K = (frozenset(letter) for letter in "SFK")
EITHER: Final = S | F
NEVER: Final[Ends] = frozenset()
ANSWERS: Final = {"SUCCESS": S, "FAILURE": F, "SKIPPED": K}
SWAPPED: Final = {"S": "F", "F": "S", "K": "K"}
LEAVES: Final = {"AlwaysSuccess": S, "AlwaysFailure": F, "Script": S, "Sleep": S, "UnsetBlackboard": S, "ScriptCondition": EITHER,
                 "WasEntryUpdated": EITHER}  # fmt: skip
_ON_SUCCESS: Final = ("Sequence", "AsyncSequence", "SequenceWithMemory", "ReactiveSequence")
_ON_FAILURE: Final = ("Fallback", "AsyncFallback", "ReactiveFallback")
ROWS: Final = dict.fromkeys(_ON_SUCCESS, (S, F, "SUCCESS")) | dict.fromkeys(_ON_FAILURE, (F, S, "FAILURE"))
PRE_CONDITIONS: Final = (("_failureIf", True, F), ("_successIf", True, S), ("_skipIf", True, K), ("_while", False, K))
GUARDS: Final = tuple(name for name, _, _ in PRE_CONDITIONS)


class Outcome(NamedTuple):
    """How a node can end, and its children that are never ticked: index → why."""

    ends: Ends
    unreached: dict[int, str]


def constant_truth(script: str) -> bool | None:
    """What a script without names always says; None if it depends on entries, or cannot be run."""
    try:
        program = parse_script(script)
        if not program.statements or names_used(script):
            return None
        return truth(program.run(Env(None, {})), "it")  # type: ignore[arg-type]  # without names no scope is looked at
    except (ScriptSyntaxError, ScriptError):
        return None


def deciding_condition(plan: Plan) -> str:
    """The pre-condition that decides if none before it does, so that the node itself is never ticked; "" if there is none."""
    for name, deciding, _ in PRE_CONDITIONS:
        attribute = plan.element.attributes.get(name)
        if attribute is not None and constant_truth(attribute.value) is deciding:
            return name
    return ""


def outcome(plan: Plan, children: Sequence[Ends]) -> Outcome:
    """How a node can end once it is ticked, its pre-conditions included."""
    answers: Ends = NEVER
    for name, deciding, answer in PRE_CONDITIONS:
        attribute = plan.element.attributes.get(name)
        if attribute is None:
            continue
        says = constant_truth(attribute.value)
        if says is deciding:
            return Outcome(answers | answer, {})  # its children are told with it
        answers |= answer if says is None else NEVER
    own = _own(plan, children)
    return Outcome(answers | own.ends, own.unreached)


def _own(plan: Plan, children: Sequence[Ends]) -> Outcome:
    name, node_type = plan.type_name, plan.node_type
    if node_type is None:
        return Outcome(children[0] if children else ANY, {})
    if not node_type.builtin:
        return Outcome(EITHER if node_type.is_ours and node_type.kind in ("Action", "Condition") else ANY, {})
    if name in LEAVES:
        return Outcome(LEAVES[name], {})
    if name in ROWS:
        return _row(plan, children, *ROWS[name])
    if name == "TryCatch" and len(children) > 1:
        return _try_catch(plan, children)
    if name in ("IfThenElse", "WhileDoElse") and len(children) > 1:
        return _branches(children)
    if node_type.kind == "Decorator" and len(children) == 1:
        return _decorator(plan, children[0])
    return Outcome(ANY, {})


def _row(plan: Plan, children: Sequence[Ends], goes_on: Ends, ends: Ends, word: str) -> Outcome:
    """Children one after the other: each is ticked if those before it can end with `goes_on` or K."""
    found: Ends = NEVER
    passed, all_skip = NEVER, True
    for i, one in enumerate(children):
        found |= one & ends
        passed |= one & goes_on
        all_skip = all_skip and "K" in one
        if not one & (goes_on | K):
            why = f"<{plan.children[i].type_name}> before it never ends{f' with {word}' if one else ''}"
            return Outcome(found, dict.fromkeys(range(i + 1, len(children)), why))
    return Outcome(found | passed | (K if all_skip else NEVER), {})


def _try_catch(plan: Plan, children: Sequence[Ends]) -> Outcome:
    tried = _row(plan, children[:-1], S, F, "SUCCESS")
    is_needed = "F" in tried.ends or plan.element.get("catch_on_halt") not in ("", "false", "0")
    cleanup = {} if is_needed else {len(children) - 1: "what is tried never fails"}
    return Outcome(tried.ends, tried.unreached | cleanup)


def _branches(children: Sequence[Ends]) -> Outcome:
    condition, then, *otherwise = children
    unreached: dict[int, str] = {}
    found: Ends = NEVER
    if "S" in condition:
        found |= then
    else:
        unreached[1] = "the condition never succeeds"
    if "F" in condition:
        found |= otherwise[0] if otherwise else F
    elif otherwise:
        unreached[2] = "the condition never fails"
    return Outcome(found, unreached)


def _decorator(plan: Plan, child: Ends) -> Outcome:
    name, get = plan.type_name, plan.element.get
    cycles, attempts = _count(get("num_cycles")), _count(get("num_attempts"))
    if name == "Repeat" and cycles is not None and cycles <= 0 and cycles != -1:
        return Outcome(S, {0: f"num_cycles is {cycles}"})
    if name == "RetryUntilSuccessful" and attempts is not None and attempts <= 0 and attempts != -1:
        return Outcome(F, {0: f"num_attempts is {attempts}"})
    if name == "Precondition":
        says, other = constant_truth(get("if")), ANSWERS.get(get("else") or "FAILURE", NEVER)
        return Outcome(other, {0: "the condition is always false"}) if says is False else Outcome(child | (NEVER if says else other), {})
    ends = {
        "Inverter": frozenset(SWAPPED[end] for end in child),
        "ForceSuccess": (S if child & EITHER else NEVER) | (child & K),
        "ForceFailure": (F if child & EITHER else NEVER) | (child & K),
        "KeepRunningUntilFailure": child & F,
        "Repeat": child - S if cycles == -1 else child,
        "RetryUntilSuccessful": child - F if attempts == -1 else child,
        "Timeout": child | F,
        "Delay": child,
        "RunOnce": child | K,
        "WaitValueUpdate": child,
        "SkipUnlessUpdated": child | K,
    }
    return Outcome(ends.get(name, ANY), {})


def _count(text: str) -> int | None:
    try:
        return parse_int(text, -(2**31), 2**31)
    except ValueError:
        return None
