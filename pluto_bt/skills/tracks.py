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
FORETELL_S: Final = 1.0  # what is out of sight is thought to go on for so long …
MEET_M: Final = 0.9  # … but two whose middles are nearer than this may hide each other, or hang together in the scan …
WIDER_M: Final = 0.2  # … as a piece that is so much wider: they go on, each as it went, …
MEET_S, AGAIN_M = 2.5, 0.2  # … for so long, and only who is so near to where it is expected is it again
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
    foretold_s: float = FORETELL_S  # so long after it was seen it is thought to go on
    met_s: float = -math.inf  # when it was last so near to another one that the scan did not tell which is which; before it was seen again

    def at(self, now_s: float, most_s: float | None = None) -> tuple[float, float]:
        """Where it is expected: it goes on for a while after it was seen."""
        ahead_s = min(max(0.0, now_s - self.seen_s), self.foretold_s if most_s is None else most_s)
        return self.x_m + ahead_s * self.vx_mps, self.y_m + ahead_s * self.vy_mps

    def take(self, piece: Piece, now_s: float) -> None:
        """It was seen again."""
        dt_s = max(now_s - self.seen_s, 1e-3)
        x, y = self.x_m + dt_s * self.vx_mps, self.y_m + dt_s * self.vy_mps
        if dt_s > self.foretold_s:  # too long ago for its velocity to mean anything
            x, y, self.vx_mps, self.vy_mps = piece.x_m, piece.y_m, 0.0, 0.0
        dx, dy = piece.x_m - x, piece.y_m - y
        self.x_m, self.y_m = x + POSITION_GAIN * dx, y + POSITION_GAIN * dy
        self.vx_mps, self.vy_mps = self.vx_mps + VELOCITY_GAIN * dx / dt_s, self.vy_mps + VELOCITY_GAIN * dy / dt_s
        self.width_m += WIDTH_GAIN * (piece.width_m - self.width_m)
        self.seen_s, self.foretold_s, self.met_s = now_s, FORETELL_S, -math.inf
        came_m = math.hypot(self.x_m - self.first[0], self.y_m - self.first[1])
        self.moves = self.moves or (came_m >= MOVED_M and now_s - self.born_s >= WATCHED_S)

    def cost_m(self, piece: Piece, now_s: float) -> float:
        """How badly a piece fits to what is expected; infinite beyond the gate."""
        x, y = self.at(now_s)
        away_m = math.hypot(piece.x_m - x, piece.y_m - y)
        cost_m = away_m + WIDTH_SHARE * abs(piece.width_m - self.width_m) + (YOUNG_M if now_s - self.born_s < WATCHED_S else 0.0)
        is_unsure = now_s - self.met_s < MEET_S and not self.is_part_of(piece)
        return cost_m if away_m <= (AGAIN_M if is_unsure else GATE_M) else math.inf

    def is_part_of(self, piece: Piece) -> bool:
        """Whether somebody else hangs together with it."""
        return piece.width_m > self.width_m + WIDER_M

    def meet(self, now_s: float) -> None:
        """The scan does not tell which of two is which: it is thought to go on."""
        self.met_s, self.foretold_s = now_s, now_s - self.seen_s + FORETELL_S


class Tracks:
    """All tracks. What stood still and went out of view is remembered as furniture."""

    def __init__(self) -> None:
        self.all: list[Track] = []
        self._furniture: deque[tuple[float, float]] = deque(maxlen=FURNITURE)

    def see(self, pieces: list[Piece], stamp_s: float, keep: Track | None) -> None:
        """Give the pieces of a scan to the tracks that they fit, the best fit first; the others begin new ones. `keep` is never dropped."""
        blobs = self._those_who_meet(self._fits(pieces, stamp_s), pieces, stamp_s)
        tracks, free = set(range(len(self.all))), set(range(len(pieces))) - blobs
        for _, i, k in self._fits(pieces, stamp_s):
            if i in tracks and k in free:
                self.all[i].take(pieces[k], stamp_s)
                tracks.discard(i)
                free.discard(k)
        self.all += [_born(piece, stamp_s) for k, piece in enumerate(pieces) if k in free]
        gone = [track for track in self.all if track is not keep and stamp_s - track.seen_s >= max(FORGET_S, track.foretold_s)]
        self._furniture.extend(track.first for track in gone if not track.moves and track.seen_s - track.born_s >= WATCHED_S)
        self.all = [track for track in self.all if track not in gone]

    def _fits(self, pieces: list[Piece], now_s: float) -> list[tuple[float, int, int]]:
        """(cost, track, piece) of all that may belong to each other, the best first."""
        fits = [(track.cost_m(piece, now_s), i, k) for i, track in enumerate(self.all) for k, piece in enumerate(pieces)]
        return sorted(fit for fit in fits if fit[0] < math.inf)

    def _those_who_meet(self, fits: list[tuple[float, int, int]], pieces: list[Piece], now_s: float) -> set[int]:
        """Find those of which the scan does not tell which is which: one that walks is a part of something wider, or has too few pieces beside it.

        Returns: the pieces that are two.
        """
        whose = {k: i for _, i, k in reversed(fits)}  # the track that fits best
        lately = [i for i, track in enumerate(self.all) if now_s - track.seen_s < MEET_S and track.seen_s - track.born_s >= WATCHED_S]
        walk = [i for i in lately if self.all[i].moves]
        blobs = {k for _, i, k in fits if i in walk and whose[k] == i and self.all[i].is_part_of(pieces[k])}
        meet = {whose[k] for k in blobs}
        for i in walk:
            beside = [k for k in lately if k != i and math.dist(self.all[i].at(now_s), self.all[k].at(now_s)) < MEET_M]
            meet |= {i, *beside} if beside and len({i, *beside} - set(whose.values())) else set()
        for i in meet:
            self.all[i].meet(now_s)
        return blobs

    def stood_there(self, track: Track) -> bool:
        """True if something was seen standing there before."""
        return any(math.dist((track.x_m, track.y_m), place) < SAME_PLACE_M for place in self._furniture)

    def pause(self, gap_s: float) -> None:
        """Time in which nobody looked does not count."""
        for track in self.all:
            track.seen_s += gap_s


def _born(piece: Piece, stamp_s: float) -> Track:
    return Track(piece.x_m, piece.y_m, piece.width_m, stamp_s, stamp_s, (piece.x_m, piece.y_m))
