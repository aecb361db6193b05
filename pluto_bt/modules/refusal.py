"""How a device without a status topic answers a command that makes no sense: by an event, as the links of the chain do by their status."""

from __future__ import annotations

from pluto_bt.modules.context import Context
from pluto_bt.skills.reasons import BAD_COMMAND


class Refusal:
    """Says `bad-command` once, until a command makes sense again: who sends twenty a second is told once."""

    def __init__(self, context: Context, module: str) -> None:
        self._say, self._module = context.say, module
        self._is_said = False

    def judge(self, why: str) -> None:
        """A command was refused for this reason, or taken, if it is empty."""
        if why and not self._is_said:
            self._say("warning", BAD_COMMAND, self._module, why)
        self._is_said = bool(why)
