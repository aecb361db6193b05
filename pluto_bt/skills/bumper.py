"""The bumper latch: a pressed panel forbids motion until it is released and a new command has come."""

from __future__ import annotations

from pluto_bt.blackboard.codes import LinkStatus
from pluto_bt.skills.limits import Twist


class BumperLatch:
    """Front pressed: no forward motion, no rotation, backing allowed. Back pressed: mirrored."""

    def __init__(self) -> None:
        self.front = False
        self.back = False

    def press(self, front: bool, back: bool) -> None:
        """Take a reading; a release alone clears nothing."""
        self.front = self.front or front
        self.back = self.back or back

    def new_command(self, front: bool, back: bool) -> None:
        """A new command came while the panels read `front` and `back`: what is released is forgotten."""
        self.front = front
        self.back = back

    def held(self, twist: Twist) -> Twist:
        """What the latch leaves of a command."""
        if not (self.front or self.back):
            return twist
        speed_mps = twist[0]
        if (self.front and speed_mps > 0.0) or (self.back and speed_mps < 0.0):
            speed_mps = 0.0
        return speed_mps, 0.0

    @property
    def code(self) -> LinkStatus:
        """1 front, 2 back, 0 neither; the front is named if both are latched."""
        return LinkStatus.FRONT_BUMPER if self.front else LinkStatus.BACK_BUMPER if self.back else LinkStatus.NORMAL
