# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a trajectory is compared with a truth that has stamps, and perhaps a frame, of its own.

In this order: interpolated_truth() gives the truth at the estimate's stamps; with
alignment() and aligned(), where the frames differ, the estimate goes into the truth's frame;
sextant.evaluation.trajectory.trajectory_errors() and summarize() are the absolute trajectory error (ATE),
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
from sextant.geometry.poses import LONGEST_GAP, interpolated_poses

NANOSECONDS = 1e9
ROUNDING = 1e-9  # of sums of steps, as a part of delta
TOLERANCE = 0.1  # of delta that a pair may be longer or shorter; frames are exact
RPE = (1.0, "metres")  # delta and unit, where nobody asks for others
CONFIDENCE = 0.95  # that the mean NEES of honest covariances is within the band
LINE = 1e-6  # a drive whose width is less than a thousandth of its length does not tell how it is rolled


@dataclass(frozen=True)
class RelativeErrors:
    """Errors of the motion between two stamps, a row a pair, in the order of the first stamp."""

    stamps: np.ndarray  # (N, 2) int64, nanoseconds
    position: np.ndarray  # (N,) metres
    angle: np.ndarray  # (N,) radians, [0, pi]


@dataclass(frozen=True)
class Nees:
    """Normalized estimation errors squared, and where their mean lies if the covariances are honest."""

    values: np.ndarray  # (N,) in the order of the stamps; each has the mean 6
    mean: float  # NaN without samples
    band: Tuple[float, float]  # of the mean; NaN without samples

    @property
    def consistent(self) -> bool:
        """The mean is within the band: above it the covariances are too small, below it too large."""
        return self.band[0] <= self.mean <= self.band[1]


def interpolated_truth(truth: Trajectory, stamps: Iterable[int]) -> Trajectory:
    """The truth at other stamps: straight between positions, rotations at a constant rate (slerp).

    :param stamps: nanoseconds; one outside of the truth has none, nothing is extrapolated
    :raises ValueError: a pose that is not finite
    """
    known, at = np.array(sorted(truth), dtype=np.int64), np.array(sorted(set(stamps)), dtype=np.int64)
    found = interpolated_poses(known, _poses(truth, known), at, LONGEST_GAP)
    return {int(stamp): T for stamp, T in zip(at, found) if T is not None}


def alignment(truth: Trajectory, estimate: Trajectory) -> np.ndarray:
    """T_truth_estimate (4x4) that brings the positions of the common stamps closest together (Umeyama 1991,
    eq. 34-43, without scale).

    For a truth in a frame of its own. Where both are in the map's frame, aligning hides the map's error.

    :raises ValueError: fewer than three poses, or poses on a line, which do not tell a rotation
    """
    stamps = _common(truth, estimate)
    _require(len(stamps) >= 3, f"{len(stamps)} poses with a truth: three at least tell how to align them")
    to, of = (_poses(each, stamps)[:, :3, 3] for each in (truth, estimate))
    u, d, vt = np.linalg.svd((to - to.mean(axis=0)).T @ (of - of.mean(axis=0)) / len(stamps))
    _require(d[1] > LINE * d[0], "the poses lie on a line, or do not move: they do not tell a rotation")
    T = np.eye(4)
    T[:3, :3] = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))]) @ vt
    T[:3, 3] = to.mean(axis=0) - T[:3, :3] @ of.mean(axis=0)
    return T


def aligned(T_truth_estimate: np.ndarray, estimate: Trajectory) -> Trajectory:
    """The trajectory in the truth's frame."""
    return {stamp: T_truth_estimate @ T for stamp, T in estimate.items()}


def aligned_covariances(
    T_truth_estimate: np.ndarray, covariances: Mapping[int, np.ndarray]
) -> Dict[int, np.ndarray]:
    """Covariances (6x6, order x y z roll pitch yaw) in the axes of the truth's frame, not the estimate's."""
    turn = np.kron(np.eye(2), T_truth_estimate[:3, :3])
    return {stamp: turn @ np.asarray(each) @ turn.T for stamp, each in covariances.items()}


def relative_errors(
    truth: Trajectory, estimate: Trajectory, delta: float, unit: str = "frames"
) -> RelativeErrors:
    """Relative pose errors E = inverse(inverse(Q_i) Q_j) inverse(P_i) P_j (Sturm et al., eq. 1) of the truth
    Q and the estimate P at the stamps that they share, from every pose to the one nearest to delta farther
    on, as the TUM benchmark. No alignment changes them.

    :param delta: from i to j, > 0
    :param unit: "frames" (that have both poses), "seconds", or "metres" of the truth's path
    :returns: no row where the drive is too short
    :raises ValueError: an unknown unit, a delta that is none (frames: a whole number), a pose not finite
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


# How far along the drive each of N poses is, by unit.
_PROGRESS: Mapping[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "frames": lambda stamps, _: np.arange(len(stamps), dtype=float),
    "seconds": lambda stamps, _: (stamps - stamps[:1]) / NANOSECONDS,
    "metres": _path,
}
RPE_UNITS = tuple(_PROGRESS)


def _all_pairs(progress: np.ndarray, delta: float, slack: float) -> np.ndarray:
    """(M, 2) from each pose to the one nearest to delta farther on, the first where the robot stood."""
    if len(progress) == 0:
        return np.empty((0, 2), dtype=int)
    wanted = progress + delta
    above = np.searchsorted(progress, wanted).clip(1, len(progress) - 1)
    nearer_below = wanted - progress[above - 1] <= np.abs(progress[above] - wanted)
    last = np.searchsorted(progress, progress[np.where(nearer_below, above - 1, above)])
    fits = np.abs(progress[last] - wanted) <= slack + ROUNDING * delta
    return np.stack([np.flatnonzero(fits), last[fits]], axis=1)


def nees(truth: Trajectory, estimate: Trajectory, covariances: Mapping[int, np.ndarray]) -> Nees:
    """Normalized estimation errors squared e' inverse(P) e of the stamps that all three share, with e =
    sextant.pose_error(): position difference, and delta with R_true = Exp(delta) R_est, in the map's axes.

    The band is of N independent samples; poses of neighbouring frames are not quite independent.

    :param covariances: P by stamp, 6x6, order x y z roll pitch yaw
    :raises ValueError: a covariance that is not positive, a pose that is not finite
    """
    stamps = [stamp for stamp in _common(truth, estimate) if stamp in covariances]
    poses = zip(stamps, _poses(truth, stamps), _poses(estimate, stamps))
    values = [_nees_at(stamp, true, told, covariances[stamp]) for stamp, true, told in poses]
    mean = float(np.mean(values)) if values else np.nan
    return Nees(np.array(values, dtype=float), mean, nees_band(len(values)))


def _nees_at(stamp: int, truth: np.ndarray, estimate: np.ndarray, covariance: np.ndarray) -> float:
    try:
        root = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        raise ValueError(f"the covariance at {stamp} ns is not positive: there is no NEES") from None
    whitened = np.linalg.solve(root, sextant.pose_error(truth, estimate))
    return float(whitened @ whitened)


def nees_band(samples: int) -> Tuple[float, float]:
    """Band of the mean of so many NEES: chi-square of 6 degrees each, divided by samples."""
    if samples == 0:
        return np.nan, np.nan
    low, high = chi2.ppf([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], samples * 6) / samples
    return float(low), float(high)


def _common(truth: Trajectory, estimate: Trajectory) -> List[int]:
    return sorted(set(truth) & set(estimate))


def _poses(trajectory: Trajectory, stamps: Sequence[int]) -> np.ndarray:
    """(N, 4, 4), all of them finite."""
    poses = np.array([trajectory[stamp] for stamp in stamps], dtype=float).reshape(-1, 4, 4)
    for wrong in np.flatnonzero(~np.isfinite(poses).all(axis=(1, 2))):
        raise ValueError(f"the pose at {stamps[wrong]} ns is not finite")
    return poses


def _require(condition: bool, reason: str) -> None:
    if not condition:
        raise ValueError(reason)
