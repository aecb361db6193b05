"""Following: which of the things in the laser moves, where it is now, and where to drive to keep a distance from it.

Every free-standing piece of the scans gets a track; the nearest one that has come along is the target. A target that somebody crosses or
that goes behind a corner is foretold for a moment, then looked for where it was seen last; after `LOST_S` it is given up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple

from pluto_bt.skills.outline import Planar
from pluto_bt.skills.pieces import Piece

REACH_M: Final = 10.0  # farther away nobody is followed
MOVED_M: Final = 0.35  # who has come this far from where it was first seen moves
WATCHED_S: Final = 0.6  # a track is at least so old before it counts as moving
GATE_M: Final = 0.5  # a piece this near to where a track is expected belongs to it …
FASTEST_MPS: Final = 2.0  # … and a target out of sight may have gone on at this speed
FARTHEST_M: Final = 3.0  # but not farther than this, or it is another one
FORGET_S: Final = 1.5  # a track that is no target is dropped after so long out of sight
FORETELL_S: Final = 1.0  # a hidden target is thought to go on for so long
LOOK_S: Final = 1.6  # nobody is chosen before, so that a slow one who is near is not missed for a fast one who is far
SEARCH_S: Final = 10.0
LOST_S: Final = 6.0
POSITION_GAIN, VELOCITY_GAIN = 0.6, 0.3  # of the alpha-beta filter
CLOSE_UP_PER_S: Final = 0.8  # speed for each metre that the distance is too long, on top of the target's own
HYSTERESIS_M: Final = 0.15


class Search(Enum):
    """How the search for the target stands."""

    LOOKING = "looking"
    SEEN = "seen"
    HIDDEN = "hidden"
    NOBODY = "no-object"  # the reasons that the leaf gives
    LOST = "target-lost"


@dataclass(slots=True)
class Track:
    """One thing over time, in a frame that never jumps; metres, m/s."""

    x_m: float
    y_m: float
    born_s: float
    seen_s: float
    first: tuple[float, float]
    vx_mps: float = 0.0
    vy_mps: float = 0.0
    moves: bool = False

    def at(self, now_s: float) -> tuple[float, float]:
        """Where it is expected: it goes on for a moment after it was seen."""
        ahead_s = min(max(0.0, now_s - self.seen_s), FORETELL_S)
        return self.x_m + ahead_s * self.vx_mps, self.y_m + ahead_s * self.vy_mps

    def take(self, piece: Piece, now_s: float) -> None:
        """It was seen again."""
        dt_s = max(now_s - self.seen_s, 1e-3)
        x, y = self.x_m + dt_s * self.vx_mps, self.y_m + dt_s * self.vy_mps
        if dt_s > FORETELL_S:  # too long ago for its velocity to mean anything
            x, y, self.vx_mps, self.vy_mps = piece.x_m, piece.y_m, 0.0, 0.0
        dx, dy = piece.x_m - x, piece.y_m - y
        self.x_m, self.y_m = x + POSITION_GAIN * dx, y + POSITION_GAIN * dy
        self.vx_mps, self.vy_mps = self.vx_mps + VELOCITY_GAIN * dx / dt_s, self.vy_mps + VELOCITY_GAIN * dy / dt_s
        self.seen_s = now_s
        came_m = math.hypot(self.x_m - self.first[0], self.y_m - self.first[1])
        self.moves = self.moves or (came_m >= MOVED_M and now_s - self.born_s >= WATCHED_S)


class Aim(NamedTuple):
    """Where to drive, in the frame of the tracks. `speed_mps` 0: stand, and turn by `turn_rad` towards the target."""

    goal: tuple[float, float]
    speed_mps: float
    turn_rad: float
    distance_m: float


class Follow:
    """One follow from start to end."""

    def __init__(self, distance_m: float, most_mps: float, now_s: float) -> None:
        self._distance_m, self._most_mps = distance_m, most_mps
        self._tracks: list[Track] = []
        self._start_s = self._scan_s = now_s
        self._drives = False
        self.target: Track | None = None

    def see(self, pieces: list[Piece], robot: Planar, stamp_s: float) -> None:
        """Take a scan's pieces: each track, the oldest first, takes the piece nearest to where it is expected."""
        self._scan_s = stamp_s
        free = list(pieces)
        for track in sorted(self._tracks, key=lambda track: (stamp_s - track.seen_s, track.born_s)):
            piece = _nearest(free, track.at(stamp_s), GATE_M)
            if piece is not None:
                free.remove(piece)
                track.take(piece, stamp_s)
        self._tracks += [Track(piece.x_m, piece.y_m, stamp_s, stamp_s, (piece.x_m, piece.y_m)) for piece in free]
        self._tracks = [track for track in self._tracks if track is self.target or stamp_s - track.seen_s < FORGET_S]
        self._choose(robot, stamp_s)

    def state(self, now_s: float) -> Search:
        """How it stands."""
        if self.target is None:
            return Search.LOOKING if now_s - self._start_s < SEARCH_S else Search.NOBODY
        hidden_s = now_s - self.target.seen_s
        return Search.SEEN if hidden_s < FORETELL_S else Search.HIDDEN if hidden_s < LOST_S else Search.LOST

    def pause(self, gap_s: float) -> None:
        """Time in which nobody looked does not count."""
        self._start_s += gap_s
        for track in self._tracks:
            track.seen_s += gap_s

    def aim(self, robot: Planar, now_s: float) -> Aim:
        """Where to drive now. Raises ValueError while there is no target."""
        if self.target is None:
            raise ValueError("nobody to follow yet")
        x, y = self.target.at(now_s)
        dx, dy = x - robot[0], y - robot[1]
        away_m, turn_rad = math.hypot(dx, dy), math.remainder(math.atan2(dy, dx) - robot[2], math.tau)
        keep_m = self._distance_m if self.state(now_s) is Search.SEEN else 0.3  # round the corner one sees more from the corner
        too_far_m = away_m - keep_m
        self._drives = too_far_m > (HYSTERESIS_M / 3.0 if self._drives else HYSTERESIS_M)
        if not self._drives:
            if self.state(now_s) is Search.HIDDEN:  # at the place itself: look where he went
                turn_rad = math.remainder(math.atan2(self.target.vy_mps, self.target.vx_mps) - robot[2], math.tau)
            return Aim((x, y), 0.0, turn_rad, away_m)
        share = too_far_m / away_m
        flees_mps = max(0.0, (self.target.vx_mps * dx + self.target.vy_mps * dy) / away_m)
        speed_mps = min(self._most_mps, flees_mps + CLOSE_UP_PER_S * too_far_m)
        return Aim((robot[0] + share * dx, robot[1] + share * dy), speed_mps, turn_rad, away_m)

    def _choose(self, robot: Planar, now_s: float) -> None:
        """At first the nearest that moves; for a target that is hidden, the one that moves or has just come up where it may be."""
        seen = [track for track in self._tracks if track.seen_s == now_s]
        target = self.target
        if target is None and now_s - self._start_s < LOOK_S:
            return
        if target is None:
            movers = [track for track in seen if track.moves]
            self.target = min(movers, key=lambda track: math.hypot(track.x_m - robot[0], track.y_m - robot[1]), default=None)
        elif now_s - target.seen_s >= 0.5 * FORETELL_S:
            x, y = target.at(now_s)
            gate_m = min(FARTHEST_M, GATE_M + FASTEST_MPS * (now_s - target.seen_s))
            again = [track for track in seen if track.moves and track.born_s > target.seen_s and math.hypot(track.x_m - x, track.y_m - y) < gate_m]
            self.target = min(again, key=lambda track: math.hypot(track.x_m - x, track.y_m - y), default=target)


def _nearest(pieces: list[Piece], at: tuple[float, float], within_m: float) -> Piece | None:
    """The piece nearest to a point, if one is near enough."""
    nearest = min(pieces, key=lambda piece: math.hypot(piece.x_m - at[0], piece.y_m - at[1]), default=None)
    return nearest if nearest is not None and math.hypot(nearest.x_m - at[0], nearest.y_m - at[1]) <= within_m else None
