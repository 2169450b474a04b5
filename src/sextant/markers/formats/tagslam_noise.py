# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of covariances between tagslam and Sextant.

tagslam specifies standard deviations (position_noise in metres, rotation_noise in radians) or R, 36 numbers
row by row with the covariance (R^T R)^-1, rotation before position (PoseNoise::make, PoseNoise::makeFromR of
src/pose_noise.cpp). Both become the noise of a gtsam prior on the pose (src/gtsam_optimizer.cpp). gtsam
computes its error in the frame of the pose (PriorFactor::evaluateError, Pose3::ChartAtOrigin): along and
about the axes of the tag. Sextant has position before rotation, along and about the axes of the map.

Two errors of tagslam are not reproduced: its documentation has position first in R, its code has rotation
first; and it reads R column by column, but writes it row by row, as documented. Neither matters for a
multiple of the identity, as in its examples.
"""

from typing import Tuple

import numpy as np

from sextant.markers.formats.yaml_table import Table

AXES = ("x", "y", "z")
NAMES = ("position_noise", "rotation_noise", "R")
MIN_POSITION, MIN_ROTATION = 1e-4, 1e-5  # m, rad: of an exact pose in tagslam's examples

MAX_SIGMA = 1e6  # m, rad: larger ones may overflow


def read_vector(table: Table, name: str) -> np.ndarray:
    """Reads (3,) from a table x, y, z."""
    vector = table.table(name)
    vector.require(f"'{name}'", AXES)
    return np.array([vector.number(axis) for axis in AXES])


def read_noise(pose: Table) -> np.ndarray:
    """Reads the (6, 6) covariance in the frame of the pose itself, position before rotation (m^2, rad^2).

    :raises MapFileError: neither or both of R and the two noises are present, or a number is invalid
    """
    given = [name for name in NAMES if name in pose]
    if given == ["R"]:
        return _from_root(pose)
    if given == ["position_noise", "rotation_noise"]:
        deviations = np.concatenate([read_vector(pose, name) for name in given])
        if not np.all((deviations >= 0) & (deviations <= MAX_SIGMA)):
            raise pose.mistake(f"standard deviations must be in [0, {MAX_SIGMA:g}]")
        return np.diag(deviations**2)
    present = " and ".join(given) or "none"
    raise pose.mistake(f"a pose needs either position_noise and rotation_noise or R, this has {present}")


def _from_root(pose: Table) -> np.ndarray:
    R = np.array(pose.numbers("R", 36)).reshape(6, 6)
    try:
        inverse = np.linalg.inv(R)
    except np.linalg.LinAlgError:
        raise pose.mistake("is singular, so that there is no covariance", "R") from None
    if np.abs(inverse).max() > MAX_SIGMA:
        raise pose.mistake(f"has standard deviations of more than {MAX_SIGMA:g}", "R")
    covariance = inverse @ inverse.T
    order = [3, 4, 5, 0, 1, 2]
    covariance = covariance[np.ix_(order, order)]
    return 0.5 * (covariance + covariance.T)


def in_map_axes(covariance: np.ndarray, R_map_tag: np.ndarray) -> np.ndarray:
    """Rotates a covariance (6, 6) from the axes of the tag to those of the map."""
    turn = np.kron(np.eye(2), R_map_tag)
    turned = turn @ covariance @ turn.T
    return 0.5 * (turned + turned.T)


def deviations_in_tag_axes(covariance: np.ndarray, R_map_tag: np.ndarray) -> Tuple[np.ndarray, bool]:
    """Converts a covariance (6, 6) in the map's axes to standard deviations that tagslam can optimize with.

    :returns: (6,) standard deviations along and about the axes of the tag; whether they represent the
        covariance exactly: no correlations, and none below tagslam's minimum
    """
    turned = in_map_axes(covariance, R_map_tag.T)
    smallest = np.repeat([MIN_POSITION, MIN_ROTATION], 3)
    deviations = np.maximum(np.sqrt(np.maximum(np.diag(turned), 0.0)), smallest)
    return deviations, bool(np.allclose(np.diag(deviations**2), turned, rtol=1e-6, atol=1e-15))
