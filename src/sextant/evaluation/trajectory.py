# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of a series of poses against the truth, frame by frame, as numbers and as a table.

A trajectory is a dictionary from the stamp of a frame in nanoseconds to T_map_base, a 4x4 array in metres.
"""

from dataclasses import dataclass
from typing import Dict, Mapping

import numpy as np

import sextant

Trajectory = Dict[int, np.ndarray]


@dataclass(frozen=True)
class TrajectoryErrors:
    """Errors of the frames that had a pose, in the order of their stamps."""

    stamps: np.ndarray  # (N,) int64, nanoseconds
    position: np.ndarray  # (N,) distance to the true position, metres
    angle: np.ndarray  # (N,) angle of the rotation between true and estimated, radians, [0, pi]
    frames: int  # frames with a truth, with or without a pose


@dataclass(frozen=True)
class ErrorSummary:
    """Of a series, in its unit; NaN without samples."""

    mean: float
    p95: float  # 95th percentile, linear between samples
    worst: float
    median: float = np.nan
    rmse: float = np.nan  # root of the mean square


def seconds_text(stamp: int) -> str:
    """Of nanoseconds. A text: a spreadsheet's numbers have 15 digits, today's stamps 19."""
    return f"{stamp // 10**9}.{stamp % 10**9:09d}"


def trajectory_errors(truth: Trajectory, estimate: Trajectory) -> TrajectoryErrors:
    """Errors of an estimate at the stamps that it shares with the truth.

    :raises ValueError: a pose has a stamp that no truth has; a silently dropped pose would flatter
    """
    unknown = sorted(set(estimate) - set(truth))
    if unknown:
        raise ValueError(f"{len(unknown)} poses without a truth of their stamp, the first at {unknown[0]} ns")
    stamps = sorted(estimate)
    errors = np.array([sextant.pose_error(truth[stamp], estimate[stamp]) for stamp in stamps]).reshape(-1, 6)
    return TrajectoryErrors(
        stamps=np.array(stamps, dtype=np.int64),
        position=np.linalg.norm(errors[:, :3], axis=1),
        angle=np.linalg.norm(errors[:, 3:], axis=1),
        frames=len(truth),
    )


def summarize(values: np.ndarray) -> ErrorSummary:
    """Summary of an (N,) array of errors, in its unit."""
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
    """A line a series: mean, 95 % and worst error in cm and degrees, and how many frames had a pose."""
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
