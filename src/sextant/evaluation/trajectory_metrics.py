# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a trajectory with ground truth that has other stamps, and possibly another frame.

In this order: interpolated_truth() interpolates the truth at the stamps of the estimate; alignment() and
aligned() transform the estimate to the frame of the truth, if they differ; trajectory_errors() and
summarize() compute the absolute trajectory error (ATE), relative_errors() the relative pose error (RPE).

Sources: Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems" (association, ATE, RPE);
Zhang and Scaramuzza 2018, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry";
Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns".
"""

from dataclasses import dataclass
from typing import Callable, Dict, Iterable, Mapping

import numpy as np

import sextant
from sextant.evaluation.trajectory import Trajectory, common_stamps, finite_poses
from sextant.geometry.poses import MAX_GAP, interpolated_poses

NANOSECONDS = 1e9
ROUNDING = 1e-9  # rounding error of the path length, fraction of delta
TOLERANCE = 0.1  # of the interval of a pair, fraction of delta; frames are exact
RPE = (1.0, "metres")  # default delta and unit
LINE = 1e-6  # ratio of singular values below which positions are collinear: width 1/1000 of the length


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

    mean: float  # arithmetic mean
    p95: float  # 95th percentile, linearly interpolated
    worst: float  # maximum
    median: float = np.nan  # 50th percentile
    rmse: float = np.nan  # root of the mean square


@dataclass(frozen=True)
class RelativeErrors:
    """Relative pose errors, one row per pair of stamps, by ascending first stamp."""

    stamps: np.ndarray  # (N, 2) int64, nanoseconds
    position: np.ndarray  # (N,) metres
    angle: np.ndarray  # (N,) radians, [0, pi]


def interpolated_truth(truth: Trajectory, stamps: Iterable[int]) -> Trajectory:
    """Interpolates the truth at other stamps: positions linearly, rotations at constant speed (slerp).

    :param stamps: nanoseconds; those outside of the truth are omitted
    :raises ValueError: a pose is not finite
    """
    known, at = np.array(sorted(truth), dtype=np.int64), np.array(sorted(set(stamps)), dtype=np.int64)
    found = interpolated_poses(known, finite_poses(truth, known), at, MAX_GAP)
    return {int(stamp): T for stamp, T in zip(at, found) if T is not None}


def alignment(truth: Trajectory, estimate: Trajectory) -> np.ndarray:
    """Computes T_truth_estimate (4, 4) that minimizes the distances of positions at common stamps (Umeyama
    1991, eq. 34-43, without scale).

    Use it for truth in its own frame. If both are in the map frame, alignment hides the error of the map.

    :raises ValueError: fewer than three poses, or collinear positions, which do not determine a rotation
    """
    stamps = common_stamps(truth, estimate)
    _require(len(stamps) >= 3, f"{len(stamps)} poses with ground truth: alignment needs at least three")
    to, of = (finite_poses(each, stamps)[:, :3, 3] for each in (truth, estimate))
    u, d, vt = np.linalg.svd((to - to.mean(axis=0)).T @ (of - of.mean(axis=0)) / len(stamps))
    _require(d[1] > LINE * d[0], "positions are collinear or equal: they do not determine a rotation")
    T = np.eye(4)
    T[:3, :3] = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt
    T[:3, 3] = to.mean(axis=0) - T[:3, :3] @ of.mean(axis=0)
    return T


def start_alignment(reference: Trajectory, estimate: Trajectory) -> np.ndarray:
    """Computes T_reference_estimate, (4, 4), that puts the first pose with a reference at its time on it.

    :raises ValueError: there is none
    """
    at = interpolated_truth(reference, estimate)
    if not at:
        raise ValueError("no pose can be aligned: there is no other pose at its time")
    first = min(at)
    return at[first] @ np.linalg.inv(estimate[first])


def aligned(T_truth_estimate: np.ndarray, estimate: Trajectory) -> Trajectory:
    """Transforms a trajectory to the frame of the truth."""
    return {stamp: T_truth_estimate @ T for stamp, T in estimate.items()}


def aligned_covariances(
    T_truth_estimate: np.ndarray, covariances: Mapping[int, np.ndarray]
) -> Dict[int, np.ndarray]:
    """Rotates covariances (6x6, order x y z roll pitch yaw) from the estimate's to the truth's axes."""
    turn = np.kron(np.eye(2), T_truth_estimate[:3, :3])
    return {stamp: turn @ np.asarray(each) @ turn.T for stamp, each in covariances.items()}


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


def relative_errors(
    truth: Trajectory, estimate: Trajectory, delta: float, unit: str = "frames"
) -> RelativeErrors:
    """Computes relative pose errors E = inverse(inverse(Q_i) Q_j) inverse(P_i) P_j (Sturm et al., eq. 1) of
    truth Q and estimate P at common stamps. Pose j is the one closest to delta after i, as in the TUM
    benchmark. They do not depend on an alignment.

    :param delta: interval from i to j, > 0
    :param unit: "frames" (with both poses), "seconds", or "metres" of the true path
    :returns: no rows if the drive is too short
    :raises ValueError: unknown unit, invalid delta (frames: a whole number), or a pose that is not finite
    """
    _require(unit in _PROGRESS, f"the unit is '{unit}', allowed are {', '.join(_PROGRESS)}")
    _require(0.0 < delta < np.inf, f"delta is {delta} {unit}, it must be above 0")
    _require(unit != "frames" or float(delta).is_integer(), f"delta is {delta} frames, not a whole number")
    stamps = np.array(common_stamps(truth, estimate), dtype=np.int64)
    Q, P = finite_poses(truth, stamps), finite_poses(estimate, stamps)
    progress = _PROGRESS[unit](stamps, Q[:, :3, 3])
    i, j = _all_pairs(progress, delta, 0.0 if unit == "frames" else TOLERANCE * delta).T
    E = np.linalg.solve(np.linalg.solve(Q[i], Q[j]), np.linalg.solve(P[i], P[j]))
    return RelativeErrors(
        stamps=np.stack([stamps[i], stamps[j]], axis=1),
        position=np.linalg.norm(E[:, :3, 3], axis=1),
        angle=np.array([np.linalg.norm(sextant.log_so3(each[:3, :3])) for each in E]),
    )


def _path(_stamps: np.ndarray, positions: np.ndarray) -> np.ndarray:
    return np.cumsum(np.linalg.norm(np.diff(positions, axis=0, prepend=positions[:1]), axis=1))


# Progress (N,) along the drive, by unit.
_PROGRESS: Mapping[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "frames": lambda stamps, _: np.arange(len(stamps), dtype=float),
    "seconds": lambda stamps, _: (stamps - stamps[:1]) / NANOSECONDS,
    "metres": _path,
}
RPE_UNITS = tuple(_PROGRESS)


def _all_pairs(progress: np.ndarray, delta: float, slack: float) -> np.ndarray:
    """Returns index pairs (M, 2) of each pose and the one closest to delta later; the first of equal ones."""
    if len(progress) == 0:
        return np.empty((0, 2), dtype=int)
    wanted = progress + delta
    above = np.searchsorted(progress, wanted).clip(1, len(progress) - 1)
    nearer_below = wanted - progress[above - 1] <= np.abs(progress[above] - wanted)
    last = np.searchsorted(progress, progress[np.where(nearer_below, above - 1, above)])
    fits = np.abs(progress[last] - wanted) <= slack + ROUNDING * delta
    return np.stack([np.flatnonzero(fits), last[fits]], axis=1)


def _require(condition: bool, reason: str) -> None:
    if not condition:
        raise ValueError(reason)
