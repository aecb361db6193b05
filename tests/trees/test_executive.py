"""The executive's orders: they take effect at its next step, and whoever orders next can reckon with them at once."""

from __future__ import annotations

from typing import Any

import pytest

from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import load_mission
from pluto_bt.trees.executive import Executive
from tests.trees.clinging import Clings

SLEEPS = '<root BTCPP_format="4"><BehaviorTree ID="main"><Sleep msec="9000"/></BehaviorTree></root>'


class Body:
    """Counts the stops."""

    stops = 0

    def refresh(self, now_s: float) -> None:
        """Nothing to look at."""

    def stop(self) -> None:
        self.stops += 1

    def resumed(self) -> None:
        pass


def made() -> tuple[Executive, Body]:
    body = Body()
    return Executive(body, lambda level, code, text: None), body


@pytest.mark.parametrize("end", ["abort", "preempt", "job", "errand"])
def test_what_is_ended_is_over_also_if_a_leaf_raises_while_it_lets_go(end: str) -> None:
    said: list[tuple[str, str, str]] = []
    body = Body()
    executive = Executive(body, lambda level, code, text: said.append((level, code, text)))
    clock = VirtualClock()

    def mission(leaf: str) -> Any:
        return load_mission(f'<root BTCPP_format="4"><BehaviorTree ID="main"><{leaf}/></BehaviorTree></root>', nodes=[Clings], clock=clock)

    clinging = mission("Clings")
    if end == "job":
        executive.start_job(clinging, body)
    elif end == "errand":
        executive.start_errand(clinging)
    else:
        executive.start(clinging)
    executive.step(0.0)
    ended = {"job": executive.job, "errand": executive.errand}.get(end, executive.mission)
    assert ended is not None and ended.state == "running"
    if end == "job":
        executive.end_job("stopped")
    elif end == "errand":
        executive.end_errand(ended, "timeout")
    elif end == "abort":
        executive.abort("operator")
    else:
        executive.start(mission("AlwaysSuccess"))
    executive.step(0.1)
    assert ended.state == "aborted" and ended.error is not None and "it does not open" in ended.text
    assert [(level, code) for level, code, _ in said] == [("error", "leaf-error")]
    if end == "preempt":
        assert executive.mission is not None and executive.mission.state == "succeeded", "the next one is not held up by it"


def test_an_order_counts_before_it_is_carried_out() -> None:
    executive, body = made()
    assert executive.coming_state == "idle"
    executive.start(load_mission(SLEEPS, clock=VirtualClock()))
    assert executive.coming_state == "running" and executive.mission is None
    executive.step(0.0)
    executive.pause("operator")
    assert (executive.coming_state, executive.mission and executive.mission.state, body.stops) == ("paused", "running", 1)
    executive.resume()
    assert executive.coming_state == "running", "pause, then resume"
    executive.abort("operator")
    assert executive.coming_state == "aborted"
    executive.resume()
    assert executive.coming_state == "aborted", "what is over does not go on"
    executive.step(0.1)
    assert executive.mission is not None and executive.mission.state == executive.coming_state == "aborted"


def test_who_lets_go_stops_the_robot_only_while_something_is_at_work() -> None:
    executive, body = made()
    executive.let_go()
    assert body.stops == 0
    executive.start(load_mission(SLEEPS, clock=VirtualClock()))
    executive.step(0.0)
    executive.let_go()
    assert (body.stops, executive.mission and executive.mission.state) == (1, "running")
