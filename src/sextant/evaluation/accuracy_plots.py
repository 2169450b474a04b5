# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of the accuracy by distance: errors, and spread of the poses against their published covariance.

A distance is the true value of the measured axis, which may be an angle. One panel per axis, in centimetres
and degrees; logarithmic, since errors range from millimetres to a metre.
"""

from pathlib import Path
from typing import Callable, Sequence, Tuple, Union

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from sextant.base.plot_colours import COLOURS
from sextant.base.plot_file import new_figure, save_figure
from sextant.evaluation.pose_series import AXES, POINT, UNIT_OF, SeriesStatistics

BLUE, RED, GREEN, GREY = COLOURS[0], COLOURS[1], COLOURS[2], "#999999"
SCALES = (100.0,) * 3 + (180.0 / np.pi,) * 3  # to the plotted units
SHOWN = ("cm",) * 3 + ("degrees",) * 3  # plotted units
FLOOR = 0.05  # lower limit of a panel, as a fraction of its smallest standard deviation
MIN_FLOOR = 1e-6  # minimum of this limit, centimetres and degrees; smaller values are drawn at the limit
DOTS = 1000  # maximum number of poses drawn per distance

Panel = Callable[[Axes, Sequence[SeriesStatistics], int], None]


def plot_errors(path: Union[str, Path], statistics: Sequence[SeriesStatistics]) -> None:
    """Plots bias, standard deviation and RMSE of every axis over the distance.

    :param path: image file; the ending selects the format (.png, .pdf, .svg)
    :param statistics: one or more per distance, with or without poses
    :raises OSError: the file cannot be written; an existing one is unchanged
    :raises ValueError: no statistics, or the ending is not an image format
    """
    _plot(path, statistics, _draw_errors, "error by distance")


def plot_spread(path: Union[str, Path], statistics: Sequence[SeriesStatistics]) -> None:
    """Plots the poses minus their mean, their standard deviation, and that of the published covariances.

    Parameters and errors as plot_errors().
    """
    _plot(path, statistics, _draw_spread, "spread of the poses by distance")


def _plot(path: Union[str, Path], statistics: Sequence[SeriesStatistics], draw: Panel, title: str) -> None:
    if not statistics:
        raise ValueError("there are no statistics to plot")
    figure = new_figure(path, 13, 7.5)
    statistics = sorted(statistics, key=lambda each: each.distance)
    panels = figure.subplots(2, 3)
    for axis, axes in enumerate(panels.flat):
        draw(axes, statistics, axis)
        _finish(axes, statistics, axis)
    _add_legend(figure, panels.flat, title)
    save_figure(path, figure)


def _draw_errors(axes: Axes, statistics: Sequence[SeriesStatistics], axis: int) -> None:
    distance, bias, std, rmse = _columns(statistics, axis, "bias", "std", "rmse")
    _line(axes, distance, rmse, "s-", color=GREY, markersize=10, linewidth=4, alpha=0.6, label="RMSE")
    _line(axes, distance, std, "o--", color=BLUE, markersize=5, label="standard deviation")
    _line(axes, distance, bias, "-", color=RED, linewidth=1)
    for sign, marker, wrong in ((1.0, "^", "large"), (-1.0, "v", "small")):
        chosen = np.where(np.copysign(1.0, bias) == sign, bias, np.nan)
        _line(axes, distance, chosen, marker, color=RED, markersize=7, label=f"bias, estimate too {wrong}")
    if np.isnan(bias).all() and np.isfinite(std).any():
        axes.text(0.5, 0.03, "true value unknown: no bias", transform=axes.transAxes, ha="center")


def _draw_spread(axes: Axes, statistics: Sequence[SeriesStatistics], axis: int) -> None:
    distance, std, published = _columns(statistics, axis, "std", "published")
    random = np.random.default_rng(0)
    width = _jitter(distance)
    for each in statistics:
        poses = each.poses[:: 1 + each.count // DOTS, axis] if each.count > 1 else np.empty(0)
        at = each.distance + random.uniform(-width, width, len(poses))
        difference = SCALES[axis] * (poses - each.mean[axis])
        _line(axes, at, difference, ".", color=GREY, markersize=2, alpha=0.5)
    axes.plot([], [], ".", color=GREY, label="difference of a pose from the mean")
    _line(axes, distance, std, "o--", color=BLUE, markersize=5, label="standard deviation")
    if any(np.isfinite(each.published).any() for each in statistics):
        _line(
            axes, distance, published, "s-", color=GREEN, markersize=5, label="published standard deviation"
        )


def _columns(statistics: Sequence[SeriesStatistics], axis: int, *names: str) -> Tuple[np.ndarray, ...]:
    """Returns the distances and the named fields in the plotted unit."""
    distances = np.array([each.distance for each in statistics])
    values = [[getattr(each, name)[axis] for each in statistics] for name in names]
    return (distances, *(SCALES[axis] * np.array(each) for each in values))


def _line(axes: Axes, distances: np.ndarray, values: np.ndarray, form: str, **style: object) -> None:
    """Plots absolute values, without NaN; a logarithmic axis has no zero."""
    known = np.isfinite(values)
    axes.plot(distances[known], np.maximum(np.abs(values[known]), np.finfo(float).tiny), form, **style)


def _jitter(distances: np.ndarray) -> float:
    """Returns a fifth of the smallest difference between distances, so that their dots do not overlap."""
    gaps = np.diff(np.unique(distances))
    return 0.2 * float(min(gaps, default=0.5))


def _finish(axes: Axes, statistics: Sequence[SeriesStatistics], axis: int) -> None:
    measured = statistics[0].axis
    xlabel = POINT if measured == POINT else f"true {measured}, {UNIT_OF[measured]}"
    axes.set(yscale="log", title=AXES[axis], ylabel=SHOWN[axis], xlabel=xlabel)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.locator_params(axis="x", nbins=7)
    axes.grid(which="major", alpha=0.4)
    axes.grid(which="minor", alpha=0.12)
    _limit(axes, statistics, axis)
    for each in statistics:
        if each.count == 0:
            axes.axvline(each.distance, color="black", linestyle=":", linewidth=1)
            place = dict(transform=axes.get_xaxis_transform(), rotation=90, va="top", ha="right")
            axes.text(each.distance, 0.97, "no pose", **place)


def _limit(axes: Axes, statistics: Sequence[SeriesStatistics], axis: int) -> None:
    deviations = [SCALES[axis] * each.std[axis] for each in statistics if each.std[axis] > 0.0]
    largest = max((max(line.get_ydata(), default=0.0) for line in axes.lines), default=0.0)
    lowest = max(FLOOR * min(deviations, default=largest), MIN_FLOOR)
    axes.set_ylim(lowest, max(2.0 * largest, 100.0 * lowest))
    for line in axes.lines:
        line.set_ydata(np.maximum(line.get_ydata(), lowest))


def _add_legend(figure: Figure, panels: Sequence[Axes], title: str) -> None:
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=len(labels), frameon=False)
    figure.suptitle(title, fontsize=14)
    figure.subplots_adjust(left=0.06, right=0.985, bottom=0.13, top=0.9, wspace=0.2, hspace=0.34)
