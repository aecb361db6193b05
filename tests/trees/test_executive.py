"""The executive's orders: they take effect at its next step, and whoever orders next can reckon with them at once."""

from __future__ import annotations

from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import load_mission
from pluto_bt.trees.executive import Executive

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
