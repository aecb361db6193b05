"""A small exact world around the real chain: a robot with lagging motors among discs and walls, sensors without noise, a lockstep loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from pluto_bt.blackboard import TOPICS, Blackboard, Inbox
from pluto_bt.blackboard.messages import ActuatorState, BumperState, FVectorState, LaserScan, Pose, SonarState, read_only
from pluto_bt.maps.platform import Platform
from pluto_bt.modules.avoid import Avoid
from pluto_bt.modules.context import Context
from pluto_bt.modules.drive import Drive
from pluto_bt.modules.motion import Motion
from pluto_bt.runtime import VirtualClock

Point = tuple[float, float]
TICK_NS = 10_000_000
SCAN_DELAY_S = 0.19


@dataclass
class Disc:
    """A post, or a person that walks with `velocity`."""

    x: float
    y: float
    r: float
    velocity: Point = (0.0, 0.0)

    def at(self, t_s: float) -> Point:
        return self.x + self.velocity[0] * t_s, self.y + self.velocity[1] * t_s


def box(x0: float, y0: float, x1: float, y1: float) -> list[tuple[Point, Point]]:
    """Four walls."""
    corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    return list(zip(corners, corners[1:] + corners[:1], strict=True))


@dataclass
class Rig:
    """Robot, world and chain. `run` lets time pass; the fields that tests set are read by the sensors."""

    platform: Platform
    discs: list[Disc] = field(default_factory=list)
    walls: list[tuple[Point, Point]] = field(default_factory=list)
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)
    raw_offset_rad: float = 0.0  # the odometry's heading differs from the pose's by this
    front: bool = False
    back: bool = False
    laser: str = "well"  # well | off | fatal | frozen | nan
    sonar: str = "well"  # well | off | nan
    odometry: str = "well"  # well | off
    path: list[tuple[float, float, float]] = field(default_factory=list)
    contacts: list[tuple[float, str]] = field(default_factory=list)
    hits: list[float] = field(default_factory=list)
    clearance: float = math.inf
    noise: np.random.Generator | None = None

    def __post_init__(self) -> None:
        self.clock = VirtualClock()
        self.board = Blackboard(TOPICS)
        self.running = {"motion": True, "avoid": True, "drive": True}
        above = {"filter": "drive", "drive": "avoid", "avoid": "motion", "motion": ""}
        self.inboxes = {name: Inbox(name, self._owner(up)) for name, up in above.items()}
        context = Context(self.board, self.clock, self.platform, self.inboxes, {}, None, lambda *line: None, self.running.__getitem__)
        context.order_module = lambda name, run: self.running.__setitem__(name, run)
        self.links = {"motion": Motion(context), "avoid": Avoid(context), "drive": Drive(context)}
        self.twist = (0.0, 0.0)
        self._base = (0.0, 0.0)
        self._base_s = -1.0
        self._distance = 0.0
        self._gap = 0.0
        names = ("ATRV2/Drive/Raw", "ATRV2/Sonar", "ATRV2/Bumper", "sick/scan", "wrist/state", "Localization/Dead-Reckoning", "Localization/Pose",
                 "filter/status")  # fmt: skip
        self._publish = {name: self.board.publisher(name, self.board.topic(name).writer) for name in names}
        self._scans: list[LaserScan] = []
        self._woken: set[str] = set()
        for name in self.links:
            self.inboxes[name].on_post(lambda name=name: self._woken.add(name))
        self._sense(0)
        for name in ("drive", "avoid", "motion"):
            self.links[name].start(0.0)

    def _owner(self, above: str) -> Callable[[str], bool]:
        return lambda source: source == above if above and self.running[above] else source not in ("motion", "avoid")

    @property
    def now(self) -> float:
        return self.clock.now_s()

    def status(self, link: str) -> FVectorState:
        """The newest status of drive, avoidance or motion."""
        sample = self.board.newest(f"{link}/status")
        assert sample is not None and isinstance(sample.value, FVectorState)
        return sample.value

    def order(
        self, flags: int, position: Point = (0.0, 0.0), velocity: Point = (0.0, 0.0), force: float | tuple[float, ...] = 0.0, to: str = "motion",
        tolerance: float = 0.0,
    ) -> str:  # fmt: skip
        """Post a command as the mission does."""
        forces = force if isinstance(force, tuple) else (force,)
        return self.inboxes[to].post("mission", ActuatorState(self.now, flags, position, velocity, (tolerance, 0.0), forces))

    def stop(self) -> None:
        """The operator's stop."""
        for name in ("filter", "drive", "avoid", "motion"):
            self.inboxes[name].stop("operator", self.now)

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Let time pass; True as soon as `until` holds."""
        end_ns = self.clock.now_ns() + round(seconds * 1e9)
        while self.clock.now_ns() < end_ns:
            k = self.clock.now_ns() // TICK_NS
            self._step_links(k)
            self._move()
            self.clock.jump_to((k + 1) * TICK_NS)
            self._sense(k + 1)
            if until():
                return True
        return False

    def _step_links(self, k: int) -> None:
        for name, every in (("drive", 5), ("avoid", 10), ("motion", 10)):
            if k % every == 0:
                self._woken.discard(name)
                self.links[name].step(self.now)
        while self._woken:
            name = min(self._woken)
            self._woken.discard(name)
            self.links[name].step(self.now)
        letter = self.inboxes["filter"].take()
        if letter is not None:
            self._base, self._base_s = letter.command.velocity, self.now
            self._publish["filter/status"].put(FVectorState(self.now, self._base), self.now)  # a filter that lets everything through

    # ---------------------------------------------------------------- physics

    def _move(self) -> None:
        dt, limits = TICK_NS / 1e9, self.platform.limits
        wanted = self._base if self.now - self._base_s < 0.3 else (0.0, 0.0)
        v, w = self.twist
        lag = dt / (limits.motor_time_constant_s + dt)
        dv, dw = (wanted[0] - v) * lag, (wanted[1] - w) * lag
        most = limits.deceleration_mps2 * 1.05 * dt if abs(wanted[0]) < abs(v) else limits.acceleration_mps2 * 1.05 * dt
        spin = math.radians(limits.turn_acceleration_dps2) * 1.05 * dt
        v, w = v + max(-most, min(most, dv)), w + max(-spin, min(spin, dw))
        x, y, th = self.pose
        new = (x + v * dt * math.cos(th + w * dt / 2), y + v * dt * math.sin(th + w * dt / 2), th + w * dt)
        self._touch(new, v, w)
        if self.contacts and self.contacts[-1][0] == self.now:
            new, v, w = self.pose, 0.0, 0.0
        self._distance += v * dt
        self.pose, self.twist = new, (v, w)

    def _touch(self, pose: tuple[float, float, float], v: float, w: float) -> None:
        fastest = max((math.hypot(*disc.velocity) for disc in self.discs), default=0.0)
        self._gap -= (abs(v) + abs(w) + fastest) * TICK_NS / 1e9
        if self._gap > max(0.0, self.clearance):
            return  # cannot be nearer than ever before
        gap, point, owner = self._nearest(pose)
        self._gap = gap
        self.clearance = min(self.clearance, gap)
        if gap > 0.0:
            return
        before = self._nearest(self.pose)[0]
        if gap < before - 1e-9 and before - gap > 0.0005 and (owner == "wall" or self._own_approach(point, v, w)):
            if not self.contacts or self.now - self.contacts[-1][0] > 0.5:
                self.contacts.append((self.now, owner))
        else:
            self.hits.append(self.now)

    def _own_approach(self, point: Point, v: float, w: float) -> bool:
        x, y, th = self.pose
        dx, dy = point[0] - x, point[1] - y
        ux, uy = v * math.cos(th) - w * dy, v * math.sin(th) + w * dx
        norm = math.hypot(dx, dy) or 1.0
        return (ux * dx + uy * dy) / norm > 0.05

    def _nearest(self, pose: tuple[float, float, float]) -> tuple[float, Point, str]:
        """Gap between outline and world (negative when they overlap), the world's nearest point, and what it is."""
        corners = np.array(self.platform.body.outline_m)
        c, s = math.cos(pose[2]), math.sin(pose[2])
        corners = corners @ np.array([[c, s], [-s, c]]) + pose[:2]
        edges = [(tuple(a), tuple(b)) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
        best = (math.inf, (0.0, 0.0), "")
        for disc in self.discs:
            centre = disc.at(self.now)
            inside = all(_cross(a, b, centre) > 0 for a, b in edges)
            gap = (-1.0 if inside else min(_to_segment(centre, a, b) for a, b in edges)) - disc.r
            best = min(best, (gap, centre, "disc"))
        for a, b in self.walls:
            gap = min(min(_to_segment(p, a, b) for p, _ in edges), min(_to_segment(p, *edge) for p in (a, b) for edge in edges))
            if any(_cross_segments(a, b, p, q) for p, q in edges):
                gap = -0.01
            best = min(best, (gap, a, "wall"))
        return best

    # ---------------------------------------------------------------- sensors

    def _sense(self, k: int) -> None:
        now, (x, y, th) = self.now, self.pose
        if k % 2 == 0:
            if self.odometry == "well":
                raw = ActuatorState(now, 0, (self._distance, th + self.raw_offset_rad), self.twist)
                self._publish["ATRV2/Drive/Raw"].put(raw, now)
            for name in ("Localization/Dead-Reckoning", "Localization/Pose"):
                self._publish[name].put(Pose(now, (x, y, 0.0, th, 0.0, 0.0)), now)
        if k % 5 == 0 and self.platform.devices.wrist:
            self._publish["wrist/state"].put(ActuatorState(now), now)  # it looks ahead
        if k % 10 == 0:
            self._publish["ATRV2/Bumper"].put(BumperState(now, self.front, self.back), now)
            self.path.append(self.pose)
            if self.platform.devices.sonar and self.sonar != "off":
                self._publish["ATRV2/Sonar"].put(SonarState(now, self._sonar()), now)
        if k % 20 == 0 and self.platform.devices.laser:
            self._scans.append(self._scan())
        if self._scans and now >= self._scans[0].stamp_s + SCAN_DELAY_S:
            scan = self._scans.pop(0)
            if self.laser != "off":
                self._publish["sick/scan"].put(scan, now)

    def _scan(self) -> LaserScan:
        laser = self.platform.devices.laser
        assert laser is not None
        angles = -math.pi / 2 + math.radians(0.5) * np.arange(361)
        if self.laser == "fatal":
            ranges = np.full(361, -1.0)
        elif self.laser == "frozen":
            ranges = self._last
        else:
            ranges = np.minimum(self._rays(laser.x_m, laser.y_m, angles), laser.max_range_m)
            if self.noise is not None:
                ranges = np.where(ranges < laser.max_range_m, np.round(ranges + self.noise.normal(0.0, 0.01, 361), 2), ranges)
            if self.laser == "nan":
                ranges = np.full(361, math.nan)
        self._last = ranges
        return LaserScan(self.now, -math.pi / 2, math.radians(0.5), read_only(ranges), 361)

    def _sonar(self) -> tuple[float, ...]:
        sonar = self.platform.devices.sonar
        assert sonar is not None
        out = []
        for t in sonar.transducers:
            fan = math.radians(t.theta_deg) + np.radians(np.linspace(-12.5, 12.5, 11))
            out.append(float(np.clip(self._rays(t.x_m, t.y_m, fan).min(), sonar.min_range_m, sonar.max_range_m)))
        return tuple(out) if self.sonar != "nan" else (math.nan,) * len(out)

    def _rays(self, x_m: float, y_m: float, angles: np.ndarray) -> np.ndarray:
        x, y, th = self.pose
        ox, oy = x + math.cos(th) * x_m - math.sin(th) * y_m, y + math.sin(th) * x_m + math.cos(th) * y_m
        dx, dy = np.cos(angles + th), np.sin(angles + th)
        best = np.full(len(angles), np.inf)
        for disc in self.discs:
            cx, cy = disc.at(self.now)
            b = dx * (cx - ox) + dy * (cy - oy)
            q = b * b - ((cx - ox) ** 2 + (cy - oy) ** 2 - disc.r**2)
            t = b - np.sqrt(np.maximum(q, 0.0))
            best = np.where((q >= 0.0) & (t > 0.0), np.minimum(best, t), best)
        for (ax, ay), (bx, by) in self.walls:
            ex, ey = bx - ax, by - ay
            det = dx * ey - dy * ex
            safe = np.where(np.abs(det) < 1e-12, np.nan, det)
            t, u = ((ax - ox) * ey - (ay - oy) * ex) / safe, ((ax - ox) * dy - (ay - oy) * dx) / safe
            best = np.where((t > 0.0) & (u >= 0.0) & (u <= 1.0), np.minimum(best, t), best)
        return best


def _cross(a: Iterable[float], b: Iterable[float], p: Iterable[float]) -> float:
    (ax, ay), (bx, by), (px, py) = a, b, p
    return float((bx - ax) * (py - ay) - (by - ay) * (px - ax))


def _to_segment(p: Iterable[float], a: Iterable[float], b: Iterable[float]) -> float:
    (px, py), (ax, ay), (bx, by) = p, a, b
    ex, ey = bx - ax, by - ay
    t = max(0.0, min(1.0, ((px - ax) * ex + (py - ay) * ey) / (ex * ex + ey * ey)))
    return float(math.hypot(px - ax - t * ex, py - ay - t * ey))


def _cross_segments(a: Point, b: Point, p: Iterable[float], q: Iterable[float]) -> bool:
    return _cross(a, b, p) * _cross(a, b, q) < 0.0 and _cross(p, q, a) * _cross(p, q, b) < 0.0
