# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""All that is told of series of poses: a table, and the files that go with it."""

from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence

import numpy as np

from sextant.base.atomic_file import atomic_files
from sextant.evaluation.accuracy_plots import plot_errors, plot_spread
from sextant.evaluation.accuracy_workbook import write_workbook
from sextant.evaluation.accuracy_yaml import CornerNoise, constant_covariance, write_locator_yaml
from sextant.evaluation.pose_series import PoseSeries, SeriesStatistics


class AccuracyFiles(NamedTuple):
    """Files that one name stands for."""

    workbook: Path
    errors: Path  # picture
    spread: Path  # picture
    noise: Path  # parameters of the locator
    constant: Path  # parameters of the locator, for those who want one covariance for every pose

    @classmethod
    def named(cls, name: Path) -> "AccuracyFiles":
        """E.g. accuracy.xlsx, accuracy_errors.png, ..."""
        endings = (".xlsx", "_errors.png", "_spread.png", ".yaml", "_constant.yaml")
        return cls(*(name.with_name(name.name + ending) for ending in endings))


def write_accuracy(
    files: AccuracyFiles,
    series: Sequence[PoseSeries],
    statistics: Sequence[SeriesStatistics],
    noise: Optional[CornerNoise],
) -> List[str]:
    """Writes the files, all of them or none.

    :param noise: None: not measured, its file is not made
    :returns: what was written, a line a file, and which one that is there is of an earlier run
    :raises OSError: one cannot be written
    :raises ValueError: as write_workbook()
    """
    with atomic_files(files.workbook.parent) as folder:
        within = AccuracyFiles(*(folder / path.name for path in files))
        write_workbook(within.workbook, series, statistics)
        plot_errors(within.errors, statistics)
        plot_spread(within.spread, statistics)
        lines = [
            f"{files.workbook}: every pose, mean, deviation, bias, RMSE and covariance",
            f"{files.errors}, {files.spread}: the same, drawn",
        ]
        if noise is not None:
            write_locator_yaml(within.noise, corner=noise)
            lines.append(f"{files.noise}: corner noise of this camera, for the locator: rosparam load")
        lines.append(_write_constant(within.constant, files.constant, statistics, series[0].frame))
        older = [path for path, made in zip(files, within) if path.exists() and not made.exists()]
    return lines + [f"{path}: is of an earlier run, nothing new was written there" for path in older]


def _write_constant(path: Path, told: Path, statistics: Sequence[SeriesStatistics], frame: str) -> str:
    try:
        write_locator_yaml(path, covariance=constant_covariance(statistics, frame=frame))
    except ValueError as error:
        return f"no constant covariance: {error}"
    return f"{told}: one covariance for all poses, for those who want that; in the axes of '{frame}'"


def accuracy_table(statistics: Sequence[SeriesStatistics]) -> List[str]:
    """Position by distance, millimetres, lines."""
    heading = [f"{'':>10} {'':>6}", *(f"{name:>26}" for name in ("bias", "deviation", "published"))]
    lines = ["".join(heading) + "   x y z, mm"]
    for each in statistics:
        blocks = (each.bias, each.std, each.published)
        lines.append(f"{each.label:>10} {each.count:>6}" + "".join(map(_millimetres, blocks)))
    return lines


def _millimetres(values: np.ndarray) -> str:
    return "  " + "".join(f"{'-' if np.isnan(v) else format(1000.0 * v, '.1f'):>8}" for v in values[:3])
