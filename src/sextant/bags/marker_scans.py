# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The markers in the images of a drive as observations of landmarks."""

from collections import Counter
from typing import Callable, Iterable, List, Optional

import numpy as np

import sextant
from sextant.bags.landmark_reader import RecordedLandmarks, SensorScan
from sextant.localization.drive_observations import DriveObservations
from sextant.messages.landmark_messages import planar_sensor_pose

SizeOf = Callable[[str, int], Optional[float]]  # edge length by family and id, metres; None: not to be used


def with_marker_scans(recorded: RecordedLandmarks, scans: Iterable[SensorScan]) -> RecordedLandmarks:
    """Adds scans to the messages of a bag, in the order of their stamps: none is late."""
    messages = sorted([*recorded.messages, *scans], key=lambda message: message.stamp)
    return recorded._replace(messages=messages)


def marker_scans(
    drive: DriveObservations,
    size_of: SizeOf,
    params: "sextant.MarkerLandmarkParams",
    marker_map: Optional["sextant.MarkerMap"] = None,
) -> List[SensorScan]:
    """Observations of markers, in the robot frame, of each image that shows one.

    A marker that an image shows twice is left out: there are two prints of it.

    :param marker_map: its markers measure the slope below the robot, with params.ramp_sigma
    """
    models = {name: camera.model() for name, camera in drive.cameras.items()}
    scans = []
    for image in drive.images:
        camera, count = drive.cameras[image.camera], Counter((each.family, each.id) for each in image.markers)
        once = (each for each in image.markers if count[each.family, each.id] == 1)
        found = [_seen_marker(each, models[image.camera], size_of, params) for each in once]
        seen = [each for each in found if each]
        if seen:
            T = camera.T_base_camera
            observations = sextant.marker_observations(seen, T, params, marker_map)
            scans.append(SensorScan(image.stamp, observations, planar_sensor_pose(T), True))
    return scans


def _seen_marker(
    detection: "sextant.Detection",
    model: "sextant.CameraModel",
    size_of: SizeOf,
    params: "sextant.MarkerLandmarkParams",
) -> Optional["sextant.SeenMarker"]:
    """Nothing if the marker is not to be used, or its corners do not determine its pose."""
    size = size_of(detection.family, detection.id)
    poses = size and sextant.solve_marker_pose(model, detection.corners, size)
    if not poses:
        return None
    sigmas = np.array(detection.corner_sigmas, dtype=float)
    sigma = float(np.sqrt(np.mean(np.where(sigmas > 0.0, sigmas, params.corner_sigma) ** 2)))
    T, other = poses.best.T_camera_marker, poses.alternative
    covariance = sextant.marker_pose_covariance(model, T, size, sigma)
    if covariance is None:
        return None
    errors = poses.best.reprojection_error, other.reprojection_error if other else np.inf
    probability = sextant.alternative_pose_probability(*errors, sigma) if other else 0.0
    return sextant.SeenMarker(detection.family, detection.id, T, covariance, probability)
