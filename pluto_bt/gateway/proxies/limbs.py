"""What the robot moves besides itself: the wrist that carries the laser (manual, section 8.3), and the arm."""

from __future__ import annotations

from pluto_bt.blackboard.messages import ActuatorState
from pluto_bt.gateway.proxies.proxy import Proxy
from pluto_bt.gateway.words import RunResult


class WristProxy(Proxy):
    """The pan-tilt unit; left and down are positive."""

    MODULE = "wrist"

    def move(self, pan_rad: float, tilt_rad: float, velocity_radps: float = 0.5, acceleration_radps2: float = 1.0) -> None:
        """Go to these angles. Raises: ValueError unless both velocity and acceleration are above 0: the wrist would not move."""
        if not (velocity_radps > 0.0 and acceleration_radps2 > 0.0):
            raise ValueError(f"expected a velocity and an acceleration above 0, found {velocity_radps:g} and {acceleration_radps2:g}")
        both, gently = (velocity_radps, velocity_radps), (acceleration_radps2, acceleration_radps2)
        self.client.command("wrist", 0, (pan_rad, tilt_rad), both, gently)

    def state(self) -> ActuatorState:
        """position = pan and tilt (rad), velocity = their rates."""
        return self._newest("wrist/state", ActuatorState)

    def accepted(self) -> ActuatorState:
        """The command that the wrist accepted last."""
        return self._newest("wrist/command", ActuatorState)


class ArmProxy(Proxy):
    """The arm."""

    MODULE = "arm"

    def unfold(self) -> RunResult:
        """Unfold it; back when that is done."""
        return self.client.run("UnfoldArm")

    def fold(self) -> RunResult:
        """Fold it; back when that is done."""
        return self.client.run("UnfoldArm", folded=True)

    def state(self) -> ActuatorState:
        """position[0] = how far unfolded, 0 to 1."""
        return self._newest("arm/state", ActuatorState)
