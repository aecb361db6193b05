"""RecoveryNode and RoundRobin: what Nav2 does when something has failed."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.controls.branch import close
from pluto_bt.trees.engine.node import ControlNode, reset, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.values import BOOL, INT


class RecoveryNode(ControlNode):
    """The first child is the work; when it fails the second one recovers, and the work begins again in the same tick, so many times."""

    CHILDREN = (2, 2)
    PORTS: ClassVar = {"number_of_retries": PortModel("number_of_retries", kind=INT, default="1", description="so often it recovers and tries again")}

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.is_recovering = False
        self.retries = 0

    def step(self) -> Result:
        most = self.read("number_of_retries")
        if len(self.children) != 2:
            self.fail(f"RecoveryNode needs 2 children (the work and the recovery), it has {len(self.children)}")
        start(self)
        work, recovery = self.children
        while self.retries <= most:
            if not self.is_recovering:
                result: Result = work.step()
                if result is not FAILURE:
                    return RUNNING if result is RUNNING else self._ended(result)
                if self.retries >= most:
                    return self._ended(FAILURE)
                reset(work)
                self.is_recovering = True
            result = recovery.step()
            if result is RUNNING:
                return RUNNING
            if result is SKIPPED:  # no recovery is possible; this counts as no retry, and those made are not forgotten
                self.is_recovering = False
                reset(recovery)
                self.status = FAILURE
                return FAILURE
            if result is FAILURE:
                return self._ended(FAILURE)
            reset(recovery)
            self.retries += 1
            self.is_recovering = False
        return self._ended(FAILURE)

    def _ended(self, result: Result) -> Result:
        self.status = IDLE  # also of one whose work was skipped
        return close(self, result)

    def forget(self) -> None:
        self.is_recovering = False
        self.retries = 0


class RoundRobin(ControlNode):
    """One child after the other until one succeeds; the next activation begins with the child after it.

    Without `wrap_around` it fails when it has come past its last child, even if that one has succeeded.
    """

    PORTS: ClassVar = {"wrap_around": PortModel("wrap_around", kind=BOOL, default="false", description="after the last child the first one")}

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.index = 0
        self.failures = 0

    def step(self) -> Result:
        wraps, count = self.read("wrap_around"), len(self.children)
        start(self)
        skips = 0
        while self.failures + skips < count:
            result: Result = self.children[self.index].step()
            if result is RUNNING:
                return RUNNING
            self.index += 1
            is_past = self.index == count and not wraps
            self.index %= count
            if result is SUCCESS and not is_past:
                self.failures = 0
                self.reset_children()
                self.status = SUCCESS
                return SUCCESS
            skips += result is SKIPPED
            self.failures += result is FAILURE
            if is_past:
                break
        self.status = IDLE
        return close(self, SKIPPED if skips == count else FAILURE)

    def forget(self) -> None:
        self.index = self.failures = 0
