# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accuracy report of pose series: a table, and files."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

from sextant.base.atomic_file import atomic_files
from sextant.evaluation.accuracy_plots import plot_errors, plot_spread
from sextant.evaluation.accuracy_workbook import write_workbook
from sextant.evaluation.accuracy_yaml import (
    CornerNoise,
    constant_covariance,
    write_constant_covariance,
    write_corner_noise,
)
from sextant.evaluation.pose_series import PoseSeries, SeriesStatistics


class AccuracyFiles(NamedTuple):
    """Files of a report."""

    workbook: Path  # all figures
    errors: Path  # plot
    spread: Path  # plot
    noise: Path  # parameter corner_sigma of the locator
    constant: Path  # parameter constant_covariance of the locator

    @classmethod
    def named(cls, name: Path) -> "AccuracyFiles":
        """Returns the files with a common prefix, e.g. accuracy.xlsx, accuracy_errors.png, ..."""
        endings = (".xlsx", "_errors.png", "_spread.png", ".yaml", "_constant.yaml")
        return cls(*(name.with_name(name.name + ending) for ending in endings))


def write_accuracy(
    files: AccuracyFiles,
    series: Sequence[PoseSeries],
    statistics: Sequence[SeriesStatistics],
    noise: Optional[CornerNoise],
) -> List[str]:
    """Writes all files atomically.

    :param noise: None: not measured, its file is not written
    :returns: lines that list the written files, and files left from an earlier run
    :raises OSError: a file cannot be written
    :raises ValueError: as write_workbook()
    """
    with atomic_files(files.workbook.parent) as folder:
        within = AccuracyFiles(*(folder / path.name for path in files))
        write_workbook(within.workbook, series, statistics)
        plot_errors(within.errors, statistics)
        plot_spread(within.spread, statistics)
        lines = [
            f"{files.workbook}: every pose, mean, deviation, bias, RMSE and covariance",
            f"{files.errors}, {files.spread}: plots",
        ]
        if noise is not None:
            write_corner_noise(within.noise, noise)
            lines.append(f"{files.noise}: corner noise of this camera; load it with rosparam for the locator")
        lines.append(_write_constant(within.constant, files.constant, statistics, series[0].frame))
        older = [path for path, made in zip(files, within) if path.exists() and not made.exists()]
    return lines + [f"{path}: left from an earlier run" for path in older]


def _write_constant(path: Path, target: Path, statistics: Sequence[SeriesStatistics], frame: str) -> str:
    try:
        write_constant_covariance(path, constant_covariance(statistics, frame))
    except ValueError as error:
        return f"no constant covariance: {error}"
    return f"{target}: one covariance for all poses, in the axes of '{frame}'"


def accuracy_table(statistics: Sequence[SeriesStatistics]) -> List[str]:
    """Formats bias, deviation and published deviation of the position by distance, as lines; millimetres."""
    heading = [f"{'':>10} {'':>6}", *(f"{name:>26}" for name in ("bias", "deviation", "published"))]
    lines = ["".join(heading) + "   x y z, mm"]
    for each in statistics:
        blocks = (each.bias, each.std, each.published)
        lines.append(f"{each.label:>10} {each.count:>6}" + "".join(map(_millimetres, blocks)))
    return lines


def _millimetres(values: np.ndarray) -> str:
    return "  " + "".join(f"{'-' if np.isnan(v) else format(1000.0 * v, '.1f'):>8}" for v in values[:3])
