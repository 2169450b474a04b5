# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The transform between the frames of two maps, from the poses of a robot in both at the same time.

Of the planar transforms that two of the positions determine, the one with the least median distance (LMedS:
Rousseeuw 1984, "Least median of squares regression"); then least squares over the positions that fit it. The
covariance is that of clustered errors (Liang and Zeger 1986, "Longitudinal data analysis using generalized
linear models"): a map is off by about the same amount for some metres.
"""

from typing import NamedTuple, Tuple

import numpy as np

from sextant.evaluation.trajectory import Trajectory
from sextant.evaluation.trajectory_metrics import interpolated_truth
from sextant.geometry.plane_poses import planar, rotation, wrapped

MIN_POSES = 10  # in both frames at the same time
BLOCK, MIN_BLOCKS = 10.0, 4  # seconds within which errors are alike; least number of such parts of a drive
MIN_EXTENT = 1.0  # metres, RMS distance of the positions from their mean
SAMPLES, MAX_SAMPLE = 500, 300  # pairs of positions that are tried; positions by which they are judged
# Median and 99.7 % quantile of the length of a vector, over the standard deviation of its two coordinates.
MEDIAN_LENGTH, LONGEST = 1.1774, 3.4
MIN_SCALE = 0.005  # metres: standard deviation, below which no position is left out
ROUNDS = 20  # of least squares, at most
MAX_RMS = 1.0  # metres, of the positions that fit
MAX_TURN_SIGMA, MAX_SIGMA = 0.05, 0.5  # radians; metres, of the transform where the robot drove
MAX_HEADING = 0.5  # radians, median difference of the headings


class FrameAlignment(NamedTuple):
    """A planar transform and how it fits, n poses."""

    T_to_from: np.ndarray  # (3,) x, y, heading; metres, radians
    covariance: np.ndarray  # (3, 3) of it
    stamps: np.ndarray  # (n,) int64, nanoseconds
    distances: np.ndarray  # (n,) of the transformed positions, metres
    used: np.ndarray  # (n,) whether a position fits
    centre: np.ndarray  # (2,) mean of the positions in the frame to which they are transformed, metres

    @property
    def rms(self) -> float:
        """Root mean square distance of the positions that fit, metres."""
        return float(np.sqrt(np.mean(self.distances[self.used] ** 2)))

    def centre_sigma(self) -> float:
        """Standard deviation of the transform along its worst axis, where the robot drove, metres."""
        J = np.column_stack([np.eye(2), _turned(self.centre - self.T_to_from[:2])])
        return float(np.sqrt(np.linalg.eigvalsh(J @ self.covariance @ J.T)[-1]))


def frame_alignment(to: Trajectory, of: Trajectory, seed: int = 0) -> FrameAlignment:
    """Computes the transform from the frame of one trajectory to that of another.

    :param to, of: T_frame_base (4, 4) by stamp in nanoseconds, level
    :param seed: of the pairs of positions that are tried
    :raises ValueError: the poses do not determine it, and why
    """
    stamps, there, here = _common(to, of)
    _check_drive(stamps, there)
    T = _median_fit(there, here, np.random.default_rng(seed))
    used = np.ones(len(stamps), dtype=bool)
    for _ in range(ROUNDS):
        before, used = used, _fitting(T, there, here)
        T = _least_squares(there[used], here[used])
        if np.array_equal(before, used):
            break
    _check_drive(stamps[used], there[used])
    covariance = _covariance(T, stamps[used], there[used], here[used])
    found = FrameAlignment(
        T, covariance, stamps, _distances(T, there, here), used, there[used, :2].mean(axis=0)
    )
    _check(found, there, here)
    return found


def _common(to: Trajectory, of: Trajectory) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps (n,) of the trajectory with fewer poses, and the poses (n, 3) of both at them."""
    if len(to) < len(of):
        stamps, here, there = _common(of, to)
        return stamps, there, here
    at = interpolated_truth(to, of)
    stamps = sorted(at)
    there, here = (np.array([planar(each[stamp]) for stamp in stamps]).reshape(-1, 3) for each in (at, of))
    return np.array(stamps, dtype=np.int64), there, here


def _median_fit(there: np.ndarray, here: np.ndarray, random: np.random.Generator) -> np.ndarray:
    sample = np.unique(np.linspace(0, len(there) - 1, MAX_SAMPLE).astype(int))
    there, here = there[sample], here[sample]
    best, least = np.zeros(3), np.inf
    for pair in random.integers(len(there), size=(SAMPLES, 2)):
        if np.hypot(*(here[pair[0], :2] - here[pair[1], :2])) < MIN_EXTENT:
            continue
        T = _least_squares(there[pair], here[pair])
        median = float(np.median(_distances(T, there, here)))
        if median < least:
            best, least = T, median
    return best


def _least_squares(there: np.ndarray, here: np.ndarray) -> np.ndarray:
    """The transform (3,) with the least squared distances of the positions."""
    p, q = there[:, :2], here[:, :2]
    to, of = p - p.mean(axis=0), q - q.mean(axis=0)
    cross, dot = np.sum(of[:, 0] * to[:, 1] - of[:, 1] * to[:, 0]), np.sum(of * to)
    angle = np.arctan2(cross, dot)
    return np.array([*(p.mean(axis=0) - rotation(angle) @ q.mean(axis=0)), angle])


def _distances(T: np.ndarray, there: np.ndarray, here: np.ndarray) -> np.ndarray:
    return np.hypot(*(there[:, :2] - moved_points(T, here[:, :2])).T)


def moved_points(T_to_from: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Transforms points (n, 2) from a frame to another one by T (3,)."""
    return points @ rotation(T_to_from[2]).T + T_to_from[:2]


def _fitting(T: np.ndarray, there: np.ndarray, here: np.ndarray) -> np.ndarray:
    distances = _distances(T, there, here)
    return distances <= LONGEST * max(MIN_SCALE, float(np.median(distances)) / MEDIAN_LENGTH)


def _turned(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 2) turned left by a right angle: the derivative of a rotation."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def _covariance(T: np.ndarray, stamps: np.ndarray, there: np.ndarray, here: np.ndarray) -> np.ndarray:
    """Covariance (3, 3), errors of one block of the drive being alike."""
    moved = moved_points(T, here[:, :2])
    errors, arms = there[:, :2] - moved, _turned(moved - T[:2])
    J = np.concatenate([np.tile(np.eye(2), (len(moved), 1, 1)), arms[:, :, None]], axis=2)  # (n, 2, 3)
    gradients = np.einsum("nij,ni->nj", J, errors)
    blocks = np.unique(_blocks(stamps), return_inverse=True)[1]
    sums = np.zeros((blocks.max() + 1, 3))
    np.add.at(sums, blocks, gradients)
    inverse = np.linalg.inv(np.einsum("nij,nik->jk", J, J))
    few = len(sums) / max(1, len(sums) - 3)  # the fit of three parameters reduces the errors of few blocks
    return few * inverse @ (sums.T @ sums) @ inverse


def _blocks(stamps: np.ndarray) -> np.ndarray:
    return ((stamps - stamps.min()) * 1e-9 // BLOCK).astype(int)


# ---- what does not determine a transform


def _check_drive(stamps: np.ndarray, there: np.ndarray) -> None:
    count = len(stamps)
    if count < MIN_POSES:
        raise ValueError(f"there are {count} poses in both at the same time, at least {MIN_POSES} are needed")
    parts = len(np.unique(_blocks(stamps)))
    if parts < MIN_BLOCKS:
        known = f"there are poses in both in {parts} periods of {BLOCK:g} s"
        raise ValueError(f"the drive is too short: {known}, at least {MIN_BLOCKS} are needed")
    extent = np.sqrt(np.sum(np.var(there[:, :2], axis=0)))
    if extent < MIN_EXTENT:
        where = f"the robot was within {extent:.2f} m (RMS) where it has poses in both"
        raise ValueError(f"{where}, which does not determine the rotation: drive farther")


def _check(found: FrameAlignment, there: np.ndarray, here: np.ndarray) -> None:
    if found.rms > MAX_RMS:
        share = float(np.mean(found.used))
        fit = f"with the best transform {share:.0%} of the poses are {found.rms:.2f} m (RMS) apart"
        raise ValueError(f"the poses contradict one another: {fit}; are these maps of this place?")
    off = np.median(np.abs(wrapped(there[:, 2] - here[:, 2] - found.T_to_from[2])[found.used]))
    if off > MAX_HEADING:
        how = f"the headings differ by {np.degrees(off):.0f} degrees where the positions fit"
        raise ValueError(f"{how}: is the mount of the camera right, and the base frame the same?")
    turn, position = float(np.sqrt(found.covariance[2, 2])), found.centre_sigma()
    if turn > MAX_TURN_SIGMA or position > MAX_SIGMA:
        sigmas = f"{position:.2f} m and {np.degrees(turn):.1f} degrees, standard deviation"
        raise ValueError(f"the drive does not determine the transform ({sigmas}): drive longer and farther")
