"""Following: which of the things in the laser moves, where it is now, and where to drive to keep a distance from it.

The nearest one that has come along is the target. A target that somebody crosses or that goes behind a corner is foretold for a moment, then
looked for where it was seen last: at first for one who walks, then also for one who has stopped there. After `LOST_S` it is given up.
"""

from __future__ import annotations

import math
from enum import Enum
from typing import Final, NamedTuple

from pluto_bt.skills.outline import Planar
from pluto_bt.skills.pieces import Piece
from pluto_bt.skills.tracks import FORETELL_S, GATE_M, WATCHED_S, Track, Tracks

REACH_M: Final = 10.0  # farther away nobody is followed
FASTEST_MPS: Final = 2.0  # a target out of sight may have gone on at this speed …
FARTHEST_M: Final = 4.5  # … but not farther than this, or it is another one
GOES_ON_S: Final = 3.0  # of several, the one is taken who is nearest to where the target would be if it had gone on for so long
STOPPED_S: Final = 2.0  # a target out of sight for so long may have stopped
LIKE_M, THERE_M = 0.2, 2.0  # one who stands is the target only if he is as wide as it, and so near to where it went
LOOK_S: Final = 1.6  # nobody is chosen before, so that a slow one who is near is not missed for a fast one who is far
SEARCH_S: Final = 10.0
LOST_S: Final = 8.0
CLOSE_UP_PER_S: Final = 0.8  # speed for each metre that the distance is too long, on top of the target's own
HYSTERESIS_M: Final = 0.15
AROUND_S, AROUND_RAD = 3.5, math.radians(60.0)  # after so long out of sight it is looked for all around
CORNER_M: Final = 0.3  # so near the robot goes to where a hidden target was expected: round the corner one sees more from the corner


class Search(Enum):
    """How the search for the target stands."""

    LOOKING = "looking"
    SEEN = "seen"
    HIDDEN = "hidden"
    NOBODY = "no-object"  # the reasons that the leaf gives
    LOST = "target-lost"


class Aim(NamedTuple):
    """Where to drive, in the frame of the tracks. `speed_mps` 0: stand, and turn by `turn_rad`: towards the target, or where it went."""

    goal: tuple[float, float]
    speed_mps: float
    turn_rad: float
    distance_m: float


class Follow:
    """One follow from start to end."""

    def __init__(self, distance_m: float, most_mps: float, now_s: float) -> None:
        self._distance_m, self._most_mps = distance_m, most_mps
        self._tracks = Tracks()
        self._start_s = now_s
        self._drives = False
        self._turn_side = 1.0
        self.target: Track | None = None

    def see(self, pieces: list[Piece], robot: Planar, stamp_s: float) -> None:
        """Take a scan's pieces."""
        self._tracks.see(pieces, stamp_s, self.target)
        if self.target is None:
            self._choose(robot, stamp_s)
        elif stamp_s - self.target.seen_s >= self.target.foretold_s - 0.5 * FORETELL_S:
            self.target = self._found_again(self.target, stamp_s)

    def state(self, now_s: float) -> Search:
        """How it stands."""
        if self.target is None:
            return Search.LOOKING if now_s - self._start_s < SEARCH_S else Search.NOBODY
        hidden_s = now_s - self.target.seen_s
        return Search.SEEN if hidden_s < self.target.foretold_s else Search.HIDDEN if hidden_s < LOST_S else Search.LOST

    def pause(self, gap_s: float) -> None:
        """Time in which nobody looked does not count."""
        self._start_s += gap_s
        self._tracks.pause(gap_s)

    def aim(self, robot: Planar, now_s: float) -> Aim:
        """Where to drive now. Raises ValueError while there is no target."""
        if self.target is None:
            raise ValueError("nobody to follow yet")
        x, y = self.target.at(now_s)
        dx, dy = x - robot[0], y - robot[1]
        away_m, turn_rad = math.hypot(dx, dy), math.remainder(math.atan2(dy, dx) - robot[2], math.tau)
        too_far_m = away_m - (self._distance_m if self.state(now_s) is Search.SEEN else CORNER_M)
        self._drives = too_far_m > (HYSTERESIS_M / 3.0 if self._drives else HYSTERESIS_M)
        if not self._drives:
            if self.state(now_s) is Search.HIDDEN:
                turn_rad = self._look_around(self.target, robot[2], now_s)
            return Aim((x, y), 0.0, turn_rad, away_m)
        share = too_far_m / away_m
        flees_mps = (self.target.vx_mps * dx + self.target.vy_mps * dy) / away_m if self.state(now_s) is Search.SEEN else 0.0
        speed_mps = max(0.0, min(self._most_mps, flees_mps + CLOSE_UP_PER_S * too_far_m))  # who comes back is awaited standing
        return Aim((robot[0] + share * dx, robot[1] + share * dy), speed_mps, turn_rad, away_m)

    def _look_around(self, target: Track, heading_rad: float, now_s: float) -> float:
        """How to turn at the place where a hidden target was expected: first to where it went, then on around."""
        turn_rad = math.remainder(math.atan2(target.vy_mps, target.vx_mps) - heading_rad, math.tau)
        if now_s - target.seen_s < AROUND_S:
            self._turn_side = math.copysign(1.0, turn_rad)
            return turn_rad
        return self._turn_side * AROUND_RAD

    def _choose(self, robot: Planar, now_s: float) -> None:
        """The nearest that moves."""
        if now_s - self._start_s >= LOOK_S:
            movers = [track for track in self._tracks.all if track.moves and track.seen_s == now_s]
            self.target = min(movers, key=lambda track: math.hypot(track.x_m - robot[0], track.y_m - robot[1]), default=None)

    def _found_again(self, target: Track, now_s: float) -> Track:
        """Who has just come up where the target may be: one who walks, or, later, one who stands where nothing stood. Else the target as it is."""
        hidden_s = now_s - target.seen_s
        gate_m = min(FARTHEST_M, GATE_M + FASTEST_MPS * hidden_s)
        x, y = target.at(now_s, GOES_ON_S)
        fresh = [track for track in self._tracks.all if track.seen_s == now_s and track.born_s >= target.seen_s and track is not target]
        near = [track for track in fresh if math.hypot(track.x_m - target.x_m, track.y_m - target.y_m) < gate_m]
        found = [track for track in near if track.moves]
        if target.met_s > target.seen_s and hidden_s < GOES_ON_S:  # who comes out on another way is the one whom it met
            found = [track for track in found if track.vx_mps * target.vx_mps + track.vy_mps * target.vy_mps > 0.0]
        if not found and hidden_s >= STOPPED_S:
            there = target.at(now_s)
            stand = [track for track in near if math.dist((track.x_m, track.y_m), there) < THERE_M]
            found = [track for track in stand if self._may_be(target, track, now_s)]
        return min(found, key=lambda track: math.hypot(track.x_m - x, track.y_m - y), default=target)

    def _may_be(self, target: Track, track: Track, now_s: float) -> bool:
        """True if one who stands there may be the target: he looks like it, and is no furniture."""
        is_watched = now_s - track.born_s >= WATCHED_S
        return is_watched and abs(track.width_m - target.width_m) < LIKE_M and not self._tracks.stood_there(track)
