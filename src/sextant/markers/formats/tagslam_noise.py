# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How well a place is known, between tagslam and here.

tagslam gives deviations (position_noise in metres, rotation_noise in radians) or R, 36 numbers row by row
with the covariance (R^T R)^-1, rotation before position (PoseNoise::make, PoseNoise::makeFromR of
src/pose_noise.cpp). It hands both to gtsam as the noise of a prior on the pose (src/gtsam_optimizer.cpp),
whose error gtsam works out in the frame of the pose itself (gtsam: PriorFactor::evaluateError,
Pose3::ChartAtOrigin): along and about the axes of the tag. Ours are position before rotation, along and
about the axes of the map.

Two slips of tagslam are not followed: its page says that R has position first, its code has rotation first;
and it reads R column by column, though it writes it row by row, as its page says. Neither changes what a
multiple of the unit matrix means, as in its examples.
"""

from typing import Tuple

import numpy as np

from sextant.markers.formats.located_yaml import Table

AXES = ("x", "y", "z")
NAMES = ("position_noise", "rotation_noise", "R")
SMALLEST_POSITION, SMALLEST_ROTATION = 1e-4, 1e-5  # m, rad: what tagslam's examples give to an exact place

LARGEST = 1e6  # m, rad: beyond it numbers begin to overflow, and nothing is known long before


def read_vector(table: Table, name: str) -> np.ndarray:
    """(3,) of a table x, y, z."""
    vector = table.table(name)
    vector.require(f"'{name}'", AXES)
    return np.array([vector.number(axis) for axis in AXES])


def read_noise(pose: Table) -> np.ndarray:
    """(6, 6) covariance in the frame of the pose itself, position before rotation (m^2, rad^2).

    :raises MapFileError: none of the two ways to give it, both, half of one, or numbers that are none
    """
    given = [name for name in NAMES if name in pose]
    if given == ["R"]:
        return _from_root(pose)
    if given == ["position_noise", "rotation_noise"]:
        deviations = np.concatenate([read_vector(pose, name) for name in given])
        if not np.all((deviations >= 0) & (deviations <= LARGEST)):
            raise pose.mistake(f"standard deviations must be in [0, {LARGEST:g}]")
        return np.diag(deviations**2)
    told = " and ".join(given) or "none"
    raise pose.mistake(f"a pose needs either position_noise and rotation_noise or R, this has {told}")


def _from_root(pose: Table) -> np.ndarray:
    R = np.array(pose.numbers("R", 36)).reshape(6, 6)
    try:
        inverse = np.linalg.inv(R)
    except np.linalg.LinAlgError:
        raise pose.mistake("has no inverse, so that there is no covariance", "R") from None
    if np.abs(inverse).max() > LARGEST:
        raise pose.mistake(f"has standard deviations of more than {LARGEST:g}", "R")
    covariance = inverse @ inverse.T
    order = [3, 4, 5, 0, 1, 2]
    covariance = covariance[np.ix_(order, order)]
    return 0.5 * (covariance + covariance.T)


def in_map_axes(covariance: np.ndarray, R_map_tag: np.ndarray) -> np.ndarray:
    """(6, 6) along and about the map's axes, of one along and about the tag's."""
    turn = np.kron(np.eye(2), R_map_tag)
    turned = turn @ covariance @ turn.T
    return 0.5 * (turned + turned.T)


def deviations_in_tag_axes(covariance: np.ndarray, R_map_tag: np.ndarray) -> Tuple[np.ndarray, bool]:
    """(6,) deviations along and about the tag's axes that tagslam can optimize with, of a covariance (6, 6)
    in the map's; and whether that is all there was to say: no correlations, and none as good as exact."""
    turned = in_map_axes(covariance, R_map_tag.T)
    smallest = np.repeat([SMALLEST_POSITION, SMALLEST_ROTATION], 3)
    deviations = np.maximum(np.sqrt(np.maximum(np.diag(turned), 0.0)), smallest)
    return deviations, bool(np.allclose(np.diag(deviations**2), turned, rtol=1e-6, atol=1e-15))
