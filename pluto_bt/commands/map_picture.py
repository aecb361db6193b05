"""A run seen from above: the world, the path, the goals and the contacts.

Uses matplotlib without pyplot, which would cost a second and keep global state.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pluto_bt.blackboard.messages import FloatArray
from pluto_bt.maps.placement import placed_outline
from pluto_bt.maps.world import Shape, World

if TYPE_CHECKING:
    from pluto_bt.runner import Runner

INK, WALL, PATH, GOAL, CONTACT, ACTOR = "#22262e", "#4a5361", "#1f6feb", "#2da44e", "#d1242f", "#bf8700"
AREA_COLOURS = {"named": "#8250df", "map": "#57606a", "forbidden": "#d1242f", "restrictive": "#bf8700", "one-way": "#0969da", "sector": "#57606a"}
LETTERS_PER_IN = 12.0  # of a title
OUTLINES = 24  # outlines of the robot drawn along the path


@dataclass(frozen=True)
class Driven:
    """What is drawn into a world: `track` (n, 3), x m, y m, theta rad; the robot's `outline_m` (k, 2); points (m).

    `seen_m` (k, 2) stands in for the world where none is known: the ends of laser beams.
    """

    title: str
    track: FloatArray
    outline_m: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    goals: Sequence[tuple[float, float]] = ()
    contacts: Sequence[tuple[float, float]] = ()
    seen_m: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))


def draw_run(path: str, runner: Runner) -> None:
    """`pluto run --plot`: a finished run, the path as it really was."""
    from matplotlib.figure import Figure

    world, result = runner.inputs.world, runner.result
    reason = f" ({result.reason})" if result.reason else ""
    figures = f"{result.distance_m:.1f} m in {result.sim_time_s:.1f} s, collisions {result.collisions}"
    driven = Driven(
        title=f"{result.mission} in {result.world}: {result.result}{reason}, {figures}",
        track=np.array([point.pose for point in runner.system.track.points]).reshape(-1, 3),
        outline_m=np.array(runner.inputs.robot.body.outline_m),
        goals=runner.goals(),
        contacts=[(contact["x_m"], contact["y_m"]) for contact in result.contacts],
    )
    figure = Figure(figsize=map_size_in(world, driven), dpi=120, layout="constrained")
    draw_map(figure.add_subplot(), world, driven)
    figure.legend(loc="outside lower left", ncols=6, frameon=False, fontsize=8, labelcolor=INK)
    figure.savefig(path)


def map_size_in(world: World, driven: Driven) -> tuple[float, float]:
    """Width and height that fit the map, in inches."""
    x_min, y_min, x_max, y_max = _frame(world, driven)
    width_m, height_m = x_max - x_min, y_max - y_min
    scale = 10.0 / max(width_m, height_m, 1e-6)
    return max(4.0, width_m * scale + 1.0), max(3.5, height_m * scale + 1.7)


def draw_map(axes: Any, world: World, driven: Driven) -> None:
    """Draw into `axes` (matplotlib's); what a legend should tell has a label."""
    x_min, y_min, x_max, y_max = _frame(world, driven)
    _draw_world(axes, world)
    axes.plot(driven.seen_m[:, 0], driven.seen_m[:, 1], ",", color=WALL, alpha=0.6, zorder=1)
    _draw_track(axes, driven)
    for number, (x_m, y_m) in enumerate(driven.contacts):
        axes.plot(x_m, y_m, "x", color=CONTACT, markersize=10, markeredgewidth=2.5, zorder=6, label="" if number else "contact")
    axes.set(xlim=(x_min, x_max), ylim=(y_min, y_max), aspect="equal", xlabel="x (m)", ylabel="y (m)")
    letters = round(LETTERS_PER_IN * axes.figure.get_figwidth())
    axes.set_title(textwrap.fill(driven.title, letters), fontsize=10, color=INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _frame(world: World, driven: Driven) -> tuple[float, float, float, float]:
    """What the picture shows: the world, and the path if it leaves it, with a margin."""
    x_min, y_min, x_max, y_max = world.bounds_m()
    points = np.vstack([driven.track[:, :2], driven.seen_m]) if len(driven.track) else np.array([(x_min, y_min)])
    if not world.files:  # the path alone
        low, high = points.min(axis=0), points.max(axis=0)
    else:
        low, high = np.minimum([x_min, y_min], points.min(axis=0)), np.maximum([x_max, y_max], points.max(axis=0))
    margin = 0.03 * float(np.max(high - low)) + 0.3
    return (float(low[0]) - margin, float(low[1]) - margin, float(high[0]) + margin, float(high[1]) + margin)


def _draw_world(axes: Any, world: World) -> None:
    if world.grid is not None:
        grid = world.grid
        rows, columns = grid.occupied.shape
        x, y, theta = grid.origin
        from matplotlib.transforms import Affine2D

        shade = np.where(grid.occupied > 0, 0.25, np.where(grid.unknown > 0, 0.9, 1.0))
        image = axes.imshow(shade, cmap="gray", vmin=0, vmax=1, origin="lower", interpolation="nearest",
                            extent=(0, columns * grid.resolution_m, 0, rows * grid.resolution_m))  # fmt: skip
        image.set_transform(Affine2D().rotate(theta).translate(x, y) + axes.transData)
    for terrain in world.terrains:
        axes.fill(*terrain.points.T, color="#9a6700", alpha=0.12, linewidth=0)
    for area in world.areas:
        axes.fill(*area.points.T, facecolor=AREA_COLOURS[area.kind], alpha=0.07, linewidth=0)
        axes.plot(*np.vstack([area.points, area.points[:1]]).T, "--", color=AREA_COLOURS[area.kind], linewidth=0.8)
    for shape in world.shapes:
        _draw_shape(axes, shape)
    for line in world.lines:
        axes.plot(*line.points.T, ":", color=AREA_COLOURS[line.kind], linewidth=1.5)
    for actor in world.actors:
        way = np.vstack([actor.waypoints, actor.waypoints[:1]]) if actor.loop else actor.waypoints
        axes.plot(*way.T, ":", color=ACTOR, linewidth=1)
        axes.add_patch(_circle(actor.waypoints[0], actor.radius_m, ACTOR))
    if world.actors:
        axes.plot([], [], "o", color=ACTOR, markersize=7, label="who walks, at the start")
    for goal in world.goals:
        axes.plot(goal.x_m, goal.y_m, "o", color=GOAL, markersize=5)
        axes.annotate(goal.id, (goal.x_m, goal.y_m), textcoords="offset points", xytext=(5, 5), fontsize=7, color=GOAL)
    for marker in world.markers:
        axes.plot(marker.x_m, marker.y_m, "s", color="#8c959f", markersize=3)


def _draw_shape(axes: Any, shape: Shape) -> None:
    style = {"linestyle": "--", "alpha": 0.4} if shape.absent else {}
    if shape.kind == "wall":
        axes.plot(*shape.points.T, color=WALL, linewidth=1.6, solid_capstyle="round", **style)
    elif shape.kind == "circle":
        axes.add_patch(_circle(shape.points[0], shape.radius_m, WALL))
    else:
        fill = "white" if shape.kind == "hole" else WALL
        fill = "none" if shape.absent else fill
        axes.fill(*shape.points.T, facecolor=fill, edgecolor=WALL, linewidth=1, hatch="///" if shape.kind == "hole" else None, **style)


def _circle(centre: Any, radius_m: float, colour: str) -> Any:
    from matplotlib.patches import Circle

    return Circle((float(centre[0]), float(centre[1])), radius_m, facecolor=colour, edgecolor=colour, alpha=0.8)


def _draw_track(axes: Any, driven: Driven) -> None:
    track = driven.track
    if len(track):
        axes.plot(track[:, 0], track[:, 1], color=PATH, linewidth=1.8, zorder=4, label="path")
        for index in np.unique(np.linspace(0, len(track) - 1, OUTLINES).astype(int)) if len(driven.outline_m) else ():
            corners = placed_outline(driven.outline_m, tuple(track[index]))
            is_end = index in (0, len(track) - 1)
            axes.plot(*np.vstack([corners, corners[:1]]).T, color=PATH, linewidth=1.2 if is_end else 0.5, alpha=1.0 if is_end else 0.35, zorder=4)
        axes.plot(*track[0, :2], "o", color=PATH, markersize=7, markerfacecolor="white", zorder=5, label="start")
        axes.plot(*track[-1, :2], "o", color=PATH, markersize=7, zorder=5, label="end")
    for number, (x, y) in enumerate(driven.goals):
        axes.plot(x, y, "*", color=GOAL, markersize=13, zorder=5, label="" if number else "goals")
