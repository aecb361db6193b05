"""A black box over time: where the robot was, how fast it drove, what its links complained of, which leaves were at work."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from pluto_bt.blackboard.codes import CommandType, MotionCommand
from pluto_bt.blackboard.messages import ActuatorState, FloatArray, PathState, Pose
from pluto_bt.record.box import Box
from pluto_bt.record.entries import LINKS, STATUS_OF_LETTER, Posted
from pluto_bt.record.scans import LASER, SCAN, is_level, placed
from pluto_bt.record.story import leaves

NO_RETURN_M: Final = 79.0  # the lasers of our logs say 80 m and more for nothing met
POSE, ASKED, GIVEN, DRIVEN = "Localization/Pose", "drive/command", "ATRV2/Drive/Command", "ATRV2/Drive/Raw"
PATH = "map/path"
VELOCITIES: Final = {ASKED: "asked of the drive", GIVEN: "given to the base", DRIVEN: "driven"}
AMENDED_WITHIN_S: Final = 1.0  # a goal so soon after the last one is the same order with other figures


class Curve(NamedTuple):
    """One value of a topic over time; `holds`: it stays as it is until the next."""

    topic: str
    t_s: FloatArray
    values: FloatArray
    holds: bool


class Span(NamedTuple):
    """From when to when something was so. `word`: what; of a leaf its end, SUCCESS or FAILURE, "" if it was interrupted."""

    begin_s: float
    end_s: float
    word: str


class Lane(NamedTuple):
    """Who, and his spans in order."""

    name: str
    spans: list[Span]


def track_of(box: Box) -> FloatArray:
    """(n, 3) x m, y m, theta rad: where the robot believed to be, tick by tick; of a box without ticks, as the topic has it."""
    poses: list[Sequence[float]] = [tick.pose for tick in map(box.tick, range(len(box))) if tick.pose is not None]
    if not poses:
        samples = box.samples([POSE])[POSE]
        poses = [(sample.value.pose[0], sample.value.pose[1], sample.value.pose[3]) for sample in samples if isinstance(sample.value, Pose)]
    return np.array(poses, dtype=np.float64).reshape(-1, 3)


def seen_of(box: Box, most: int = 400) -> FloatArray:
    """(n, 2) m: where the beams of up to `most` level scans ended, all beams but those that met nothing."""
    samples = box.samples([SCAN, LASER])
    known = [(scan, laser.pose) for scan, laser in placed(samples[SCAN], samples[LASER]) if laser is not None and is_level(laser)]
    ends = [np.zeros((0, 2))]
    for scan, laser in known[:: math.ceil(len(known) / most) or 1]:
        met = (scan.ranges_m > 0.0) & (scan.ranges_m < np.max(scan.ranges_m)) & (scan.ranges_m < NO_RETURN_M)
        angles = laser[3] + scan.angle_min_rad + scan.angle_step_rad * np.arange(len(scan.ranges_m))
        ends.append((laser[:2] + scan.ranges_m[:, None] * np.column_stack([np.cos(angles), np.sin(angles)]))[met])
    return np.vstack(ends)


def goals_of(box: Box) -> list[tuple[float, float]]:
    """The places that trees sent the robot to, each once: by a command, or steering a car there themselves, which shows as a path of one point."""
    goals: list[tuple[float, tuple[float, float]]] = []
    last_s = -np.inf
    for tick in map(box.tick, range(len(box))):
        for command in filter(_is_goal, tick.commands):
            if tick.t_s - last_s >= AMENDED_WITHIN_S:
                goals.append((tick.t_s, command.position))
            last_s = tick.t_s
    for sample in box.samples([PATH])[PATH]:
        if isinstance(sample.value, PathState) and len(sample.value.points_m) == 2:
            goals.append((sample.written_s, (sample.value.points_m[0], sample.value.points_m[1])))
    return list(dict.fromkeys(goal for _, goal in sorted(goals, key=lambda timed: timed[0])))


def _is_goal(command: Posted) -> bool:
    is_goto = 0 < command.flags < MotionCommand.MOVETO and command.flags % 10 == CommandType.GOTO
    return command.to == "motion" and (is_goto or command.flags == MotionCommand.MOVETO) and not command.refused


def velocities(box: Box, which: int) -> list[Curve]:
    """Forward speeds (m/s, `which` 0) or turn rates (rad/s, 1): what was asked, what came through, what the wheels did.

    A command that does not say it, as one that holds a heading says no turn rate, is NaN.
    """
    samples = box.samples(VELOCITIES)
    curves = []
    for topic in VELOCITIES:
        known = [(sample.written_s, sample.value) for sample in samples[topic] if isinstance(sample.value, ActuatorState)]
        values = np.array([np.nan if topic == ASKED and not _says(value, which) else value.velocity[which] for _, value in known])
        curves.append(Curve(topic, np.array([written_s for written_s, _ in known]), values, holds=topic != DRIVEN))
    return [curve for curve in curves if np.isfinite(curve.values).any()]


def _says(command: ActuatorState, which: int) -> bool:
    kinds = (CommandType.VELOCITY, CommandType.REGULATOR)[: 2 - which]
    return 0 <= command.flags < MotionCommand.MOVETO and command.flags % 10 in kinds


def verdicts(box: Box) -> list[Lane]:
    """What each link complained of, lowest last; then topics that were too old, and stops by a person. [] of a box without ticks."""
    if not len(box):
        return []
    _, end_s = span_s(box)
    lanes = {name: _Lane() for name in (*LINKS, "too old", "held by")}
    for tick in map(box.tick, range(len(box))):
        now = tick.situation
        if now is not None:
            for name in LINKS:
                lanes[name].set(tick.t_s, now.links[name].reason if name in now.links else "")
            lanes["too old"].set(tick.t_s, _first_of(sorted(now.stale)))
            lanes["held by"].set(tick.t_s, now.hold[0])
    return [Lane(name, lane.closed(end_s)) for name, lane in lanes.items() if name in LINKS or lane.closed(end_s)]


def _first_of(names: list[str]) -> str:
    return "" if not names else names[0] if len(names) == 1 else f"{names[0]} + {len(names) - 1}"


def work(box: Box, most: int) -> list[Lane]:
    """The leaves that were at work for longer than a moment: the `most` of them that worked longest, in the order in which they began."""
    lanes: dict[tuple[int, int], _Lane] = {}
    for tick in map(box.tick, range(len(box))):
        for branch in tick.trees:
            ends = dict(branch.finished)
            for i in leaves(box.trees[branch.run].nodes):
                is_running = branch.nodes[i : i + 1] == "R"
                if is_running or (branch.run, i) in lanes:
                    lane = lanes.setdefault((branch.run, i), _Lane())
                    lane.set(tick.t_s, "RUNNING" if is_running else "", STATUS_OF_LETTER[ends[i]] if i in ends else "")
    _, end_s = span_s(box)
    found = [Lane(box.trees[run].nodes[i].name, lane.closed(end_s, keep_word=False)) for (run, i), lane in lanes.items()]
    longest = sorted(found, key=lambda lane: -sum(span.end_s - span.begin_s for span in lane.spans))[:most]
    return [lane for lane in found if lane in longest]


def span_s(box: Box) -> tuple[float, float]:
    """From when to when: the first and the last tick; of a box without ticks, the first and the last pose."""
    times = [time_ns / 1e9 for time_ns in box.times_ns] or [sample.written_s for sample in box.samples([POSE])[POSE]] or [0.0]
    return times[0], times[-1]


class _Lane:
    """Spans in the making."""

    def __init__(self) -> None:
        self.spans: list[Span] = []
        self._word, self._since_s = "", 0.0

    def set(self, t_s: float, word: str, end: str = "") -> None:
        """It is `word` from now on; `end` says how the span before it ended, of which "" says nothing."""
        if word != self._word:
            if self._word:
                self.spans.append(Span(self._since_s, t_s, end or self._word))
            self._word, self._since_s = word, t_s

    def closed(self, t_s: float, keep_word: bool = True) -> list[Span]:
        """All spans, the last one up to now."""
        spans = [*self.spans, Span(self._since_s, t_s, self._word)] if self._word else self.spans
        return spans if keep_word else [span._replace(word="" if span.word == "RUNNING" else span.word) for span in spans]
