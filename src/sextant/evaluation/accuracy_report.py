# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy report of pose series: a table, and files."""

from functools import partial
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence

import numpy as np

from sextant.base.atomic_file import atomic_files
from sextant.evaluation.accuracy_page import write_page
from sextant.evaluation.accuracy_plots import plot_errors, plot_spread
from sextant.evaluation.accuracy_workbook import write_workbook
from sextant.evaluation.accuracy_yaml import (
    CornerNoise,
    constant_covariance,
    write_constant_covariance,
    write_corner_noise,
)
from sextant.evaluation.comparison_plots import plot_comparison, plot_points
from sextant.evaluation.error_statistics import error_statistics
from sextant.evaluation.pose_series import POINT, PoseSeries, SeriesStatistics


class AccuracyFiles(NamedTuple):
    """Files of a report."""

    workbook: Path  # all figures
    page: Path  # HTML with tables and plots
    errors: Path  # plot of one method
    spread: Path  # plot of one method
    comparison: Path  # plot of several methods
    points: Path  # plot of surveyed points
    noise: Path  # parameter corner_sigma of the locator
    constant: Path  # parameter constant_covariance of the locator

    @classmethod
    def named(cls, name: Path) -> "AccuracyFiles":
        """Returns the files with a common prefix, e.g. accuracy.xlsx, accuracy_errors.png, ..."""
        endings = (".xlsx", ".html", "_errors.png", "_spread.png", "_comparison.png", "_points.png", ".yaml")
        return cls(*(name.with_name(name.name + ending) for ending in (*endings, "_constant.yaml")))


def write_accuracy(
    files: AccuracyFiles,
    series: Sequence[PoseSeries],
    statistics: Sequence[SeriesStatistics],
    noise: Optional[CornerNoise],
    markers: Sequence = (),
) -> List[str]:
    """Writes all files atomically.

    :param noise: None: not measured, its file is not written
    :param markers: sextant.MappedMarker of the map, for the plot of surveyed points
    :returns: lines that list the written files, and files left from an earlier run
    :raises OSError: a file cannot be written
    :raises ValueError: as write_workbook()
    """
    with atomic_files(files.workbook.parent) as folder:
        within = AccuracyFiles(*(folder / path.name for path in files))
        write_workbook(within.workbook, series, statistics)
        plots = _write_plots(within, statistics, markers)
        notes = [] if noise is None else [f"Corner noise: {noise.sigma:.3g} px. {noise.measured}"]
        write_page(within.page, series, statistics, plots, notes)
        lines = [
            f"{files.workbook}: every pose, mean, deviation, bias, RMSE and covariance",
            f"{files.page}: page with tables and plots",
            f"{', '.join(str(files.page.with_name(plot.name)) for plot in plots)}: plots",
        ]
        if noise is not None:
            write_corner_noise(within.noise, noise)
            lines.append(f"{files.noise}: corner noise of this camera; load it with rosparam for the locator")
        lines.append(_write_constant(within.constant, files.constant, statistics, series[0].frame))
        older = [path for path, made in zip(files, within) if path.exists() and not made.exists()]
    return lines + [f"{path}: left from an earlier run" for path in older]


def _write_plots(
    files: AccuracyFiles, statistics: Sequence[SeriesStatistics], markers: Sequence
) -> List[Path]:
    plots: Dict[Path, Callable[[Path], None]] = {}
    if len({each.method for each in statistics}) > 1:
        plots[files.comparison] = partial(plot_comparison, errors=error_statistics(statistics))
    else:
        plots[files.errors] = partial(plot_errors, statistics=statistics)
        plots[files.spread] = partial(plot_spread, statistics=statistics)
    if statistics[0].axis == POINT:
        plots[files.points] = partial(plot_points, statistics=statistics, markers=markers)
    for path, plot in plots.items():
        plot(path)
    return list(plots)


def _write_constant(path: Path, target: Path, statistics: Sequence[SeriesStatistics], frame: str) -> str:
    try:
        if len({each.method for each in statistics}) > 1:
            raise ValueError("several methods were compared, evaluate one of them")
        write_constant_covariance(path, constant_covariance(statistics, frame))
    except ValueError as error:
        return f"no constant covariance: {error}"
    return f"{target}: one covariance for all poses, in the axes of '{frame}'"


def accuracy_table(statistics: Sequence[SeriesStatistics]) -> List[str]:
    """Formats bias, deviation and published deviation of the position by distance, as lines; millimetres."""
    width = max(10, *(len(each.label) for each in statistics))
    heading = [f"{'':>{width}} {'':>6}", *(f"{name:>26}" for name in ("bias", "deviation", "published"))]
    lines = ["".join(heading) + "   x y z, mm"]
    for each in statistics:
        blocks = (each.bias, each.std, each.published)
        lines.append(f"{each.label:>{width}} {each.count:>6}" + "".join(map(_millimetres, blocks)))
    return lines


def _millimetres(values: np.ndarray) -> str:
    return "  " + "".join(f"{'-' if np.isnan(v) else format(1000.0 * v, '.1f'):>8}" for v in values[:3])
