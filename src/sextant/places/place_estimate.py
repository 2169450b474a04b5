# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Position estimate with covariance from the probabilities of places."""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap

YAW_SIGMA = 0.35  # standard deviation of the camera's yaw relative to that of the recognized photo, radians
UNKNOWN_HEIGHT = 1e6  # variance of the unknown height, m^2
ANY_ANGLE = math.pi**2 / 3  # variance of a uniformly distributed angle, rad^2


class PlaceEstimate(NamedTuple):
    """Position in pixels of the overview, x to the right and y down."""

    x: float  # pixels
    y: float  # pixels
    covariance: np.ndarray  # (2, 2) pixels^2
    yaw: Optional[float]  # radians counterclockwise from the overview's right; None: unknown or contradictory
    yaw_deviation: float = YAW_SIGMA  # standard deviation of the yaw, radians


def scale_of(place_map: PlaceMap) -> Optional[Tuple[float, float]]:
    """Metres per pixel of the overview, along x and y; None if the map has no scale."""
    frame, overview = place_map.georeference, place_map.overview
    if isinstance(frame, MetricFrame):
        return frame.resolution, frame.resolution
    if isinstance(frame, GeoCorners):
        east, north = frame.extent()
        return east / overview.width, north / overview.height
    return None


def estimate(
    positions: np.ndarray, probabilities: np.ndarray, yaws: Sequence[Optional[float]], spacing: np.ndarray
) -> PlaceEstimate:
    """Returns the weighted mean of places; its covariance is their scatter plus (spacing / 2)^2.

    :param positions: (m, 2) pixels
    :param probabilities: (m,), not all 0
    :param yaws: (m,) of the photo recognized at each place, radians; None: unknown
    :param spacing: (2,) distance between neighbouring places, pixels along x and y
    """
    weights = probabilities / probabilities.sum()
    mean = weights @ positions
    offsets = positions - mean
    covariance = (weights[:, None] * offsets).T @ offsets + np.diag((spacing / 2) ** 2)
    known = [(weight, yaw) for weight, yaw in zip(weights, yaws) if yaw is not None]
    direction = sum(weight * np.exp(1j * yaw) for weight, yaw in known)
    # known for half of the weight, with a mean resultant length above 0.5
    yaw = float(np.angle(direction)) if abs(direction) > 0.5 * sum(w for w, _ in known) > 0.25 else None
    return PlaceEstimate(float(mean[0]), float(mean[1]), covariance, yaw)


def metric_pose(
    frame: MetricFrame, overview: Overview, place: PlaceEstimate
) -> Tuple[np.ndarray, np.ndarray]:
    """T_frame_base (4, 4) and its covariance (6, 6): x, y, z and rotations about the frame's axes; m, rad."""
    x, y = frame.position(overview, place.x, place.y)
    yaw = 0.0 if place.yaw is None else frame.yaw(place.yaw)
    rotation = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, frame.origin[2]])[:2, :2]
    to_frame = rotation @ np.diag([frame.resolution, -frame.resolution])
    yaw_variance = ANY_ANGLE if place.yaw is None else place.yaw_deviation**2
    covariance = np.diag([0.0, 0.0, UNKNOWN_HEIGHT, ANY_ANGLE, ANY_ANGLE, yaw_variance])
    covariance[:2, :2] = to_frame @ place.covariance @ to_frame.T
    return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw]), covariance


def geographic_covariance(scale: Tuple[float, float], place: PlaceEstimate) -> np.ndarray:
    """Covariance (3, 3) of east, north and up, m^2.

    :param scale: metres per pixel, see scale_of()
    """
    to_metres = np.diag([scale[0], -scale[1]])
    covariance = np.diag([0.0, 0.0, UNKNOWN_HEIGHT])
    covariance[:2, :2] = to_metres @ place.covariance @ to_metres.T
    return covariance
