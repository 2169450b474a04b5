# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of poses by method and place, and of each method at all places together."""

from dataclasses import dataclass
from typing import List, Optional, Sequence

import numpy as np

from sextant.evaluation.pose_series import AXES, UNITS, SeriesStatistics

QUANTITIES = ("position", *AXES)  # position: distance from the true position
QUANTITY_UNITS = ("m", *UNITS)
ALL = "all"  # in place of a point or distance


@dataclass(frozen=True)
class ErrorStatistics:
    """Errors of one method at one place or at all places: (7,) arrays in the order of QUANTITIES, metres and
    radians. NaN: no pose, or the true value is unknown."""

    method: str  # mode of the locator or topic; empty: the only one
    place: str  # label of the distance or point, or ALL
    poses: int  # number of poses
    images: Optional[int]  # number of images, with and without a pose; None: unknown
    mean: np.ndarray  # of the errors with their sign (estimate - truth)
    std: np.ndarray  # standard deviations of the errors, divided by N - 1
    p95: np.ndarray  # 95th percentiles of the absolute errors, linearly interpolated
    worst: np.ndarray  # largest absolute errors

    @property
    def label(self) -> str:
        """The method, if several are compared, and the place."""
        return f"{self.method} {self.place}".strip()

    @property
    def share(self) -> float:
        """Share of the images with a pose, 0 to 1; NaN: unknown."""
        return self.poses / self.images if self.images else np.nan


def error_statistics(statistics: Sequence[SeriesStatistics]) -> List[ErrorStatistics]:
    """Computes the errors of each series; those of a method are followed by its errors at ALL places."""
    result = []
    for method in dict.fromkeys(each.method for each in statistics):
        of_method = [each for each in statistics if each.method == method]
        result += [_statistics(method, each.place, [each]) for each in of_method]
        result.append(_statistics(method, ALL, of_method))
    return result


def overall(errors: Sequence[ErrorStatistics]) -> List[ErrorStatistics]:
    """Selects the errors at ALL places, one per method."""
    return [each for each in errors if each.place == ALL]


def _statistics(method: str, place: str, statistics: Sequence[SeriesStatistics]) -> ErrorStatistics:
    errors = np.concatenate([_errors(each) for each in statistics])
    images = [each.images for each in statistics if each.images is not None]
    count, nothing = len(errors), np.full(len(QUANTITIES), np.nan)
    return ErrorStatistics(
        method, place, count, sum(images) if len(images) == len(statistics) else None,
        mean=errors.mean(axis=0) if count else nothing,
        std=errors.std(axis=0, ddof=1) if count > 1 else nothing,
        p95=np.percentile(np.abs(errors), 95.0, axis=0) if count else nothing,
        worst=np.abs(errors).max(axis=0) if count else nothing,
    )  # fmt: skip


def _errors(of: SeriesStatistics) -> np.ndarray:
    """Returns the errors (N, 7) in the order of QUANTITIES."""
    errors = of.poses - of.truth
    return np.column_stack([np.linalg.norm(errors[:, :3], axis=1), errors])


def position_table(errors: Sequence[ErrorStatistics]) -> List[str]:
    """Formats the position errors, and the share of images with a pose, as lines; centimetres."""
    width = max(len(each.label) for each in errors)
    columns = ("mean", "deviation", "95 %", "worst")
    heading = "".join(f"{name:>11}" for name in columns)
    lines = [f"{'':{width}}{heading}   position error, cm; images with a pose"]
    for each in errors:
        values = (each.mean[0], each.std[0], each.p95[0], each.worst[0])
        cells = "".join(f"{'-' if np.isnan(value) else format(100.0 * value, '.2f'):>11}" for value in values)
        lines.append(f"{each.label:{width}}{cells}   {share_text(each)}")
    return lines


def share_text(of: ErrorStatistics) -> str:
    """Formats the number of poses and their share of the images."""
    if of.images is None:
        return f"{of.poses} poses"
    percent = "-" if np.isnan(of.share) else f"{100.0 * of.share:.1f} %"
    return f"{of.poses} of {of.images} ({percent})"
