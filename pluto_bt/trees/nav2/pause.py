"""PauseResumeController: branches for working, for standing, and for the changes between."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.controls.branch import close
from pluto_bt.trees.decorators.updated import UpdateWatch
from pluto_bt.trees.engine.node import ControlNode, start
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SUCCESS, Result
from pluto_bt.trees.ports import PortModel
from pluto_bt.trees.scopes import Scope
from pluto_bt.trees.values import STRING

RESUMED, PAUSED, ON_PAUSE, ON_RESUME = range(4)  # the children, in this order
NEXT = {ON_PAUSE: PAUSED, ON_RESUME: RESUMED}


class PauseResumeController(ControlNode):
    """Children: resumed, paused, on pause, on resume. In place of Nav2's two services there are two entries: a write to them is a request.

    A pause by the operator halts no node and ticks none; when he resumes, the branches "on pause" and "on resume" are worked.
    """

    CHILDREN = (1, 4)
    PORTS: ClassVar = {
        "pause_service_name": PortModel("pause_service_name", kind=STRING, default="pause", description="the entry that asks for a pause"),
        "resume_service_name": PortModel("resume_service_name", kind=STRING, default="resume", description="the entry that ends it"),
    }

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.scope: Scope | None = None  # set by the loader
        self.state = RESUMED
        self.resumes = 0
        self.requests: tuple[UpdateWatch, UpdateWatch] | None = None
        self.resumes_next = False

    def step(self) -> Result:
        if not 1 <= len(self.children) <= 4:
            self.fail(f"PauseResumeController needs 1 to 4 children, it has {len(self.children)}")
        is_new = self.status is IDLE
        start(self)
        asked = self._asked()
        if is_new:
            self.state, self.resumes_next = RESUMED, False
        elif asked is not None and asked != self.state:
            self.reset_children()
            self.state = asked
        if self.state >= len(self.children):
            self._go_on()
            return RUNNING
        result: Result = self.children[self.state].step()
        if result is RUNNING:
            return RUNNING
        if result is FAILURE:
            return close(self, FAILURE)
        if self.state == RESUMED:
            return close(self, SUCCESS)
        self._go_on()
        return RUNNING

    def _asked(self) -> int | None:
        """The branch that somebody asks for since the last tick."""
        assert self.scope is not None  # set by the loader
        if self.requests is None:
            names = self.read("pause_service_name"), self.read("resume_service_name")
            self.requests = (UpdateWatch(self.scope, names[0]), UpdateWatch(self.scope, names[1]))
        pause, resume = self.requests[0].is_updated(), self.requests[1].is_updated()
        resumes = getattr(self.scope.board.robot, "resumes", 0)
        was_resumed, self.resumes = resumes != self.resumes, resumes
        if was_resumed and self.state == RESUMED:
            self.resumes_next = True
            return ON_PAUSE
        if pause and self.state != PAUSED:
            return ON_PAUSE
        return ON_RESUME if (resume or was_resumed) and self.state == PAUSED else None

    def _go_on(self) -> None:
        self.state = NEXT.get(self.state, self.state)
        if self.state == PAUSED and self.resumes_next:
            self.state, self.resumes_next = ON_RESUME, False

    def forget(self) -> None:
        self.state, self.resumes_next = RESUMED, False
