"""A black box as one picture: the path from above, and below it speeds, verdicts and leaves over the same time."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from pluto_bt.commands.map_picture import INK, Driven, draw_map, map_size_in
from pluto_bt.maps.world import World
from pluto_bt.record.box import Box
from pluto_bt.record.curves import ASKED, DRIVEN, GIVEN, VELOCITIES, Curve, Lane, span_s, velocities, verdicts, work

CURVE_COLOURS: Final = {ASKED: "#bf8700", GIVEN: "#8c959f", DRIVEN: "#1f6feb"}
WORD_COLOURS: Final = ("#d1242f", "#bf8700", "#8250df", "#0969da", "#bc4c00", "#57606a", "#1a7f37", "#bf3989")
ENDS: Final = {"SUCCESS": ("o", "#2da44e"), "FAILURE": ("X", "#d1242f")}
MOST_LEAVES: Final = 14
LANE_IN, CURVES_IN, WORD_IN = 0.24, 1.6, 0.075  # heights of a lane and of curves, width of a letter, in inches


def draw_box(path: str, box: Box, world: World, driven: Driven) -> None:
    """Write the picture (`.png`, `.svg`)."""
    from matplotlib.figure import Figure

    curves = [(velocities(box, 0), "m/s", 1.0), (velocities(box, 1), "°/s", 180.0 / np.pi)]
    lanes = [(verdicts(box), "complaints"), (work(box, MOST_LEAVES), "leaves")]
    heights = [CURVES_IN for found, _, _ in curves if found] + [LANE_IN * len(found) + 0.5 for found, _ in lanes if found]
    width, height = map_size_in(world, driven)
    width = max(width, 9.0)
    figure = Figure(figsize=(width, height + sum(heights)), dpi=120, layout="constrained")
    rows = figure.subplots(1 + len(heights), 1, gridspec_kw={"height_ratios": [height, *heights]}, squeeze=False)[:, 0]
    draw_map(rows[0], world, driven)
    if rows[0].get_legend_handles_labels()[1]:
        rows[0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8, labelcolor=INK)
    below = iter(rows[1:])
    for found, unit, factor in curves:
        if found:
            _draw_curves(next(below), found, unit, factor)
    begin_s, end_s = span_s(box)
    seconds_per_in = (end_s - begin_s) / (width - 2.0)
    for strips, title in lanes:
        if strips:
            _draw_lanes(next(below), strips, title, seconds_per_in)
    for axes in rows[1:]:
        axes.set_xlim(begin_s, max(end_s, begin_s + 1e-3))
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    rows[-1].set_xlabel("time of the run (s)")
    figure.savefig(path)


def _draw_curves(axes: Any, curves: list[Curve], unit: str, factor: float) -> None:
    for curve in curves:
        style = "steps-post" if curve.holds else "default"
        axes.plot(curve.t_s, factor * curve.values, color=CURVE_COLOURS[curve.topic], linewidth=1.2, label=VELOCITIES[curve.topic], drawstyle=style)
    axes.axhline(0.0, color=INK, linewidth=0.4)
    axes.set_ylabel(unit)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=8, labelcolor=INK)


def _draw_lanes(axes: Any, lanes: list[Lane], title: str, seconds_per_in: float) -> None:
    """One bar a span; its word stands in it where there is room. Words have the same colour in all lanes."""
    words = list(dict.fromkeys(span.word for lane in lanes for span in lane.spans))
    colours = {word: WORD_COLOURS[i % len(WORD_COLOURS)] for i, word in enumerate(words)} | dict.fromkeys(("", *ENDS), "#9ec1f7")
    for word in words:
        is_told = word and word not in ENDS
        for number, lane in enumerate(lanes):  # all bars of a colour at once: an hour's run has thousands
            spans = [span for span in lane.spans if span.word == word]
            bars = [(span.begin_s, span.end_s - span.begin_s) for span in spans]
            axes.broken_barh(bars, (number - 0.35, 0.7), color=colours[word], linewidth=0, label=word if is_told and number == 0 else "")
            if word in ENDS:
                marker, colour = ENDS[word]
                axes.plot([span.end_s for span in spans], [number] * len(spans), marker, color=colour, markersize=5, clip_on=False)
            for begin_s, length_s in bars if is_told else ():
                if length_s > WORD_IN * len(word) * seconds_per_in:
                    axes.text(begin_s, number, f" {word}", fontsize=7, color="white", va="center", clip_on=True)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize=7, labelcolor=INK)
    axes.set_yticks(range(len(lanes)), [lane.name for lane in lanes], fontsize=7)
    axes.set_ylim(len(lanes) - 0.4, -0.6)
    axes.set_title(title, fontsize=8, color=INK, loc="left")
