# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of a trajectory against ground truth, as numbers and as a table.

A trajectory is a dictionary from the stamp of an image in nanoseconds to T_map_base, a 4x4 array in metres.
"""

from dataclasses import dataclass
from typing import Dict, Mapping

import numpy as np

import sextant

Trajectory = Dict[int, np.ndarray]


@dataclass(frozen=True)
class TrajectoryErrors:
    """Absolute trajectory errors of the images with a pose, by ascending stamp."""

    stamps: np.ndarray  # (N,) int64, nanoseconds
    position: np.ndarray  # (N,) distance to the true position, metres
    angle: np.ndarray  # (N,) rotation angle between truth and estimate, radians, [0, pi]
    frames: int  # number of images with ground truth, with or without a pose


@dataclass(frozen=True)
class ErrorSummary:
    """Statistics of errors, in their unit; NaN without samples."""

    mean: float
    p95: float  # 95th percentile, linearly interpolated
    worst: float  # maximum
    median: float = np.nan
    rmse: float = np.nan  # root of the mean square


def seconds_text(stamp: int) -> str:
    """Formats nanoseconds as seconds. A double has only 15 digits, a stamp 19."""
    return f"{stamp // 10**9}.{stamp % 10**9:09d}"


def trajectory_errors(truth: Trajectory, estimate: Trajectory) -> TrajectoryErrors:
    """Computes the errors of an estimate.

    :raises ValueError: a stamp is not in truth; dropping its pose would hide an error
    """
    unknown = sorted(set(estimate) - set(truth))
    if unknown:
        raise ValueError(f"{len(unknown)} poses without ground truth, the first at {unknown[0]} ns")
    stamps = sorted(estimate)
    errors = np.array([sextant.pose_error(truth[stamp], estimate[stamp]) for stamp in stamps]).reshape(-1, 6)
    return TrajectoryErrors(
        stamps=np.array(stamps, dtype=np.int64),
        position=np.linalg.norm(errors[:, :3], axis=1),
        angle=np.linalg.norm(errors[:, 3:], axis=1),
        frames=len(truth),
    )


def summarize(values: np.ndarray) -> ErrorSummary:
    """Computes the statistics of an (N,) array of errors, in its unit."""
    if len(values) == 0:
        return ErrorSummary(np.nan, np.nan, np.nan)
    return ErrorSummary(
        mean=float(np.mean(values)),
        p95=float(np.percentile(values, 95)),
        worst=float(np.max(values)),
        median=float(np.median(values)),
        rmse=float(np.sqrt(np.mean(np.square(values)))),
    )


def error_table(errors: Mapping[str, TrajectoryErrors]) -> str:
    """Formats mean, 95 % and worst error in cm and degrees and the number of poses, one line per name."""
    width = max(map(len, errors), default=0)
    indent = " " * width
    columns = f"{'mean':>7} {'95 %':>7} {'worst':>8}"
    lines = [
        f"{indent}   position error, cm         angle error, degrees       frames",
        f"{indent} {columns}   {columns}   with a pose",
    ]
    lines += [_table_line(name.ljust(width), series) for name, series in errors.items()]
    return "\n".join(lines)


def _table_line(name: str, errors: TrajectoryErrors) -> str:
    position, angle = summarize(errors.position * 100.0), summarize(np.degrees(errors.angle))
    numbers = "   ".join(f"{each.mean:7.2f} {each.p95:7.2f} {each.worst:8.2f}" for each in (position, angle))
    return f"{name} {numbers}   {len(errors.stamps)} of {errors.frames}"
