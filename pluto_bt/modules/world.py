"""The simulated world as a module: moves the simulator on and shows the truth on the blackboard."""

from __future__ import annotations

from pluto_bt.blackboard.messages import Flag, WorldState
from pluto_bt.modules.context import Context

SHOW_EVERY = 5  # the truth is for people and tests; ten times a second is enough


class World:
    """Steps `sim.Simulator`; the first row of the table, so that all others see the world as it is now."""

    def __init__(self, context: Context) -> None:
        self._simulator = context.system.simulator
        self._clock = context.clock
        self._state = context.board.publisher("world/state", "world")
        flags = [topic.name for topic in context.board.topics if topic.writer == "world" and topic.type is Flag]
        self._flags = {name: context.board.publisher(name, "world") for name in flags}
        self._simulator.on_set_topic = self._set_topic
        self._steps = 0

    def start(self, now_s: float) -> None:
        """Nothing to do: the world is always there."""

    def stop(self) -> None:
        """Nothing to do."""

    def step(self, now_s: float) -> None:
        """Move the world on to now."""
        simulator = self._simulator
        simulator.step(now_s)
        if self._steps % SHOW_EVERY == 0:
            pose, velocity = simulator.pose, simulator.velocity
            truth = WorldState(now_s, pose, velocity, simulator.clearance_m, len(simulator.collisions), len(simulator.hit_by))
            self._state.put(truth, now_s)
        self._steps += 1

    def _set_topic(self, topic: str, value: str) -> None:
        now_s = self._clock.now_s()
        self._flags[topic].put(Flag(now_s, value), now_s)
