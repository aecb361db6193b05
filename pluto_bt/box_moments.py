"""A black box for the web console: what was true at a time of the run, in the words of the gateway's protocol."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterator
from typing import Any

import msgspec

from pluto_bt.blackboard import TOPICS
from pluto_bt.blackboard.messages import Event, LaserScan, Message, MissionState, NodeState, Pose, TreeState
from pluto_bt.gateway.encode import encode
from pluto_bt.gateway.replies import Cause, LogLine, Why
from pluto_bt.gateway.values import body_of, value_line
from pluto_bt.gateway.wire import Scenery
from pluto_bt.maps.load import load_world
from pluto_bt.modules.robot_file import load_robot_file
from pluto_bt.modules.scenery import scenery
from pluto_bt.record.box import Box, Now
from pluto_bt.record.codec import decode
from pluto_bt.record.mcap_reader import Line
from pluto_bt.trees.why import explain
from pluto_bt.trees.why_box import view_of

EVENTS_SHOWN = 60
TRACK_STEP_M, TRACK_STEP_RAD = 0.05, 0.05
FROM_TICKS = ("tree", "events", "mission/state")
"""Topics that the ticks tell better than their own samples, or that are told apart."""


class Moments:
    """Any moment of one box. Samples stay packed until a moment shows them."""

    def __init__(self, box: Box) -> None:
        self._box = box
        self._kinds = {topic.name: topic.type for topic in TOPICS}
        self._samples: dict[str, list[Line]] = {}
        for line in box.file.lines():
            if line.topic in self._kinds:
                self._samples.setdefault(line.topic, []).append(line)
        self._times_ns: dict[str, list[int]] = {}
        for topic, lines in self._samples.items():
            lines.sort(key=lambda line: line.time_ns)
            self._times_ns[topic] = [line.time_ns for line in lines]

    def at(self, t_s: float) -> bytes:
        """Everything that was known at that second: values, the tree, the mission, why, and the last events."""
        number = self._box.number_at(t_s)
        lines = [self._line(topic, t_s) for topic in self._samples if topic not in FROM_TICKS]
        if number >= 0:
            now = self._box.now(number)
            lines += [*_of_ticks(now, t_s), self._pose(now, t_s), self._why(now)]
        return b"".join([*lines, *self._events(t_s)])

    def scenery(self, shown: str) -> Scenery:
        """The map and the robot of the run, and how long it lasted. Raises: InputError if the box does not hold them."""
        box, run = self._box, self._box.run
        with box.unpacked() as files:
            world = load_world(files / (run.map or run.world), run.map or run.world)
            robot = load_robot_file(str(files / "platform.toml"), run.settings)
            name = load_world(files / run.world, run.world).robot.name
        stale_after_s = {topic.name: topic.stale_after_s + robot.record.thinned_period_s if topic.stale_after_s else 0.0 for topic in TOPICS}
        times_s = [time_ns / 1e9 for time_ns in box.times_ns] or [0.0]
        return scenery(
            world, robot, name, mode="box", box=shown, start_s=times_s[0], end_s=times_s[-1], stale_after_s=stale_after_s,
            track=self._track(), marks=self._marks(),
        )  # fmt: skip

    def _newest(self, topic: str, t_s: float) -> tuple[Message, Line] | None:
        lines = self._samples.get(topic, [])
        i = bisect.bisect_right(self._times_ns.get(topic, []), round(t_s * 1e9) + 500) - 1
        if i < 0:
            return None
        return decode(lines[i].data, self._kinds[topic]), lines[i]

    def _line(self, topic: str, t_s: float) -> bytes:
        found = self._newest(topic, self._seen_s(t_s) if topic == "Localization/Laser_Pose" else t_s)
        return b"" if found is None else _value(topic, found[0], found[1].sequence, t_s - found[1].time_ns / 1e9)

    def _seen_s(self, t_s: float) -> float:
        """When the pose of the laser was told that belongs to the newest scan: both are thinned, and not in step."""
        scan = self._newest("sick/scan", t_s)
        stamps_s = [line.time_ns / 1e9 for line in self._samples.get("Localization/Laser_Pose", ())]
        if scan is None or not stamps_s or not isinstance(scan[0], LaserScan):
            return t_s
        return min(stamps_s, key=lambda one_s: abs(one_s - scan[1].time_ns / 1e9))

    def _pose(self, now: Now, t_s: float) -> bytes:
        """The pose of the tick, which is told ten times a second; its covariance is that of the last sample."""
        known = self._newest("Localization/Pose", t_s)
        if now.tick.pose is None or known is None or not isinstance(known[0], Pose) or known[1].time_ns >= now.tick.t_ns:
            return b""
        x_m, y_m, theta_rad = now.tick.pose
        pose = msgspec.structs.replace(known[0], stamp_s=now.tick.t_s, pose=(x_m, y_m, 0.0, theta_rad, 0.0, 0.0))
        return _value("Localization/Pose", pose, now.number, t_s - now.tick.t_s)

    def _why(self, now: Now) -> bytes:
        answer = explain(view_of(now))
        return encode(Why(is_moving=answer.is_moving, causes=tuple(Cause(*cause) for cause in answer.causes)))

    def _events(self, t_s: float) -> Iterator[bytes]:
        last = bisect.bisect_right(self._times_ns.get("events", []), round(t_s * 1e9) + 500)
        for line in self._samples.get("events", [])[max(0, last - EVENTS_SHOWN) : last]:
            event = decode(line.data, Event)
            if isinstance(event, Event):
                yield encode(LogLine(event=event, seq=line.sequence))

    def _track(self) -> list[Any]:
        """[x, y, t, theta] along the way, thinned."""
        track: list[tuple[float, float, float, float]] = []
        for number in range(len(self._box)):
            tick = self._box.tick(number)
            if tick.pose is not None and (not track or _is_step(track[-1], tick.pose)):
                x_m, y_m, theta_rad = tick.pose
                track.append((round(x_m, 3), round(y_m, 3), tick.t_s, round(theta_rad, 3)))
        return track

    def _marks(self) -> list[Any]:
        """[t, level, text] of the warnings and errors, for the slider."""
        events = [decode(line.data, Event) for line in self._samples.get("events", ())]
        return [(event.stamp_s, event.level, event.text) for event in events if isinstance(event, Event) and event.level != "info"]


def _of_ticks(now: Now, t_s: float) -> list[bytes]:
    """The trees at work and the state of the mission, from the ticks."""
    rows = [
        NodeState(row.path, row.kind, row.name, row.depth, status, feedback, since_ns / 1e9)
        for tree in now.at_work()
        for row, status, feedback, since_ns in tree.rows()
    ]
    age_s = t_s - now.tick.t_s
    lines = [_value("tree", TreeState(now.tick.t_s, now.tick.step, tuple(rows)), now.number, age_s)]
    mission = now.mission
    if mission is not None:
        state = "paused" if now.paused and mission.state == "running" else mission.state
        told = MissionState(now.tick.t_s, mission.tree.name, mission.tree.run, state, now.paused or mission.reason)
        lines.append(_value("mission/state", told, now.number, age_s))
    return lines


def _is_step(last: tuple[float, float, float, float], pose: tuple[float, float, float]) -> bool:
    return math.dist(last[:2], pose[:2]) >= TRACK_STEP_M or abs(math.remainder(pose[2] - last[3], math.tau)) >= TRACK_STEP_RAD


def _value(topic: str, value: Message, seq: int, age_s: float) -> bytes:
    return value_line(topic, seq, value.stamp_s, age_s, body_of(value))
