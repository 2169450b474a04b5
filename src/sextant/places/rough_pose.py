# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Weights of a map's photos by a rough pose of the camera, from GPS, odometry or a compass.

Errors of such an estimate are correlated over a long time, so it only makes photos outside of its region
improbable; within the region all of them are as probable as before.
"""

from typing import NamedTuple, Optional

import numpy as np

DEVIATIONS = 3.0  # radius of the region, standard deviations
TURNED = 0.6  # difference of two cameras' directions with which images still have much in common, radians
LEAST = -5.0  # log weight of photos far outside of the region


class RoughPose(NamedTuple):
    """Position in pixels of the overview, x to the right and y down, and perhaps the camera's direction."""

    x: float  # pixels
    y: float  # pixels
    covariance: np.ndarray  # (2, 2) pixels^2, positive definite
    yaw: Optional[float] = None  # radians counterclockwise from the overview's right; None: unknown
    yaw_deviation: float = TURNED  # standard deviation of the yaw, radians


def log_weights(rough: RoughPose, positions: np.ndarray, yaws: np.ndarray) -> np.ndarray:
    """Log weights (n,) of photos in [LEAST, 0]; outside of the region they fall like a normal distribution.

    :param positions: (n, 2) pixels of the overview
    :param yaws: (n,) radians; nan: unknown, never excluded
    """
    offsets = positions - (rough.x, rough.y)
    excess = np.maximum(_squares(offsets, rough.covariance) - DEVIATIONS**2, 0.0)
    if rough.yaw is not None:
        directions = np.where(np.isnan(yaws), rough.yaw, yaws)
        turned = np.abs((directions - rough.yaw + np.pi) % (2 * np.pi) - np.pi)
        beyond = np.maximum(turned - TURNED, 0.0) / rough.yaw_deviation
        excess += np.maximum(beyond**2 - DEVIATIONS**2, 0.0)
    return np.maximum(-excess / 2, LEAST)


def _squares(offsets: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Squared Mahalanobis distances (n,)."""
    return np.einsum("ni,ni->n", offsets, np.linalg.solve(covariance, offsets.T).T)
