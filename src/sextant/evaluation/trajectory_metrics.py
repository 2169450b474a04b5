# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Compares a trajectory with ground truth that has other stamps, and possibly another frame.

In this order: interpolated_truth() interpolates the truth at the stamps of the estimate; alignment() and
aligned() transform the estimate to the frame of the truth, if they differ;
sextant.evaluation.trajectory.trajectory_errors() and summarize() compute the absolute trajectory error (ATE),
relative_errors() the relative pose error (RPE), nees() the normalized estimation error squared.

Sources: Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems" (association, ATE, RPE);
Zhang and Scaramuzza 2018, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry";
Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns";
Bar-Shalom, Li and Kirubarajan 2001, "Estimation with applications to tracking and navigation", 5.4 (NEES).
"""

from dataclasses import dataclass
from typing import Callable, Dict, Iterable, List, Mapping, Sequence, Tuple

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.evaluation.trajectory import Trajectory
from sextant.geometry.poses import MAX_GAP, interpolated_poses

NANOSECONDS = 1e9
ROUNDING = 1e-9  # rounding error of the path length, fraction of delta
TOLERANCE = 0.1  # of the interval of a pair, fraction of delta; frames are exact
RPE = (1.0, "metres")  # default delta and unit
CONFIDENCE = 0.95  # probability that the mean NEES of consistent covariances is within the band
LINE = 1e-6  # ratio of singular values below which positions are collinear: width 1/1000 of the length


@dataclass(frozen=True)
class RelativeErrors:
    """Relative pose errors, one row per pair of stamps, by ascending first stamp."""

    stamps: np.ndarray  # (N, 2) int64, nanoseconds
    position: np.ndarray  # (N,) metres
    angle: np.ndarray  # (N,) radians, [0, pi]


@dataclass(frozen=True)
class Nees:
    """Normalized estimation errors squared, and the confidence band of their mean."""

    values: np.ndarray  # (N,) by ascending stamp; the expectation is 6
    mean: float  # NaN without samples
    band: Tuple[float, float]  # of the mean if the covariances are consistent; NaN without samples

    @property
    def consistent(self) -> bool:
        """Whether the mean is within the band; above, covariances are too small, below, too large."""
        return self.band[0] <= self.mean <= self.band[1]


def interpolated_truth(truth: Trajectory, stamps: Iterable[int]) -> Trajectory:
    """Interpolates the truth at other stamps: positions linearly, rotations at constant speed (slerp).

    :param stamps: nanoseconds; those outside of the truth are omitted
    :raises ValueError: a pose is not finite
    """
    known, at = np.array(sorted(truth), dtype=np.int64), np.array(sorted(set(stamps)), dtype=np.int64)
    found = interpolated_poses(known, _poses(truth, known), at, MAX_GAP)
    return {int(stamp): T for stamp, T in zip(at, found) if T is not None}


def alignment(truth: Trajectory, estimate: Trajectory) -> np.ndarray:
    """Computes T_truth_estimate (4, 4) that minimizes the distances of positions at common stamps (Umeyama
    1991, eq. 34-43, without scale).

    Use it for truth in its own frame. If both are in the map frame, alignment hides the error of the map.

    :raises ValueError: fewer than three poses, or collinear positions, which do not determine a rotation
    """
    stamps = _common(truth, estimate)
    _require(len(stamps) >= 3, f"{len(stamps)} poses with ground truth: alignment needs at least three")
    to, of = (_poses(each, stamps)[:, :3, 3] for each in (truth, estimate))
    u, d, vt = np.linalg.svd((to - to.mean(axis=0)).T @ (of - of.mean(axis=0)) / len(stamps))
    _require(d[1] > LINE * d[0], "positions are collinear or equal: they do not determine a rotation")
    T = np.eye(4)
    T[:3, :3] = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt
    T[:3, 3] = to.mean(axis=0) - T[:3, :3] @ of.mean(axis=0)
    return T


def aligned(T_truth_estimate: np.ndarray, estimate: Trajectory) -> Trajectory:
    """Transforms a trajectory to the frame of the truth."""
    return {stamp: T_truth_estimate @ T for stamp, T in estimate.items()}


def aligned_covariances(
    T_truth_estimate: np.ndarray, covariances: Mapping[int, np.ndarray]
) -> Dict[int, np.ndarray]:
    """Rotates covariances (6x6, order x y z roll pitch yaw) from the estimate's to the truth's axes."""
    turn = np.kron(np.eye(2), T_truth_estimate[:3, :3])
    return {stamp: turn @ np.asarray(each) @ turn.T for stamp, each in covariances.items()}


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
    stamps = np.array(_common(truth, estimate), dtype=np.int64)
    Q, P = _poses(truth, stamps), _poses(estimate, stamps)
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


def nees(truth: Trajectory, estimate: Trajectory, covariances: Mapping[int, np.ndarray]) -> Nees:
    """Computes normalized estimation errors squared e' inverse(P) e at the common stamps, with e =
    sextant.pose_error(): position difference, and delta with R_true = Exp(delta) R_est, in the map's axes.

    The band is that of N independent samples; poses of consecutive images are slightly correlated.

    :param covariances: P by stamp, 6x6, order x y z roll pitch yaw
    :raises ValueError: a covariance is not positive definite, or a pose is not finite
    """
    stamps = [stamp for stamp in _common(truth, estimate) if stamp in covariances]
    poses = zip(stamps, _poses(truth, stamps), _poses(estimate, stamps))
    values = [_nees_at(stamp, true, estimated, covariances[stamp]) for stamp, true, estimated in poses]
    mean = float(np.mean(values)) if values else np.nan
    return Nees(np.array(values, dtype=float), mean, nees_band(len(values)))


def _nees_at(stamp: int, truth: np.ndarray, estimate: np.ndarray, covariance: np.ndarray) -> float:
    try:
        root = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        raise ValueError(f"the covariance at {stamp} ns is not positive definite: no NEES") from None
    whitened = np.linalg.solve(root, sextant.pose_error(truth, estimate))
    return float(whitened @ whitened)


def nees_band(samples: int) -> Tuple[float, float]:
    """Returns the confidence band of the mean NEES of independent samples: chi-square with 6 degrees each."""
    if samples == 0:
        return np.nan, np.nan
    low, high = chi2.ppf([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], samples * 6) / samples
    return float(low), float(high)


def _common(truth: Trajectory, estimate: Trajectory) -> List[int]:
    return sorted(set(truth) & set(estimate))


def _poses(trajectory: Trajectory, stamps: Sequence[int]) -> np.ndarray:
    """Returns (N, 4, 4).

    :raises ValueError: a pose is not finite
    """
    poses = np.array([trajectory[stamp] for stamp in stamps], dtype=float).reshape(-1, 4, 4)
    for wrong in np.flatnonzero(~np.isfinite(poses).all(axis=(1, 2))):
        raise ValueError(f"the pose at {stamps[wrong]} ns is not finite")
    return poses


def _require(condition: bool, reason: str) -> None:
    if not condition:
        raise ValueError(reason)
