"""A script at its place in a mission: program, scope and enums; errors are told as errors of the node."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pluto_bt.trees.errors import StepError
from pluto_bt.trees.scopes import Scope
from pluto_bt.trees.script.parser import parse_script
from pluto_bt.trees.script.terms import Env
from pluto_bt.trees.script.tokens import ScriptSyntaxError
from pluto_bt.trees.script.values import ScriptError, truth
from pluto_bt.trees.values import PortProblem


class ScriptRunner:
    """Runs a literal script, or one that is read from an entry each time."""

    def __init__(self, scope: Scope, enums: Mapping[str, int], text: str | Callable[[], Any], label: str = "") -> None:
        self._env = Env(scope, enums)
        self._label = label
        self._read = text if callable(text) else None
        self._program = parse_script(text) if isinstance(text, str) else None

    def run(self, node: Any) -> Any:
        """The value of the last statement. Raises StepError of `node`."""
        try:
            program = self._program if self._read is None else parse_script(str(self._read()))
            assert program is not None  # one of the two is always given
            return program.run(self._env)
        except (ScriptError, ScriptSyntaxError, PortProblem) as error:
            raise StepError(node, self._told(str(error))) from None

    def is_true(self, node: Any) -> bool:
        """The last statement as a condition: 0 or 1 as an integer, or any real."""
        value = self.run(node)
        try:
            return truth(value, "the condition")
        except ScriptError as error:
            raise StepError(node, self._told(str(error))) from None

    def _told(self, reason: str) -> str:
        return f"script {self._label + ' ' if self._label else ''}failed: {reason}"
