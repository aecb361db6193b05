"""Who comes nearer or walks away: echoes that change round by round faster than the robot's own motion can explain. Frame: dead reckoning."""

from __future__ import annotations

import math

import numpy as np

from pluto_bt.maps.kernel import inline_kernel, kernel
from pluto_bt.skills.outline import Array, Planar
from pluto_bt.skills.seen_kernels import CAME, HIDDEN, SUDDEN, UNKNOWN, Counts
from pluto_bt.skills.sonar import Mask, SonarRing

ROUNDS = 4
PERHAPS, WALKS, SURELY = 1, 2, 3  # how well it is known that an echo is somebody's
HEAR_M = 3.0
NEARER_M = 0.12  # over the rounds: four sigma of a difference of two echoes, and 0.4 m/s
EVENLY = 0.6  # of the whole, at most, in one round: what comes into a cone from its side comes in one leap, as a post does beside which we drive
SUDDENLY_M = 0.06  # who is near all of a sudden has come by so much, two sigma; what was as near before is a post of which the laser saw another side
LEAST_EVENLY = 0.75  # the same for what is no wall: it comes in one leap, and then it stands
SLANT = 1.2  # a slanting wall comes nearer by so much more than one that stands across the way
WIDEST_RAD = math.radians(60.0)  # along a cone's edge farther off the way than this, what stands comes nearer without bound …
STANDING_M = 0.02  # … unless the robot as good as stands, and TURNING_M is how far the end of a cone may sweep
TURNING_M = 0.06
SWEPT_M = 0.2  # in three rounds: a turning cone is a sixth of that from where it is thought, which is less than what INSIDE leaves out
GRAZING = 8.0  # a wall that a cone's edge grazes comes nearer by so much more than the end of the cone sweeps: at seven degrees
FARTHER = SLANT / math.cos(WIDEST_RAD)  # what stands goes away by at most so much more than the robot's own way
MOST_LOST = 4  # one echo in a hundred gets lost: three in a row do so within some minutes, and who stands must not come out of nothing then
LONGEST_S = 0.7  # older rounds do not belong to the same approach


class Approach:
    """The newest rounds of the ring."""

    def __init__(self, ring: SonarRing, is_alone: bool) -> None:
        """`is_alone`: no laser will tell in a moment what was heard, so whoever walks matters; else only who comes."""
        self._ring = ring
        self._is_alone = is_alone
        self._rounds: list[tuple[Array, Planar, float]] = []
        self._lost = np.zeros(ring.count, dtype=np.intp)  # rounds in a row without an echo

    def look(self, ranges_m: Array, robot: Planar, stamp_s: float, news: Counts) -> Array:
        """Take a round, heard from `robot`; `news`: (k,) as `SeenSpace.add_echoes` says.

        Returns: (n, 4) x m, y m, how far beside that, and PERHAPS, WALKS or SURELY, for each transducer that hears somebody come or go. What
            changes while the robot stands, no motion of its own can explain: that is sure.
        """
        before_m = self._rounds[-1][0] if self._rounds else ranges_m
        kept = self._rounds[1 - ROUNDS :]
        first_m, _, first_s = kept[0] if kept else (ranges_m, robot, stamp_s)
        ranges_m, near, is_anything = heard_anew(
            ranges_m, before_m, first_m, self._lost, news, self._ring.max_range_m, self._ring.min_range_m, self._is_alone
        )
        self._rounds = [*kept, (ranges_m, robot, stamp_s)]
        if not is_anything or len(self._rounds) < ROUNDS or stamp_s - first_s > LONGEST_S:
            return NOTHING
        return self._those_who_walk(near, news)

    def _those_who_walk(self, near: Mask, news: Counts) -> Array:
        """Where they are: those of the near ones that come or go evenly, own motion taken off, and those that came.

        An echo where a laser saw nothing that could be it is from no wall that a cone sweeps over. So it tells of somebody also while the robot
        turns: surely enough where all was heard free a moment ago, perhaps where something is near all of a sudden.
        """
        heard_m = np.array([ranges_m for ranges_m, _, _ in self._rounds])
        places = np.array([robot for _, robot, _ in self._rounds])
        axes, half_rad = self._ring.axes, self._ring.half_cone_rad
        swept_rad = abs(math.remainder(places[-1, 2] - places[0, 2], math.tau))
        stays = heard_m[-1] * swept_rad < SWEPT_M  # where a cone ends while the robot turns fast is not known well enough to say what was free
        is_small = (news >= UNKNOWN) & (news != HIDDEN) & (not self._is_alone)
        if not self._is_alone and math.dist(places[0, :2], places[-1, :2]) > STANDING_M:
            near = near & (news != 0)  # who comes up to a robot that drives is seen himself; the laser knows a slanting face better than a cone
        moved = walked(heard_m, places, axes, near, is_small & stays, is_small & (news == SUDDEN), half_rad)
        moved[(news == CAME) & (stays | is_small)] = WALKS
        which = np.flatnonzero(moved)
        if not len(which):
            return NOTHING
        x, y, theta = places[-1].tolist()
        c, s, ranges_m = math.cos(theta), math.sin(theta), heard_m[:, which].min(axis=0)
        axis_rad = theta + axes[which, 2]
        apex_x, apex_y = x + c * axes[which, 0] - s * axes[which, 1], y + s * axes[which, 0] + c * axes[which, 1]
        is_sure = math.dist(places[0, :2], places[-1, :2]) + ranges_m * swept_rad < STANDING_M
        how = np.where(moved[which] == PERHAPS, PERHAPS, np.where(is_sure, SURELY, WALKS))
        return np.column_stack((apex_x + ranges_m * np.cos(axis_rad), apex_y + ranges_m * np.sin(axis_rad), ranges_m * math.sin(half_rad), how))


@kernel
def heard_anew(
    ranges_m: Array, before_m: Array, first_m: Array, lost: Counts, news: Counts, most_m: float, least_m: float, is_alone: bool
) -> tuple[Array, Mask, bool]:
    """A round as it counts, and what in it may be somebody.

    Args:
        ranges_m, before_m, first_m: (k,) this round, the one before, and the first of those that are compared.
        lost: (k,) rounds in a row without an echo, brought up to date. news: (k,) as `SeenSpace.add_echoes` says.
        most_m, least_m: farthest and nearest that a transducer can tell.
    Returns: (k,) each: the echoes, the last ones where they have only just stopped coming; who is near and has come or gone; and whether there is
        anybody at all of these, or an echo that came or is near all of a sudden.
    """
    n = ranges_m.shape[0]
    heard_m, is_anything = ranges_m.copy(), False
    near = np.zeros(n, dtype=np.bool_)
    for k in range(n):
        lost[k] = lost[k] + 1 if ranges_m[k] >= most_m else 0
        if 0 < lost[k] <= MOST_LOST:
            heard_m[k] = before_m[k]
        nearer_m = first_m[k] - heard_m[k]
        near[k] = least_m < heard_m[k] < HEAR_M and (abs(nearer_m) if is_alone else nearer_m) > NEARER_M
        is_anything = is_anything or near[k] or news[k] >= CAME
    return heard_m, near, is_anything


@kernel
def walked(heard_m: Array, places: Array, axes: Array, near: Mask, is_small: Mask, is_sudden: Mask, half_cone_rad: float) -> Counts:
    """(k,) which of the transducers hear something come or go that the robot's own motion does not explain: WALKS, PERHAPS or 0.

    Args:
        heard_m: (rounds, k). places: (rounds, 3) of the robot. axes: (k, 3) of the transducers, robot frame.
        near: (k,) whose echo has changed. is_small: (k,) whose echo no wall explains that a laser saw; if it is from none, it is from somebody
            PERHAPS. is_sudden: (k,) also near and new.
    """
    found = np.zeros(heard_m.shape[1], dtype=np.intp)
    for k in range(found.shape[0]):
        walks = near[k] and moves(heard_m, places, axes, k, False, half_cone_rad)
        comes = near[k] and is_small[k] and moves(heard_m, places, axes, k, True, half_cone_rad)
        is_there = is_sudden[k] and leaps(heard_m, places, axes, k, half_cone_rad)
        found[k] = WALKS if walks else PERHAPS if comes or is_there else 0
    return found


@inline_kernel
def moves(heard_m: Array, places: Array, axes: Array, k: int, is_small: bool, half_cone_rad: float) -> bool:
    """Whether what transducer `k` hears moves, if the echo may be a wall's, or surely that of something small."""
    rounds = heard_m.shape[0]
    first_m, second_m, last_m = heard_m[0, k], heard_m[1, k], heard_m[rounds - 1, k]
    comes = last_m < first_m
    total_m, most_m, moved_m = 0.0, -math.inf, 0.0
    for r in range(1, rounds):
        way_m, nearer_m = own_m(places, axes, r, k, is_small, half_cone_rad)
        step_m = heard_m[r - 1, k] - heard_m[r, k] - nearer_m if comes else heard_m[r, k] - heard_m[r - 1, k] - FARTHER * way_m
        total_m, most_m, moved_m = total_m + step_m, max(most_m, step_m), moved_m + way_m
    if is_small:
        return bool(comes and total_m > NEARER_M and most_m < LEAST_EVENLY * total_m)
    sweeps_m = min(last_m, HEAR_M) * abs(places[rounds - 1, 2] - places[0, 2])
    least_m = NEARER_M + GRAZING * sweeps_m
    gap_m = min(first_m, second_m) - last_m if comes else last_m - max(first_m, second_m)
    if moved_m + sweeps_m < STANDING_M and gap_m > least_m:
        return True
    is_even = total_m > least_m and most_m < EVENLY * total_m
    return bool(is_even and sweeps_m + (0.0 if comes else moved_m) < TURNING_M)


@inline_kernel
def leaps(heard_m: Array, places: Array, axes: Array, k: int, half_cone_rad: float) -> bool:
    """Whether what transducer `k` hears is nearer than in any of the rounds before by more than the robot's own motion since explains."""
    come_m, most_m = 0.0, 0.0
    for r in range(heard_m.shape[0] - 1, 0, -1):
        come_m += heard_m[r - 1, k] - heard_m[r, k] - own_m(places, axes, r, k, True, half_cone_rad)[1]
        most_m = max(most_m, come_m)
    return bool(most_m > SUDDENLY_M)


@inline_kernel
def own_m(places: Array, axes: Array, r: int, k: int, is_small: bool, half_cone_rad: float) -> tuple[float, float]:
    """The way of a transducer in the robot's step to round r, and how much nearer what stands can have come by it; infinite if nobody can say."""
    c0, s0, c1, s1 = math.cos(places[r - 1, 2]), math.sin(places[r - 1, 2]), math.cos(places[r, 2]), math.sin(places[r, 2])
    dx = places[r, 0] - places[r - 1, 0] + (c1 - c0) * axes[k, 0] - (s1 - s0) * axes[k, 1]
    dy = places[r, 1] - places[r - 1, 1] + (s1 - s0) * axes[k, 0] + (c1 - c0) * axes[k, 1]
    way_m = math.hypot(dx, dy)
    off_rad = math.atan2(dy, dx) - places[r, 2] - axes[k, 2]
    aside_rad = abs(math.atan2(math.sin(off_rad), math.cos(off_rad)))
    if is_small:  # what does not reach out of the cone comes nearer by no more than the way towards the cone's nearer edge
        return way_m, SLANT * way_m * math.cos(min(max(0.0, aside_rad - half_cone_rad), 0.5 * math.pi))
    edge_rad = min(aside_rad + half_cone_rad, WIDEST_RAD)
    known = edge_rad < WIDEST_RAD or way_m < STANDING_M / ROUNDS
    return way_m, SLANT * way_m / math.cos(edge_rad) if known else math.inf


NOTHING: Array = np.zeros((0, 4))


def warm() -> None:
    """Use the kernel once, so that who comes near first is not met while it is compiled."""
    nobody = np.zeros(1, dtype=np.bool_)
    walked(np.zeros((ROUNDS, 1)), np.zeros((ROUNDS, 3)), np.zeros((1, 3)), nobody, nobody, nobody, 0.1)
