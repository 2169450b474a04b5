# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of a marker map from a recording: top view, and residuals of the observations."""

from typing import List, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import figure_png
from sextant.mapping.map_drawing import MapPlan
from sextant.mapping.map_quality import MapQuality, MarkerQuality

BLUE, RED = COLOURS[0], COLOURS[1]
ROW = 50  # markers per row of boxes, limited by the width of their names
MIN_RESIDUAL = 0.01  # px: a logarithmic axis has no zero


def plan_view(result, quality: MapQuality) -> bytes:
    """Plots the map from above: markers, their uncertainty and connections, and the path of the base.

    :param result: sextant.MappingResult with one marker or more
    :returns: a PNG
    """
    plan = MapPlan(result, quality)
    figure = Figure(figsize=plan.figure_size)
    FigureCanvasAgg(figure)  # not pyplot, which needs a window system and has global state
    plan.draw(figure.add_axes(plan.axes_place))
    return figure_png(figure)


def residual_boxes(quality: MapQuality) -> bytes:
    """Plots residuals by marker: a box of the used observations (whiskers 5 and 95 %), dots of the others.

    :param quality: of a map with one marker or more
    :returns: a PNG
    """
    markers = quality.markers
    rows = [markers[i : i + ROW] for i in range(0, len(markers), ROW)]
    figure = Figure(figsize=(13, 0.6 + 3.4 * len(rows)), constrained_layout=True)
    FigureCanvasAgg(figure)
    panels = figure.subplots(len(rows), 1, sharey=True, squeeze=False)[:, 0]
    for axes, row in zip(panels, rows):
        _draw_boxes(axes, row, [quality.name(marker.key) for marker in row])
        axes.set_xlim(0.4, 0.6 + (len(row) if len(rows) == 1 else ROW))
    panels[-1].set_xlabel("marker")
    panels[0].legend(handles=_legend(), loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=2, frameon=False)
    return figure_png(figure)


def _draw_boxes(axes: Axes, markers: Sequence[MarkerQuality], names: List[str]) -> None:
    at = range(1, 1 + len(markers))
    boxes = axes.boxplot(
        [_visible(marker.used_rms) for marker in markers],
        positions=at,
        whis=(5, 95),
        showfliers=False,
        patch_artist=True,
        widths=0.6,
        medianprops={"color": "black"},
    )
    for box in boxes["boxes"]:
        box.set(facecolor=BLUE, alpha=0.5)
    for x, marker in zip(at, markers):
        left_out = _visible(marker.left_out_rms)
        # Spread them, or many look like one.
        spread = x + 0.5 * (np.arange(left_out.size) % 7 - 3) / 7
        axes.plot(spread, left_out, ".", color=RED, markersize=4)
    axes.set_xticks(list(at))
    axes.set_xticklabels(names, rotation=90 if max(map(len, names), default=0) > 3 else 0, fontsize=8)
    axes.set(yscale="log", ylabel="RMS, px")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(axis="y", which="both", alpha=0.3)


def _visible(residuals: np.ndarray) -> np.ndarray:
    return np.maximum(residuals, MIN_RESIDUAL)


def _legend() -> List[Line2D]:
    return [
        Line2D([], [], color=BLUE, alpha=0.5, linewidth=8, label="used observations"),
        Line2D([], [], color=RED, linestyle="", marker=".", label="left out, since they do not fit"),
    ]
