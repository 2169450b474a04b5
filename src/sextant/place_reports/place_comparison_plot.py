# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bar chart that compares methods of place recognition."""

from pathlib import Path
from typing import Dict, List, Sequence, Tuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.place_reports.place_comparison import ComparedMethod
from sextant.places.place_evaluation import PlaceEvaluation

BLUE, ORANGE = COLOURS[:2]
HEIGHT = 0.7  # of a bar, methods


def plot_comparison(
    path: Path, compared: Sequence[ComparedMethod], distances: Sequence[float], unit: str
) -> None:
    """Plots the shares of photos localized within distances, keypoints, memory and times of each method.

    :param path: of the PNG file
    :param compared: at least one
    :param distances: rising; unit: theirs, m or px
    :raises OSError: the file cannot be written; an existing one is unchanged
    """
    figure = new_figure(path, 12, 3.4 + 0.62 * len(compared), constrained_layout=True)
    grid = figure.add_gridspec(2, 4)
    names = [each.name for each in compared]
    map_photos, new_photos = figure.add_subplot(grid[0, :2]), figure.add_subplot(grid[0, 2:])
    _draw_shares(map_photos, [each.map_photos for each in compared], distances, unit)
    _finish(map_photos, names, "map photos localized within a distance, %")
    _draw_shares(new_photos, [each.new_photos for each in compared], distances, unit)
    _draw_clusters(new_photos, compared)
    _finish(new_photos, [""] * len(names), "new photos localized within a distance, %")
    handles, labels = new_photos.get_legend_handles_labels()
    new_photos.legend(
        handles[::-1], labels[::-1], loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False
    )  # fmt: skip
    for column, (title, (values, highest)) in enumerate(_costs(compared).items()):
        axes = figure.add_subplot(grid[1, column])
        _draw_bars(axes, values, highest)
        _finish(axes, [""] * len(names) if column else names, title)
    save_figure(path, figure)


def _costs(compared: Sequence[ComparedMethod]) -> Dict[str, Tuple[List[float], List[float]]]:
    """Lengths of the bars and ends of their lines, by title."""
    costs = [each.new_photos.cost for each in compared]
    figures = [each.new_photos.figures() for each in compared]
    times = [each["query_ms"] for each in figures], [each["query_ms_95"] for each in figures]
    bars = {
        "keypoints in the map": [each.keypoints for each in costs],
        "index, MB": [each.index_bytes / 1e6 for each in costs],
        "time to build, s": [each.seconds for each in costs],
    }
    return {**{title: (bar, bar) for title, bar in bars.items()}, "query, ms; line: to 95 %": times}


def _draw_clusters(axes: Axes, compared: Sequence[ComparedMethod]) -> None:
    if any(each.clusters for each in compared):
        shares = [100 * each.right_cluster for each in compared]
        style = {"color": ORANGE, "label": "in the right cluster", "clip_on": False}
        axes.plot(shares, range(len(compared)), "D", **style)


def _draw_shares(
    axes: Axes, evaluations: Sequence[PlaceEvaluation], distances: Sequence[float], unit: str
) -> None:
    """Bars over one another: the share within a distance contains those within smaller ones."""
    rows = range(len(evaluations))
    for number, distance in reversed(list(enumerate(distances))):
        shares = [100 * each.within(distance) for each in evaluations]
        strength = 1 - 0.75 * number / max(len(distances), 1)
        axes.barh(rows, shares, HEIGHT, color=_lighter(BLUE, strength), label=f"within {distance:g} {unit}")
    axes.set_xlim(0, 100)


def _draw_bars(axes: Axes, values: Sequence[float], highest: Sequence[float]) -> None:
    """:param highest: ends of the lines, equal to values if there are none"""
    axes.barh(range(len(values)), values, HEIGHT, color=BLUE, alpha=0.7)
    axes.hlines(range(len(values)), values, highest, color=BLUE)
    for row, (value, end) in enumerate(zip(values, highest)):
        text = f"{value:.0f}" if value >= 100 else f"{value:.3g}"
        axes.annotate(f" {text}", (end, row), va="center")
    axes.set_xlim(0, 1.5 * max(max(highest), 1e-9))  # with room for the numbers
    axes.xaxis.set_major_locator(MaxNLocator(3))


def _finish(axes: Axes, names: Sequence[str], title: str) -> None:
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names)
    axes.set_ylim(len(names) - 0.4, -0.6)  # the first method is on top
    axes.set_title(title, fontsize="medium")
    axes.grid(axis="x", alpha=0.3)
    axes.set_axisbelow(True)


def _lighter(colour: str, strength: float) -> tuple:
    """A colour mixed with white; strength 1: unchanged."""
    rgb = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return tuple(1 - strength * (1 - rgb))
