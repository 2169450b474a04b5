# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots that compare methods at distances or surveyed points: errors, share of images with a pose."""

from itertools import cycle
from pathlib import Path
from typing import Dict, List, Sequence, Union

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullFormatter

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.evaluation.accuracy_plots import SCALES, SHOWN
from sextant.evaluation.drive_plot import draw_marker
from sextant.evaluation.error_statistics import ALL, QUANTITIES, ErrorStatistics
from sextant.evaluation.pose_series import AXES, SeriesStatistics

SHOWN_QUANTITIES = ("position", "x", "y", "z", "yaw")  # one panel each
QUANTITY_SCALES, QUANTITIES_SHOWN = (SCALES[0], *SCALES), (SHOWN[0], *SHOWN)
WIDTH = 0.8  # of all methods at one place, places
OUTLIER = 15.0  # ratio of the worst error to the median 95 %, above which the errors' axis is logarithmic
MARGIN = 0.5  # around the points and markers of the top view, metres
DOTS = 1000  # maximum number of poses drawn per point and method
HEADING = 0.3  # length of the arrow of the true heading, metres


def plot_comparison(path: Union[str, Path], errors: Sequence[ErrorStatistics]) -> None:
    """Plots absolute mean, 95 % and worst error of each method at each place, and the share of images with a
    pose.

    :param path: image file; the ending selects the format (.png, .pdf, .svg)
    :param errors: result of error_statistics(), not empty
    :raises OSError: the file cannot be written; an existing one is unchanged
    :raises ValueError: the ending is not an image format
    """
    figure = new_figure(path, 13, 7.5)
    panels = list(figure.subplots(2, 3).flat)
    for axes, quantity in zip(panels, SHOWN_QUANTITIES):
        _draw_quantity(axes, errors, QUANTITIES.index(quantity))
    _draw_shares(panels[-1], errors)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=len(labels), frameon=False)
    figure.suptitle(
        "bar: 95 % of the absolute errors; dot: absolute mean error; line: to the worst error", fontsize=11
    )
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.15, top=0.9, wspace=0.2, hspace=0.42)
    save_figure(path, figure)


def _draw_quantity(axes: Axes, errors: Sequence[ErrorStatistics], index: int) -> None:
    scale = QUANTITY_SCALES[index]
    drawn = []
    for of_method, shift, colour in _by_method(errors):
        values = np.array([[abs(each.mean[index]), each.p95[index], each.worst[index]] for each in of_method])
        mean, p95, worst = scale * values.T
        x = np.arange(len(of_method)) + shift
        axes.bar(x, p95, _bar_width(errors), color=colour, alpha=0.4)
        known = np.isfinite(worst)
        axes.vlines(x[known], p95[known], worst[known], color=colour, linewidth=1)
        axes.plot(x, worst, "_", color=colour, markersize=6)
        axes.plot(x, mean, "o", color=colour, markersize=4, label=of_method[0].method or "error")
        drawn.append(scale * values[known])
    _finish(axes, errors, f"{QUANTITIES[index]} error, {QUANTITIES_SHOWN[index]}")
    _limit(axes, np.concatenate(drawn))


def _limit(axes: Axes, values: np.ndarray) -> None:
    """:param values: (N, 3) absolute mean, 95 % and worst error"""
    if len(values) == 0:
        axes.text(0.5, 0.5, "true value unknown", transform=axes.transAxes, ha="center")
        return
    _, p95, worst = values.T
    axes.set_ylim(0.0, max(1.1 * worst.max(), 1e-6))
    if worst.max() > OUTLIER * np.median(p95):
        axes.set_yscale("log")
        axes.set_ylim(0.1 * max(float(p95.min()), 1e-3), 2.0 * worst.max())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())


def _bar_width(errors: Sequence[ErrorStatistics]) -> float:
    return 0.9 * WIDTH / len({each.method for each in errors})


def _draw_shares(axes: Axes, errors: Sequence[ErrorStatistics]) -> None:
    for of_method, shift, colour in _by_method(errors):
        shares = np.array([100.0 * each.share for each in of_method])
        axes.bar(np.arange(len(shares)) + shift, shares, _bar_width(errors), color=colour, alpha=0.7)
    _finish(axes, errors, "images with a pose, %")
    axes.set_ylim(0.0, 105.0)
    if not any(np.isfinite(each.share) for each in errors):
        axes.text(0.5, 0.5, "number of images unknown", transform=axes.transAxes, ha="center")


def _by_method(errors: Sequence[ErrorStatistics]):
    """Yields the errors of each method, its horizontal shift from the place, and its colour."""
    methods = list(dict.fromkeys(each.method for each in errors))
    for number, (method, colour) in enumerate(zip(methods, cycle(COLOURS))):
        shift = WIDTH * ((number + 0.5) / len(methods) - 0.5)
        yield [each for each in errors if each.method == method], shift, colour


def _finish(axes: Axes, errors: Sequence[ErrorStatistics], title: str) -> None:
    places = list(dict.fromkeys(each.place for each in errors))
    axes.set_title(title)
    axes.set_xticks(range(len(places)))
    axes.set_xticklabels([place.replace("point ", "") for place in places])
    axes.set_xlim(-0.6, len(places) - 0.4)
    if places[0].startswith("point"):
        axes.set_xlabel("point")
    axes.axvline(places.index(ALL) - 0.5, color="#999999", linewidth=1)
    axes.grid(axis="y", which="major", alpha=0.4)


def plot_points(
    path: Union[str, Path], statistics: Sequence[SeriesStatistics], markers: Sequence = ()
) -> None:
    """Plots the surveyed points with the poses of each method from above, and the horizontal errors.

    :param statistics: of surveyed points; those without a known x and y are not drawn
    :param markers: sextant.MappedMarker of the map

    Other parameters and errors as plot_comparison().
    """
    figure = new_figure(path, 13, 6.5)
    above, errors = figure.subplots(1, 2)
    known = [each for each in statistics if np.isfinite(each.truth[:2]).all()]
    methods = dict(zip(dict.fromkeys(each.method for each in statistics), cycle(COLOURS)))
    _draw_top_view(above, known, methods, markers)
    _draw_horizontal_errors(errors, known, methods)
    figure.subplots_adjust(left=0.05, right=0.985, bottom=0.13, top=0.93, wspace=0.14)
    save_figure(path, figure)


def _draw_top_view(
    axes: Axes, statistics: Sequence[SeriesStatistics], colours: Dict[str, str], markers: Sequence
) -> None:
    for each in statistics:
        axes.plot(*_some(each)[:, :2].T, ".", color=colours[each.method], markersize=3, alpha=0.6)
    for number, truth in {each.distance: each.truth for each in statistics}.items():
        _draw_point(axes, f"{number:g}", truth)
    for marker in markers:
        draw_marker(axes, marker)
    # Limits from truth and map only: outliers must not enlarge them.
    shown = [each.truth[:2] for each in statistics] + [marker.T_map_marker[:2, 3] for marker in markers]
    low, high = np.min(shown, axis=0) - MARGIN, np.max(shown, axis=0) + MARGIN
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x, m", ylabel="y, m", aspect="equal")
    axes.set_title("true points (+, with the heading) and poses (dots), from above")
    axes.grid(alpha=0.3)


def _draw_point(axes: Axes, name: str, truth: np.ndarray) -> None:
    """Draws a true pose: a cross, its heading, and its name behind it."""
    position, yaw = truth[:2], truth[AXES.index("yaw")]
    axes.plot(*position, "+", color="black", markersize=8)
    ahead = HEADING * np.array([np.cos(yaw), np.sin(yaw)])
    if np.isfinite(yaw):
        axes.plot(*np.transpose([position, position + ahead]), color="black", linewidth=1)
    behind = position - 0.6 * np.nan_to_num(ahead, nan=-0.5 * HEADING)
    axes.text(*behind, name, ha="center", va="center", clip_on=True)


def _draw_horizontal_errors(
    axes: Axes, statistics: Sequence[SeriesStatistics], colours: Dict[str, str]
) -> None:
    differences: List[np.ndarray] = [np.zeros((1, 2))]
    for method, colour in colours.items():
        of = [100.0 * (_some(each) - each.truth)[:, :2] for each in statistics if each.method == method]
        errors = np.concatenate([np.empty((0, 2)), *of])
        axes.plot(*errors.T, ".", color=colour, markersize=3, alpha=0.5, label=method or "poses")
        differences.append(errors)
    # Most errors fill the panel: outliers must not enlarge it.
    limit = max(1.3 * float(np.percentile(np.abs(np.concatenate(differences)), 97.0)), 0.1)
    outside = sum(int((np.abs(each) > limit).any(axis=1).sum()) for each in differences)
    axes.set(xlim=(-limit, limit), ylim=(-limit, limit), aspect="equal")
    axes.set(xlabel="x error, cm", ylabel="y error, cm", title=f"errors of all poses; {outside} are outside")
    axes.axhline(0.0, color="black", linewidth=1)
    axes.axvline(0.0, color="black", linewidth=1)
    axes.grid(alpha=0.3)
    below = dict(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncol=len(colours), frameon=False)
    axes.legend(**below, markerscale=3)


def _some(of: SeriesStatistics) -> np.ndarray:
    return of.poses[:: 1 + of.count // DOTS]
