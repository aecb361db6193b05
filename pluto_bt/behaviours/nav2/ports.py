"""Ports that Nav2's leaves have in common, and the error numbers of its action servers (nav2_msgs)."""

from __future__ import annotations

from typing import Any, ClassVar, Final

from py_trees.common import Status

from pluto_bt.behaviours.leaf import Leaf
from pluto_bt.behaviours.ports import Port
from pluto_bt.skills.reasons import PLACELESS

_IGNORED: Final = "of Nav2; means nothing here"
SERVER: Final = {
    "server_name": Port(str, False, _IGNORED),
    "server_timeout": Port(int, False, _IGNORED, unit="ms"),
}
SERVICE: Final = {"service_name": Port(str, False, _IGNORED), "server_timeout": SERVER["server_timeout"]}
FRAMES: Final = {"global_frame": Port(str, False, _IGNORED), "robot_base_frame": Port(str, False, _IGNORED)}
ERRORS: Final = {
    "error_code_id": Port(int, False, "why it failed: the number of Nav2's action; 0 on success"),
    "error_msg": Port(str, False, "why it failed, in words; empty on success"),
}


def ignored(name: str) -> dict[str, Port]:
    """A text port that Nav2 has and that says nothing to our robots."""
    return {name: Port(str, False, _IGNORED)}


class ActionLeaf(Leaf):
    """A leaf that gives Nav2's error number: `NUMBERS` by reason (`lost` and silent sensors are a `no-pose` to Nav2), `UNKNOWN` for all others."""

    UNKNOWN: ClassVar[int] = 0
    NUMBERS: ClassVar[dict[str, int]] = {}

    def fail(self, reason: str, text: str) -> Status:
        """FAILURE, with the number."""
        return self.fail_with(self.NUMBERS.get("no-pose" if reason in PLACELESS else reason, self.UNKNOWN), reason, text)

    def fail_with(self, number: int, reason: str, text: str) -> Status:
        """FAILURE with a number that the reason alone does not tell."""
        self._tell(number, text)
        return super().fail(reason, text)

    def succeed(self, text: str = "") -> Status:
        """SUCCESS; the number is 0."""
        self._tell(0, "")
        return super().succeed(text)

    def _tell(self, number: int, text: str) -> None:
        outputs: Any = self.output_ports()
        if "error_code_id" in outputs:
            self._set_output("error_code_id", number)
            self._set_output("error_msg", text)
