"""Small trees written in one line, and the ticks expected of them by hand.

`a:RS` in a tree stands for a leaf named "a" that answers RUNNING, then SUCCESS, then goes on with its last answer; the answers are
R S F and K (skipped). A tick is written as the answers of the leaves in order, halts as `a!`, then what the root told: `aS bR → R`.
"""

from __future__ import annotations

import re
from typing import Any, ClassVar

from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts, PortInformation

from pluto_bt.runtime import VirtualClock
from pluto_bt.trees import Mission, load_mission

ANSWERS = {"R": Status.RUNNING, "S": Status.SUCCESS, "F": Status.FAILURE, "K": Status.INVALID}


class Told(BehaviourWithPorts, tag="Told"):
    """A leaf that answers as it is told, and writes down what happens to it in the list at `blackboard.robot`."""

    INPUT_PORTS: ClassVar = {"does": PortInformation(data_type=str)}
    OUTPUT_PORTS: ClassVar[dict[str, PortInformation]] = {}

    def setup(self, **kwargs: Any) -> None:
        self.log: list[str] = kwargs["blackboard"].robot
        self.count = 0

    def update(self) -> Status:
        does = self.get_input("does")
        letter = does[min(self.count, len(does) - 1)]
        self.count += 1
        self.log.append(self.name + letter)
        return ANSWERS[letter]

    def terminate(self, new_status: Status) -> None:
        if new_status is Status.INVALID:
            self.log.append(f"{self.name}!")


class Bench:
    """A mission under test, its clock and the events since the last look."""

    def __init__(self, body: str, trees: str = "", **kwargs: Any) -> None:
        self.log: list[str] = []
        self.clock = VirtualClock()
        self.mission: Mission = load_mission(document(body, trees), nodes=[Told], clock=self.clock, robot=self.log, **kwargs)

    def tick(self, exactly: bool = False) -> str:
        """One tick in the notation of the tables."""
        status = self.mission.tick_exactly_once() if exactly else self.mission.tick_once()
        return f"{self.events()} → {'K' if status == 'SKIPPED' else status[0]}".strip()

    def events(self) -> str:
        """What the leaves wrote down since the last look."""
        text = " ".join(self.log)
        self.log.clear()
        return text

    def run(self, steps: str) -> str:
        """Do what stands before each arrow's place: `tick` by default, `+100` advances the clock by so many ms, `halt` halts.

        Returns the same steps as they really went, to be compared with the expected text.
        """
        out = []
        for step in steps.split(";"):
            word = step.strip()
            if word.startswith("+"):
                milliseconds = word.split()[0]
                self.clock.advance(int(milliseconds) / 1000)
                out.append(f"{milliseconds} {self.events()}".strip())
            elif word.startswith("halt"):
                self.mission.halt()
                out.append(f"halt {self.events()}".strip())
            else:
                out.append(self.tick(exactly=word.startswith("=")) if not word.startswith("=") else "= " + self.tick(exactly=True))
        return "; ".join(out)


def document(body: str, trees: str = "") -> str:
    """The whole XML of a body in short form; `trees` are further trees, as `ID { body }`."""
    others = re.findall(r"(\w+) \{(.*?)\}(?=\s*\w+ \{|\s*$)", trees, re.S)
    more = "".join(f'<BehaviorTree ID="{name}">{short(inner)}</BehaviorTree>' for name, inner in others)
    return f'<root BTCPP_format="4" main_tree_to_execute="Main"><BehaviorTree ID="Main">{short(body)}</BehaviorTree>{more}</root>'


def short(body: str) -> str:
    """`a:RS(_skipIf="x")` becomes a leaf with these attributes."""
    return re.sub(r"\b([a-z]\d?):([RSFK]+)(?:\(([^)]*)\))?", r'<Told name="\1" does="\2" \3/>', body)
