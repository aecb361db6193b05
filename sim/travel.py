"""Moves the body among what stands and walks, and keeps the record of contacts.

While the nearest thing is farther than anything can move, a stretch of ticks is driven blindly (`_free_m` is a lower bound that shrinks by
what robot and actors can have moved). Near things every tick is tested exactly: the body first moves among things at rest, and stops at the
first touch, found by bisection; then the actors move, and one that now overlaps the robot has hit it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from pluto_bt.maps.scene import Nearest
from sim import motion
from sim.body import Body, Pose
from sim.outline import Outline
from sim.simtime import TICK_NS, TICK_S, SimTime
from sim.surroundings import Surroundings

OWN_SPEED_MPS = 0.05  # DESIGN.md, section 4: a contact with more own speed towards it is a collision, any other is being hit
TOUCH_M = 1e-5  # nearer than this counts as touching already: no search for the exact place
RELEASE_M = 0.01  # a contact is over when the robot is this far away again
HALVINGS = 16  # of one tick's way, 2 cm at most: the place of contact is good to a micrometre


@dataclass(frozen=True, slots=True)
class Contact:
    """The robot touched something, or was touched: when, where on the map, what, and the robot's own speed towards it."""

    t_s: float
    x_m: float
    y_m: float
    with_id: str
    speed_mps: float


class Travel:
    """Drives the body from tick to tick; `collisions`, `hit_by` and `min_clearance_m` are the record of the run."""

    def __init__(self, body: Body, outline: Outline, around: Surroundings, time: SimTime) -> None:
        self._body, self._outline, self._around, self._time = body, outline, around, time
        self._grown = outline.grown(RELEASE_M)
        self._free_m = -math.inf
        self._seen: tuple[Pose, int | None] | None = None  # where, and among moving actors when, the last look was
        self._gap_here_m = 0.0
        self._changed = True
        self._touching: dict[str, None] = {}
        self.collisions: list[Contact] = []
        self.hit_by: list[Contact] = []
        self.min_clearance_m = math.inf

    @property
    def free_m(self) -> float:
        """A lower bound of the clearance, without any cost."""
        return self._free_m

    def look(self) -> float:
        """The exact clearance now; also brings the bound and the minimum up to date."""
        body = self._body
        seen = (body.pose, self._time.now_ns if self._around.fastest_mps else None)
        if seen != self._seen:
            self._seen = seen
            self._gap_here_m = self._gap_m(body.pose)
            self.min_clearance_m = min(self.min_clearance_m, self._gap_here_m)
        self._free_m = self._gap_here_m
        if self._free_m > RELEASE_M:
            self._touching.clear()
        return self._gap_here_m

    def forget(self) -> None:
        """The world was changed: the bound holds no more."""
        self._free_m = -math.inf
        self._seen = None
        self._changed = True

    def advance(self, n_ticks: int, slip: float, blocked: bool) -> None:
        """Move time, body and actors on by `n_ticks`."""
        reach_m = self._body.reach_m(n_ticks, self._outline.radius_m) + self._around.fastest_mps * n_ticks * TICK_S
        if self._free_m <= reach_m:
            self.look()
        if self._free_m <= reach_m:
            for _ in range(n_ticks):
                self._advance_with_care(slip, blocked)
            self.look()
            return
        self._body.advance(n_ticks, slip, blocked)
        self._time.jump_to(self._time.now_ns + n_ticks * TICK_NS)
        self._free_m -= reach_m
        if self._free_m < self.min_clearance_m:
            self.look()

    def _advance_with_care(self, slip: float, blocked: bool) -> None:
        """One tick with exact tests: own motion first, then that of the actors."""
        before = self._body.pose
        self._body.advance(1, slip, blocked)
        twist = self._body.last_arc()
        if self._body.pose != before:
            self._stop_at_contact(before, twist)
        self._time.jump_to(self._time.now_ns + TICK_NS)
        if self._body.pose == before and not self._around.fastest_mps and not self._changed:
            return  # it pushes, or stands: nothing has come nearer or gone
        self._changed = False
        for contact in self._around.contacts(self._outline.at(self._body.pose)):
            self._note(contact, self._towards(contact, twist))
        if self._touching:
            near = [contact.owner for contact in self._around.contacts(self._grown.at(self._body.pose))]
            self._touching = {owner: None for owner in self._touching if owner in near}

    def _stop_at_contact(self, before: Pose, twist: tuple[float, float]) -> None:
        """Hold the body at the first touch on its way, if there is one."""
        if self._gap_m(self._body.pose) > 0.0:
            return
        gap_before = self._gap_here_m if self._seen == (before, None) else self._gap_m(before)
        if gap_before <= 0.0:
            self._stop_if_deeper(before, twist)
            return
        share = self._free_share(before, twist) if gap_before > TOUCH_M else 0.0
        beyond = self._around.contacts(self._outline.at(self._body.pose))
        self._body.hold(before, share)
        if any(contact.owner not in self._touching for contact in beyond):
            closing_mps = self._closing_mps(twist)
            for contact in beyond:
                self._note(contact, closing_mps)

    def _closing_mps(self, twist: tuple[float, float]) -> float:
        """Own speed towards what is in contact: how fast the gap opens when the arc is run backwards."""
        backed_off = motion.along_arc(self._body.pose, *twist, -TICK_S)
        fastest_mps = abs(twist[0]) + abs(twist[1]) * self._outline.radius_m
        return min((self._gap_m(backed_off) - self._gap_m(self._body.pose)) / TICK_S, fastest_mps)

    def _stop_if_deeper(self, before: Pose, twist: tuple[float, float]) -> None:
        """Something lies over the robot already: it may move away from that, but neither further into it nor into anything else."""
        old = self._around.contacts(self._outline.at(before))
        owners = [contact.owner for contact in old]
        new = [contact for contact in self._around.contacts(self._outline.at(self._body.pose)) if contact.owner not in owners]
        if new or any(self._towards(contact, twist) > 0.0 for contact in old):
            for contact in new:
                self._note(contact, self._towards(contact, twist))
            self._body.hold(before, 0.0)

    def _free_share(self, before: Pose, twist: tuple[float, float]) -> float:
        """The share of the tick's arc, from a pose that is free to one that is not, that is free."""
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if self._gap_m(motion.along_arc(before, *twist, middle * TICK_S)) > 0.0:
                low = middle
            else:
                high = middle
        return low

    def _gap_m(self, pose: Pose) -> float:
        """The clearance of the outline at a pose, now."""
        return self._around.gap_m(self._outline.at(pose))

    def _towards(self, contact: Nearest, twist: tuple[float, float]) -> float:
        """Own speed of the outline at the contact towards the thing, positive when closing in."""
        body = self._body
        x, y = contact.x_m - body.x_m, contact.y_m - body.y_m
        speed, turn_rate = twist
        u, v = speed * math.cos(body.theta_rad) - turn_rate * y, speed * math.sin(body.theta_rad) + turn_rate * x
        actor = self._around.actors().get(contact.owner)
        if actor is not None and math.hypot(actor[0] - contact.x_m, actor[1] - contact.y_m) > TOUCH_M:
            x, y = actor[0] - contact.x_m, actor[1] - contact.y_m
        return (u * x + v * y) / max(math.hypot(x, y), TOUCH_M)

    def _note(self, contact: Nearest, own_speed_mps: float) -> None:
        """Count a contact once, as long as it lasts."""
        if contact.owner in self._touching:
            return
        self._touching[contact.owner] = None
        kept = Contact(self._time.now_s, contact.x_m, contact.y_m, contact.owner, max(own_speed_mps, 0.0))
        (self.collisions if own_speed_mps > OWN_SPEED_MPS else self.hit_by).append(kept)
