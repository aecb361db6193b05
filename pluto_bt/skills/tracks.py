"""The compact things that the laser sees, over time: each scan's pieces are given to the tracks that they continue."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from typing import Final

from pluto_bt.skills.pieces import Piece

MOVED_M: Final = 0.35  # who has come this far from where it was first seen moves
WATCHED_S: Final = 0.6  # a track is at least so old before anything is said of it
GATE_M: Final = 0.5  # a piece this near to where a track is expected may belong to it
WIDTH_SHARE: Final = 0.3  # how much each metre of another width counts beside metres of distance
YOUNG_M: Final = 0.3  # by so much a track that nobody has watched yet stands back
FORGET_S: Final = 1.5  # a track is dropped after so long out of sight
FORETELL_S: Final = 1.0  # what is out of sight is thought to go on for so long
FURNITURE: Final = 500  # so many places are remembered, the newest
SAME_PLACE_M: Final = 0.4  # what comes into view again so near to where something stood is that thing
POSITION_GAIN, VELOCITY_GAIN, WIDTH_GAIN = 0.6, 0.3, 0.1  # of the alpha-beta filter; widths change as a body turns


@dataclass(slots=True, eq=False)
class Track:
    """One thing over time, in a frame that never jumps; metres, m/s."""

    x_m: float
    y_m: float
    width_m: float
    born_s: float
    seen_s: float
    first: tuple[float, float]
    vx_mps: float = 0.0
    vy_mps: float = 0.0
    moves: bool = False

    def at(self, now_s: float, most_s: float = FORETELL_S) -> tuple[float, float]:
        """Where it is expected: it goes on for a while after it was seen."""
        ahead_s = min(max(0.0, now_s - self.seen_s), most_s)
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
        self.width_m += WIDTH_GAIN * (piece.width_m - self.width_m)
        self.seen_s = now_s
        came_m = math.hypot(self.x_m - self.first[0], self.y_m - self.first[1])
        self.moves = self.moves or (came_m >= MOVED_M and now_s - self.born_s >= WATCHED_S)

    def cost_m(self, piece: Piece, now_s: float) -> float:
        """How badly a piece fits to what is expected; infinite beyond the gate."""
        x, y = self.at(now_s)
        away_m = math.hypot(piece.x_m - x, piece.y_m - y)
        cost_m = away_m + WIDTH_SHARE * abs(piece.width_m - self.width_m) + (YOUNG_M if now_s - self.born_s < WATCHED_S else 0.0)
        return cost_m if away_m <= GATE_M else math.inf


class Tracks:
    """All tracks. What stood still and went out of view is remembered as furniture."""

    def __init__(self) -> None:
        self.all: list[Track] = []
        self._furniture: deque[tuple[float, float]] = deque(maxlen=FURNITURE)

    def see(self, pieces: list[Piece], stamp_s: float, keep: Track | None) -> None:
        """Give the pieces of a scan to the tracks that they fit, the best fit first; the others begin new ones. `keep` is never dropped."""
        fits = [(track.cost_m(piece, stamp_s), i, k) for i, track in enumerate(self.all) for k, piece in enumerate(pieces)]
        tracks, free = set(range(len(self.all))), set(range(len(pieces)))
        for cost_m, i, k in sorted(fits):
            if cost_m < math.inf and i in tracks and k in free:
                self.all[i].take(pieces[k], stamp_s)
                tracks.discard(i)
                free.discard(k)
        self.all += [_born(piece, stamp_s) for k, piece in enumerate(pieces) if k in free]
        gone = [track for track in self.all if track is not keep and stamp_s - track.seen_s >= FORGET_S]
        self._furniture.extend(track.first for track in gone if not track.moves and track.seen_s - track.born_s >= WATCHED_S)
        self.all = [track for track in self.all if track not in gone]

    def stood_there(self, track: Track) -> bool:
        """True if something was seen standing there before."""
        return any(math.dist((track.x_m, track.y_m), place) < SAME_PLACE_M for place in self._furniture)

    def pause(self, gap_s: float) -> None:
        """Time in which nobody looked does not count."""
        for track in self.all:
            track.seen_s += gap_s


def _born(piece: Piece, stamp_s: float) -> Track:
    return Track(piece.x_m, piece.y_m, piece.width_m, stamp_s, stamp_s, (piece.x_m, piece.y_m))
