# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a trajectory is compared with a truth that has stamps, and perhaps a frame, of its own.

In this order: nearest_truth() or interpolated_truth() gives the truth at the estimate's stamps; with
alignment() and aligned(), where the frames differ, the estimate goes into the truth's frame;
sextant.evaluation.trajectory.trajectory_errors() and summarize() are the absolute trajectory error (ATE),
relative_errors() the relative pose error (RPE), nees() the normalized estimation error squared.

Sources: Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems" (association, ATE, RPE);
Zhang and Scaramuzza 2018, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry";
Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns";
Bar-Shalom, Li and Kirubarajan 2001, "Estimation with applications to tracking and navigation", 5.4 (NEES).
"""

import heapq
from dataclasses import dataclass
from typing import Callable, Dict, Iterable, Iterator, List, Mapping, Sequence, Tuple

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.evaluation.trajectory import Trajectory
from sextant.geometry.poses import LONGEST_GAP, interpolated_poses

NANOSECONDS = 1e9
ROUNDING = 1e-9  # of sums of steps, as a part of delta
RPE = (1.0, "metres")  # delta and unit, where nobody asks for others
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


def nearest_truth(truth: Trajectory, estimate: Trajectory, tolerance: float = 0.02) -> Trajectory:
    """The truth of the nearest stamp for every pose that has one, at the estimate's stamps.

    As the TUM benchmark's associate.py: the closest pair first, every truth and every pose once.

    :param tolerance: how far stamps may lie apart, seconds, >= 0
    :returns: fewer poses than the estimate's where some have no truth: tell how many
    :raises ValueError: a tolerance that is none
    """
    _require(tolerance >= 0.0, f"the tolerance is {tolerance} s, it cannot be negative")
    pairs = _closest_pairs(list(truth), list(estimate), tolerance * NANOSECONDS)
    return {pose: truth[true] for true, pose in sorted(pairs, key=lambda pair: pair[1])}


def _closest_pairs(truths: List[int], poses: List[int], tolerance: float) -> Iterator[Tuple[int, int]]:
    """Closest first: these are neighbours in time, or became it when those between them were taken."""
    stamps = sorted([*((stamp, True) for stamp in truths), *((stamp, False) for stamp in poses)])
    before, after = list(range(-1, len(stamps) - 1)), list(range(1, len(stamps) + 1))
    gone = [False] * len(stamps)
    heap: List[Tuple[int, int, int]] = []

    def offer(i: int, j: int) -> None:
        if i >= 0 and j < len(stamps) and stamps[i][1] != stamps[j][1]:
            difference = stamps[j][0] - stamps[i][0]
            if difference <= tolerance:
                heapq.heappush(heap, (difference, i, j))

    for i in range(len(stamps)):
        offer(i, i + 1)
    while heap:
        _, i, j = heapq.heappop(heap)
        if gone[i] or gone[j]:
            continue
        gone[i] = gone[j] = True
        yield (stamps[i][0], stamps[j][0]) if stamps[i][1] else (stamps[j][0], stamps[i][0])
        if before[i] >= 0:
            after[before[i]] = after[j]
        if after[j] < len(stamps):
            before[after[j]] = before[i]
        offer(before[i], after[j])


def interpolated_truth(
    truth: Trajectory, stamps: Iterable[int], longest_gap: float = LONGEST_GAP
) -> Trajectory:
    """The truth at other stamps: straight between positions, rotations at a constant rate (slerp).

    :param stamps: nanoseconds; one outside of the truth has none, nothing is extrapolated
    :param longest_gap: between two truths over which it is still known how it moved, seconds, > 0
    :raises ValueError: a gap that is none, a pose that is not finite
    """
    _require(longest_gap > 0.0, f"the longest gap is {longest_gap} s, it must be above 0")
    known, at = np.array(sorted(truth), dtype=np.int64), np.array(sorted(set(stamps)), dtype=np.int64)
    found = interpolated_poses(known, _poses(truth, known), at, longest_gap)
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
    truth: Trajectory,
    estimate: Trajectory,
    delta: float,
    unit: str = "frames",
    all_pairs: bool = True,
    tolerance: float = 0.1,
) -> RelativeErrors:
    """Relative pose errors E = inverse(inverse(Q_i) Q_j) inverse(P_i) P_j (Sturm et al., eq. 1) of the truth
    Q and the estimate P at the stamps that they share. No alignment changes them.

    :param delta: from i to j, > 0
    :param unit: "frames" (that have both poses), "seconds", or "metres" of the truth's path
    :param all_pairs: from every pose to the one nearest to delta farther on, as the TUM benchmark; else one
        pair after the other, each at least delta long
    :param tolerance: how far all pairs may be from delta, as a part of it; frames are exact
    :returns: no row where the drive is too short
    :raises ValueError: an unknown unit, a delta that is none (frames: a whole number), a pose not finite
    """
    _require(unit in _PROGRESS, f"the unit is '{unit}', allowed are {', '.join(_PROGRESS)}")
    _require(0.0 < delta < np.inf, f"delta is {delta} {unit}, it must be above 0")
    _require(unit != "frames" or float(delta).is_integer(), f"delta is {delta} frames, not a whole number")
    _require(0.0 <= tolerance < 1.0, f"the tolerance is {tolerance}, it must be in [0, 1)")
    stamps = np.array(_common(truth, estimate), dtype=np.int64)
    Q, P = _poses(truth, stamps), _poses(estimate, stamps)
    progress = _PROGRESS[unit](stamps, Q[:, :3, 3])
    slack = 0.0 if unit == "frames" else tolerance * delta
    i, j = (_all_pairs(progress, delta, slack) if all_pairs else _chained_pairs(progress, delta)).T
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


def _chained_pairs(progress: np.ndarray, delta: float) -> np.ndarray:
    """(M, 2) each pair begins where the one before ended."""
    ends = [0]
    while ends[-1] < len(progress):
        end = np.searchsorted(progress, progress[ends[-1]] + delta * (1.0 - ROUNDING))
        ends.append(max(int(end), ends[-1] + 1))  # a delta below the rounding of progress
    return np.array(list(zip(ends, ends[1:-1])), dtype=int).reshape(-1, 2)


def nees(
    truth: Trajectory, estimate: Trajectory, covariances: Mapping[int, np.ndarray], confidence: float = 0.95
) -> Nees:
    """Normalized estimation errors squared e' inverse(P) e of the stamps that all three share, with e =
    sextant.pose_error(): position difference, and delta with R_true = Exp(delta) R_est, in the map's axes.

    The band is of N independent samples; poses of neighbouring frames are not quite independent.

    :param covariances: P by stamp, 6x6, order x y z roll pitch yaw
    :param confidence: probability that the mean of honest covariances is within the band, (0, 1)
    :raises ValueError: a covariance that is not positive, a pose that is not finite
    """
    stamps = [stamp for stamp in _common(truth, estimate) if stamp in covariances]
    poses = zip(stamps, _poses(truth, stamps), _poses(estimate, stamps))
    values = [_nees_at(stamp, true, told, covariances[stamp]) for stamp, true, told in poses]
    mean = float(np.mean(values)) if values else np.nan
    return Nees(np.array(values, dtype=float), mean, nees_band(len(values), confidence=confidence))


def _nees_at(stamp: int, truth: np.ndarray, estimate: np.ndarray, covariance: np.ndarray) -> float:
    try:
        root = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        raise ValueError(f"the covariance at {stamp} ns is not positive: there is no NEES") from None
    whitened = np.linalg.solve(root, sextant.pose_error(truth, estimate))
    return float(whitened @ whitened)


def nees_band(samples: int, freedom: int = 6, confidence: float = 0.95) -> Tuple[float, float]:
    """Band of the mean of so many NEES: chi-square of samples * freedom degrees, divided by samples.

    :raises ValueError: a confidence that is none
    """
    _require(0.0 < confidence < 1.0, f"the confidence is {confidence}, it must be between 0 and 1")
    if samples == 0:
        return np.nan, np.nan
    low, high = chi2.ppf([0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence], samples * freedom) / samples
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
