"""A loaded mission: ticking, halting, and what can be asked of it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any, Final

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.ports import text_of
from pluto_bt.blackboard.messages import NodeState
from pluto_bt.trees.board_view import BoardView
from pluto_bt.trees.contracts import Contract, ContractWatch
from pluto_bt.trees.deciding import decider_of
from pluto_bt.trees.engine.context import Context
from pluto_bt.trees.engine.leaf import told
from pluto_bt.trees.engine.node import reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result, name_of
from pluto_bt.trees.enums import plugin_enums
from pluto_bt.trees.errors import RAISED, StepError, TickError
from pluto_bt.trees.origin import NOWHERE, Origin
from pluto_bt.trees.scopes import Board
from pluto_bt.trees.stand_ins import StandIns
from pluto_bt.trees.tracked import Tracked

MAX_REPEATS: Final = 100_000  # of one tick; a Repeat without end around leaves that never wait would go on for ever


class Mission:
    """One instance of a main tree. Two missions share nothing.

    Attributes:
        name: the ID of the main tree.
        root: its first node, a py_trees behaviour.
        blackboard: the root entries, a mapping.
        origin: where it came from.
        contracts: what must hold while it runs.
    """

    def __init__(self, name: str, root: Any, tracked: list[Tracked], board: Board, context: Context, origin: Origin = NOWHERE) -> None:
        self.name, self.root, self.origin = name, root, origin
        self.contracts: tuple[Contract, ...] = ()
        self.blackboard = BoardView(board.root)
        self._board = board
        self.ticks = 0
        self._tracked, self._context = tracked, context
        self._stand_ins = StandIns(tracked, context)
        self._make_paths_unique()

    # -- ticking

    def tick_once(self) -> str:
        """One tick, repeated while the root is RUNNING and a node has asked for another: "SUCCESS", "FAILURE", "RUNNING" or "SKIPPED".

        Raises: TickError if a node broke its promise; the tree is halted before.
        """
        return self._tick(again=True)

    def tick_exactly_once(self) -> str:
        """One tick of the root, whatever nodes ask for. Raises TickError as `tick_once`."""
        return self._tick(again=False)

    def _tick(self, again: bool) -> str:
        context, root = self._context, self.root
        self.ticks += 1
        try:
            result: Result = RUNNING
            context.woken, repeats = True, 0
            while context.woken and result is RUNNING:
                if context.skipped or context.polled or context.late_error is not None:
                    self._before_tick()
                context.woken = False
                result = root.step()
                repeats += 1
                if not again:
                    break
                if repeats > MAX_REPEATS:
                    raise StepError(root, f"a tick does not end: nodes have asked {MAX_REPEATS} times for another one at once")
        except Exception as error:
            raise self._tick_error(error) from error
        if result is SUCCESS or result is FAILURE:
            reset(root)
        return name_of(result)

    def _before_tick(self) -> None:
        context = self._context
        context.skipped.clear()
        context.fire_due()
        if context.late_error is not None:
            error, context.late_error = context.late_error, None
            raise error

    def _tick_error(self, error: Exception) -> TickError:
        with contextlib.suppress(TickError):  # the first error is the one to tell
            self.halt()
        return self._told(error)

    def _told(self, error: BaseException) -> TickError:
        node = error.node if isinstance(error, StepError) else self.root
        reason = error.reason if isinstance(error, StepError) else told(error)
        tracked = next((one for one in self._tracked if one.node is node), self._tracked[0])
        place = tracked.plan.element.place
        return TickError(tracked.path, tracked.plan.type_name, place.file, place.line, reason)

    def halt(self) -> None:
        """Interrupt everything that is RUNNING; afterwards all nodes are IDLE.

        As in BehaviorTree.CPP every node is then told once more, which runs its `_onHalted` script whether it was RUNNING or not.
        Raises: TickError with the first error of a node, after all have been halted.
        """
        errors: list[BaseException] = []
        for tracked in self._tracked:
            if tracked.node.status is not IDLE:
                tracked.node.last = tracked.node.status
        _attempt(self.root.halt, errors)
        for tracked in self._tracked:
            _attempt(tracked.node.halt, errors)
        for tracked in self._tracked:
            tracked.node.status = IDLE  # also of one whose halt hook raised
        if errors:
            raise self._told(errors[0]) from errors[0]

    # -- asking

    def statuses(self) -> dict[str, str]:
        """What each node told its parent last, by path; "IDLE" if it was never ticked."""
        skipped = self._skipped()
        return {tracked.path: tracked.last(skipped) for tracked in self._tracked}

    def node_states(self) -> list[NodeState]:
        """Every node, depth first, with its status now. `since_s` is as fine as the calls: call it after each tick."""
        skipped, now_s = self._skipped(), self._context.clock.now_s()
        return [tracked.state(tracked.status(skipped), now_s) for tracked in self._tracked]

    def now_s(self) -> float:
        """The time of its clock."""
        return self._context.clock.now_s()

    def active_leaf(self) -> str:
        """The path of the deepest RUNNING node, the first one where several are; "" if none is."""
        best: Tracked | None = None
        for tracked in self._tracked:
            if tracked.node.status is not RUNNING or any(child.status is RUNNING for child in tracked.node.children):
                continue
            if best is None or tracked.plan.depth > best.plan.depth:
                best = tracked
        return best.path if best is not None else ""

    def deciding_node(self) -> Tracked | None:
        """The node whose FAILURE the mission's is, usually a leaf: followed down from the root; None if the root did not fail."""
        node = decider_of(self.root)
        return None if node is None else next(tracked for tracked in self._tracked if tracked.node is node)

    def deciding_reason(self) -> str:
        """The `reason` that the deciding leaf gave, else its feedback, else its name; "" if the root did not fail.

        A control or decorator that decided without a leaf has no reason to give: `failed`.
        """
        decider = self.deciding_node()
        if decider is None:
            return ""
        outputs: dict[str, Any] = getattr(decider.node, "last_outputs", {})
        own = decider.node.reason if isinstance(decider.node, Leaf) else ""
        is_leaf = decider.plan.node_type is not None and not decider.plan.children
        return str(outputs.get("reason") or own or decider.node.feedback_message or (decider.plan.name if is_leaf else "failed"))

    def deciding_text(self) -> str:
        """The same in words: which node it was and what it said; "" if the root did not fail."""
        decider = self.deciding_node()
        if decider is None:
            return ""
        said = decider.node.feedback_message
        return f"{decider.path} ({decider.plan.type_name}) failed{': ' + said if said else ''}"

    def outputs(self) -> dict[str, str]:
        """What the root wrote to its output ports, as text; only a mission that is a single leaf has any."""
        written: dict[str, Any] = getattr(self.root, "last_outputs", {})
        return {name: text_of(value) for name, value in written.items()}

    def current_leaf(self) -> str:
        """The path of the leaf that was begun last: while a tick does not come back, the one that hangs. Any thread may ask."""
        current = self._context.current
        return next((tracked.path for tracked in self._tracked if tracked.node is current), "")

    def status_line(self) -> str:
        """One letter a node, depth first: its status (I R S F), or K if it was skipped in the last tick."""
        skipped = self._skipped()
        if skipped:
            return "".join([tracked.letter(skipped) for tracked in self._tracked])
        return "".join([one.node.status._name_[0] for one in self._tracked])  # `letter_of`, without a call for each node at each tick

    def attach(self, robot: Any) -> None:
        """Join a robot that was not there yet when the mission was loaded."""
        self.blackboard.robot = robot

    def replace_step(self, name: str, step: Callable[[], Result] | None) -> bool:
        """Let `step` stand in for that of all leaves called `name` (by name, type or path), None = their own again. False if there is none.

        World scripts let leaves fail with it.
        """
        return self._stand_ins.replace(name, step)

    def watch(self, listen: Callable[[int, str], None]) -> None:
        """Call `listen` (number of the node depth first, what it told its parent) whenever a leaf ends: SUCCESS, FAILURE or SKIPPED.

        A status alone does not tell it: a parent that ends in the same tick wipes it away.
        """
        self._stand_ins.watch(listen)

    def contract_watch(self) -> ContractWatch | None:
        """A watch over its contracts; None if it has none."""
        return ContractWatch(self.contracts, self._board.root, plugin_enums()) if self.contracts else None

    def nodes(self) -> list[Tracked]:
        """Every node with its plan, depth first; for dumps and checks."""
        return list(self._tracked)

    def _skipped(self) -> set[int]:
        return {id(node) for node in self._context.skipped}

    def _make_paths_unique(self) -> None:
        """BehaviorTree.CPP lets two leaves have one path; here the later one carries its number."""
        seen: set[str] = set()
        for tracked in self._tracked:
            if tracked.path in seen:
                tracked.path = f"{tracked.path}::{tracked.plan.uid}"
            seen.add(tracked.path)


def _attempt(halt: Callable[[], None], errors: list[BaseException]) -> None:
    try:
        halt()
    except RAISED as error:
        errors.append(error)
