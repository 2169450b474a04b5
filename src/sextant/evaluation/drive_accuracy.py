# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Table and CSV of a drive's ATE, RPE and NEES (computed in trajectory_metrics and nees)."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Mapping, Sequence, Tuple, Union

import numpy as np

import sextant
from sextant.base.atomic_file import atomic_file
from sextant.evaluation.nees import Nees, nees
from sextant.evaluation.trajectory import Trajectory, seconds_text
from sextant.evaluation.trajectory_metrics import (
    RPE,
    ErrorSummary,
    RelativeErrors,
    TrajectoryErrors,
    interpolated_truth,
    relative_errors,
    summarize,
    trajectory_errors,
)

HEADER = ("drive", "stamp", "x", "y", "z", "rx", "ry", "rz", "position", "angle", "nees")


@dataclass(frozen=True)
class DriveAccuracy:
    """Errors of one drive, at the stamps of poses with ground truth."""

    truth: Trajectory  # ground truth
    estimate: Trajectory  # in the frame of truth
    covariances: Dict[int, np.ndarray]  # (6, 6) by stamp, of the poses that have one
    without_truth: int  # number of poses without ground truth, left out
    singular: int  # number of covariances that are not positive definite, left out of the NEES
    absolute: TrajectoryErrors  # ATE
    relative: RelativeErrors  # RPE
    nees: Nees  # of the poses with a covariance


def compare(
    truth: Trajectory,
    stamps: Sequence[int],
    poses: np.ndarray,
    covariances: np.ndarray,
    rpe: Tuple[float, str] = RPE,
) -> DriveAccuracy:
    """Compares poses with ground truth in the same frame, interpolated at their stamps.

    :param stamps: (N,) nanoseconds
    :param poses: (N, 4, 4)
    :param covariances: (N, 6, 6), NaN or zero: none
    :param rpe: delta and unit of relative_errors()
    :raises ValueError: no pose has ground truth; as relative_errors() and nees()
    """
    estimate = {int(stamp): T for stamp, T in zip(stamps, poses)}
    known, singular = _known(stamps, covariances)
    at = interpolated_truth(truth, estimate)
    if not at:
        raise ValueError(f"none of {len(estimate)} poses has ground truth at its time: check the clocks")
    shared = {stamp: T for stamp, T in estimate.items() if stamp in at}
    return DriveAccuracy(
        at, shared, {stamp: P for stamp, P in known.items() if stamp in at},
        len(estimate) - len(shared), singular,
        trajectory_errors(at, shared), relative_errors(at, shared, *rpe), nees(at, shared, known),
    )  # fmt: skip


def _known(stamps: Sequence[int], covariances: np.ndarray) -> Tuple[Dict[int, np.ndarray], int]:
    """Returns the positive definite covariances and the number of others."""
    given = {int(stamp): P for stamp, P in zip(stamps, covariances) if np.isfinite(P).all() and np.any(P)}
    known = {stamp: P for stamp, P in given.items() if _is_positive(P)}
    return known, len(given) - len(known)


def _is_positive(P: np.ndarray) -> bool:
    try:
        np.linalg.cholesky(P)
    except np.linalg.LinAlgError:
        return False
    return True


def drive_table(drives: Mapping[str, DriveAccuracy], rpe: Tuple[float, str]) -> List[str]:
    """Formats ATE, RPE and NEES of every drive, as lines.

    :param rpe: delta and unit of relative_errors()
    """
    delta, unit = rpe
    lines: List[str] = []
    for name, each in drives.items():
        left_out = f", {each.without_truth} without ground truth" if each.without_truth else ""
        lines.append(f"{name}: {len(each.estimate)} poses{left_out}")
        rows = (
            ("ATE, m", each.absolute.position),
            ("ATE, degrees", np.degrees(each.absolute.angle)),
            (f"RPE over {delta:g} {unit}, m", each.relative.position),
            (f"RPE over {delta:g} {unit}, degrees", np.degrees(each.relative.angle)),
        )
        lines += (_row(title, summarize(values), len(values)) for title, values in rows)
        lines.append(_nees_row(each))
    return lines


def _row(title: str, of: ErrorSummary, count: int) -> str:
    if not count:
        return f"  {title:<28} none: the drive is too short"
    means = f"RMSE {of.rmse:.4f}  mean {of.mean:.4f}  median {of.median:.4f}"
    return f"  {title:<28} {means}  95 % {of.p95:.4f}  max {of.worst:.4f}"


def _nees_row(drive: DriveAccuracy) -> str:
    of, singular = drive.nees, f"{drive.singular} covariances are not positive definite"
    if not len(of.values):
        return f"  {'NEES':<28} none: {singular if drive.singular else 'there are no covariances'}"
    verdict = "within" if of.consistent else ("above" if of.mean > of.band[1] else "below")
    text = f"mean {of.mean:.2f} of 6, {verdict} the 95 % band {of.band[0]:.2f} to {of.band[1]:.2f}"
    text += f" of {len(of.values)} independent poses"
    return f"  {'NEES':<28} {text}{f'; {singular}' if drive.singular else ''}"


def write_errors(path: Union[str, Path], drives: Mapping[str, DriveAccuracy]) -> None:
    """Writes a CSV file, one row per pose: stamp (s), error (sextant.pose_error, m and rad), its norms, NEES.

    :raises OSError: the file cannot be written
    """
    with atomic_file(path) as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(HEADER)
        for name, each in drives.items():
            writer.writerows(_rows(name, each))


def _rows(name: str, of: DriveAccuracy) -> List[List[str]]:
    squared = dict(zip([stamp for stamp in sorted(of.estimate) if stamp in of.covariances], of.nees.values))
    rows = []
    for stamp in sorted(of.estimate):
        error = sextant.pose_error(of.truth[stamp], of.estimate[stamp])
        numbers = [*error, np.linalg.norm(error[:3]), np.linalg.norm(error[3:])]
        normalized = f"{squared[stamp]:.6g}" if stamp in squared else ""
        rows.append([name, seconds_text(stamp), *(f"{value:.9g}" for value in numbers), normalized])
    return rows
