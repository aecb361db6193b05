"""Nav2's conditions on error numbers: is it one after which a recovery may help."""

from __future__ import annotations

from typing import ClassVar

from py_trees.common import Status

from pluto_bt.behaviours.leaf import NO_PORTS
from pluto_bt.behaviours.nav2.condition import Nav2Condition
from pluto_bt.behaviours.nav2.planning import value_of
from pluto_bt.behaviours.ports import Port


class ErrorCondition(Nav2Condition, register=False):
    """SUCCESS if an error number is one of those that this condition is about."""

    HELPED: ClassVar[tuple[int, ...]] = ()
    INPUT_PORTS = {
        "error_code": Port(int, False, "the number, from error_code_id of an action"),
        "error_codes_to_check": Port(list[int], False, "other numbers than Nav2's"),
    }
    OUTPUT_PORTS = NO_PORTS

    def update(self) -> Status:
        """A number that nobody has written yet is none of them."""
        number = value_of(self, "error_code", 0)
        return self.answer(number in (value_of(self, "error_codes_to_check", None) or self.HELPED), f"error {number}")


class AreErrorCodesPresent(ErrorCondition):
    """SUCCESS if an error number is one of `error_codes_to_check`."""


class WouldAControllerRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of FollowPath."""

    HELPED = (100, 104, 105, 106)


class WouldAPlannerRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of the planner."""

    HELPED = (200, 207, 208, 300, 307, 308)


class WouldASmootherRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of SmoothPath."""

    HELPED = (500, 502, 503, 504)


class WouldARouteRecoveryHelp(ErrorCondition):
    """SUCCESS if a recovery may help after this error of a route."""

    HELPED = (400, 404, 405)
