"""Switch2 … Switch6: the value of an entry chooses the child; the last child is the default."""

from __future__ import annotations

from typing import Any, ClassVar

from pluto_bt.trees.engine.node import ControlNode, reset
from pluto_bt.trees.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS, Result
from pluto_bt.trees.ports import PortModel, PortProblem
from pluto_bt.trees.values import STRING, parse_int, parse_real

EPSILON = 1.1920928955078125e-07  # of a 32-bit float, the tolerance of BehaviorTree.CPP


class Switch(ControlNode):
    """Compares `variable` with `case_1` … `case_N` in every tick; a child that was RUNNING is halted when the choice changes."""

    CASES: ClassVar[int] = 0

    def __init__(self, name: str = "", children: list[Any] | None = None) -> None:
        super().__init__(name, children)
        self.running: int | None = None
        self.enums: dict[str, int] = {}

    def step(self) -> Result:
        if len(self.children) != self.CASES + 1:
            self.fail(f"{type(self).__name__} needs {self.CASES + 1} children (one per case and a default), it has {len(self.children)}")
        choice = self._choice()
        if self.running is not None and self.running != choice:
            reset(self.children[self.running])
        result: Result = self.children[choice].step()
        if result is SKIPPED:
            self.running = None
            return self.skip()
        if result is RUNNING:
            self.running = choice
            if self.status is not RUNNING:
                self.status = RUNNING
                self.last = IDLE
            return RUNNING
        self.reset_children()
        self.running = None
        self.status = SUCCESS if result is SUCCESS else FAILURE
        return result

    def _choice(self) -> int:
        variable = self._text("variable")
        if variable is not None:
            for i in range(self.CASES):
                case = self._text(f"case_{i + 1}")
                if case is not None and same_value(variable, case, self.enums):
                    return i
        return self.CASES

    def _text(self, port: str) -> str | None:
        """A port as text; None where it is missing or has no value, which BehaviorTree.CPP passes over too."""
        reader = self.readers.get(port)
        if reader is None:
            return None
        try:
            return str(reader())
        except PortProblem:
            return None

    def forget(self) -> None:
        self.running = None


def same_value(a: str, b: str, enums: dict[str, int]) -> bool:
    """Equal as texts, as integers (enum names count), or as reals."""
    if a == b:
        return True
    whole_a, whole_b = _integer(a, enums), _integer(b, enums)
    if whole_a is not None and whole_a == whole_b:
        return True
    real_a, real_b = _real(a), _real(b)
    return real_a is not None and real_b is not None and abs(real_a - real_b) <= EPSILON


def _integer(text: str, enums: dict[str, int]) -> int | None:
    if text in enums:
        return enums[text]
    try:
        return parse_int(text, -(2**31), 2**31 - 1)
    except ValueError:
        return None


def _real(text: str) -> float | None:
    try:
        return parse_real(text)
    except ValueError:
        return None


def _switch(cases: int) -> type[Switch]:
    ports = {"variable": PortModel("variable", kind=STRING, required=False, description="the value that chooses")}
    for i in range(1, cases + 1):
        ports[f"case_{i}"] = PortModel(f"case_{i}", kind=STRING, required=False, description=f"child {i} is chosen by this value")
    members = {"CASES": cases, "CHILDREN": (cases + 1, cases + 1), "PORTS": ports, "__module__": __name__, "__doc__": Switch.__doc__}
    return type(f"Switch{cases}", (Switch,), members)


Switch2, Switch3, Switch4, Switch5, Switch6 = (_switch(cases) for cases in range(2, 7))
