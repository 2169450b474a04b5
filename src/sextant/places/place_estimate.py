# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""One position, with its covariance, of places that a robot may be at."""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.place_maps.exif_map import extent
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap

YAW_SIGMA = 0.35  # radians that a camera looks aside of the photo that it recognizes
UNKNOWN = 1e6  # variance of a height that the map does not tell, m^2
ANY_ANGLE = math.pi**2 / 3  # variance of an angle that may be any


class PlaceEstimate(NamedTuple):
    """In pixels of the overview, x to the right and y down."""

    x: float
    y: float
    covariance: np.ndarray  # (2, 2) pixels^2
    yaw: Optional[float]  # radians counterclockwise from the overview's right; None: no photo says


def scale_of(place_map: PlaceMap) -> Optional[Tuple[float, float]]:
    """Metres a pixel of the overview, along x and y; None: nobody knows."""
    frame, overview = place_map.georeference, place_map.overview
    if isinstance(frame, MetricFrame):
        return frame.resolution, frame.resolution
    if isinstance(frame, GeoCorners):
        east, north = extent(frame)
        return east / overview.width, north / overview.height
    return None


def estimate(
    positions: np.ndarray, probabilities: np.ndarray, yaws: Sequence[Optional[float]], spacing: np.ndarray
) -> PlaceEstimate:
    """The mean of some places and how they scatter, with the surroundings that each stands for.

    :param positions: (m, 2) pixels
    :param probabilities: (m,), not all 0
    :param yaws: of the photo that was recognized at each
    :param spacing: (2,) between places, pixels along x and y; a robot is up to half of it away from its place
    """
    weights = probabilities / probabilities.sum()
    mean = weights @ positions
    away = positions - mean
    covariance = (weights[:, None] * away).T @ away + np.diag((spacing / 2) ** 2)
    known = [(weight, yaw) for weight, yaw in zip(weights, yaws) if yaw is not None]
    direction = sum(weight * np.exp(1j * yaw) for weight, yaw in known)
    yaw = float(np.angle(direction)) if abs(direction) > 0.5 * sum(w for w, _ in known) > 0.25 else None
    return PlaceEstimate(float(mean[0]), float(mean[1]), covariance, yaw)


def metric_pose(
    frame: MetricFrame, overview: Overview, found: PlaceEstimate
) -> Tuple[np.ndarray, np.ndarray]:
    """T_frame_base (4, 4) and its covariance (6, 6), of x, y, z and rotations about them in the frame."""
    x, y = frame.position(overview, found.x, found.y)
    yaw = 0.0 if found.yaw is None else frame.yaw(found.yaw)
    turn = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, frame.origin[2]])[:2, :2]
    to_frame = turn @ np.diag([frame.resolution, -frame.resolution])
    yaw_variance = ANY_ANGLE if found.yaw is None else YAW_SIGMA**2
    covariance = np.diag([0.0, 0.0, UNKNOWN, ANY_ANGLE, ANY_ANGLE, yaw_variance])
    covariance[:2, :2] = to_frame @ found.covariance @ to_frame.T
    return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw]), covariance


def geographic_covariance(scale: Tuple[float, float], found: PlaceEstimate) -> np.ndarray:
    """(3, 3) m^2, of east, north and up.

    :param scale: metres a pixel, as scale_of()
    """
    to_metres = np.diag([scale[0], -scale[1]])
    covariance = np.diag([0.0, 0.0, UNKNOWN])
    covariance[:2, :2] = to_metres @ found.covariance @ to_metres.T
    return covariance
