# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Normalized estimation error squared (NEES) of a trajectory with covariances.

Source: Bar-Shalom, Li and Kirubarajan 2001, "Estimation with applications to tracking and navigation", 5.4.
"""

from dataclasses import dataclass
from typing import Mapping, Tuple

import numpy as np
from scipy.stats import chi2

import sextant
from sextant.evaluation.trajectory import Trajectory, common_stamps, finite_poses

CONFIDENCE = 0.95  # probability that the mean NEES of consistent covariances is within the band


@dataclass(frozen=True)
class Nees:
    """Normalized estimation errors squared, and the confidence band of their mean."""

    values: np.ndarray  # (N,) by ascending stamp; the expectation is 6
    mean: float  # NaN without samples
    band: Tuple[float, float]  # contains the mean of consistent covariances with probability CONFIDENCE

    @property
    def consistent(self) -> bool:
        """Whether the mean is within the band: above it the covariances are too small, below it too large."""
        return self.band[0] <= self.mean <= self.band[1]


def nees(truth: Trajectory, estimate: Trajectory, covariances: Mapping[int, np.ndarray]) -> Nees:
    """Computes normalized estimation errors squared e' inverse(P) e at the common stamps, with e =
    sextant.pose_error(): position difference, and delta with R_true = Exp(delta) R_est, in the map's axes.

    The band assumes independent samples. Poses of consecutive images are slightly correlated: it is a little
    too narrow for them.

    :param covariances: P by stamp, 6x6, order x y z roll pitch yaw
    :raises ValueError: a covariance is not positive definite, or a pose is not finite
    """
    stamps = [stamp for stamp in common_stamps(truth, estimate) if stamp in covariances]
    poses = zip(stamps, finite_poses(truth, stamps), finite_poses(estimate, stamps))
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
    """Returns the confidence band of the mean NEES of independent samples: chi-square, 6 degrees of
    freedom each; NaN without samples."""
    if samples == 0:
        return np.nan, np.nan
    low, high = chi2.ppf([0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], samples * 6) / samples
    return float(low), float(high)
