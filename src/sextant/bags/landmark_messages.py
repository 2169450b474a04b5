# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of landmark SLAM as the core has them (as src/ros/landmarks/landmark_conversions.cpp)."""

import math
from typing import Any, List

import numpy as np

import sextant
from sextant.bags.bag_file import DamagedMessage
from sextant.geometry.plane_poses import planar
from sextant.geometry.poses import pose_of_fields

UP = 0.999  # cosine of the tilt of a frame whose z is up


def planar_pose(pose: Any) -> np.ndarray:
    """(3,) x, y, heading of a geometry_msgs/Pose seen from above. :raises ValueError: it is none"""
    return planar(pose_of_fields(pose.position, pose.orientation))


def view_of(T_base_frame: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading of where a sensor is and looks, seen from above.

    :param T_base_frame: (4, 4) of its frame: it looks along x, or z where that is level (an optical frame)
    """
    ahead = T_base_frame[:2, 2 if abs(T_base_frame[2, 2]) < np.sqrt(0.5) else 0]
    return np.array([*T_base_frame[:2, 3], math.atan2(ahead[1], ahead[0])])


def landmark_sightings(message: Any, T_base_frame: np.ndarray) -> List["sextant.LabelledSighting"]:
    """In the robot frame.

    :param message: sextant/LandmarkSightings
    :param T_base_frame: (4, 4) of its frame
    :raises DamagedMessage: names the first sighting that cannot be, or the frame is not level
    """
    if T_base_frame[2, 2] < UP:
        frame = message.header.frame_id
        raise DamagedMessage(f"the z axis of its frame '{frame}' is not up, as that of the base is")
    return [_sighting(each, planar(T_base_frame)) for each in message.sightings]


def marker_sightings(
    message: Any, T_base_camera: np.ndarray, params: "sextant.MarkerLandmarkParams"
) -> List["sextant.LabelledSighting"]:
    """In the robot frame; markers without a size are left out: where they are is not known.

    :param message: sextant/MarkerArray
    :raises DamagedMessage: names the first marker that cannot be
    """
    found = []
    for marker in message.markers:
        if not marker.size > 0.0:
            continue
        try:
            found.append(_marker_sighting(marker, T_base_camera, params))
        except ValueError as error:
            raise DamagedMessage(f"marker {marker.id}: {error}") from None
    return found


def _marker_sighting(
    marker: Any, T_base_camera: np.ndarray, params: "sextant.MarkerLandmarkParams"
) -> "sextant.LabelledSighting":
    T_camera_marker = pose_of_fields(marker.pose.pose.position, marker.pose.pose.orientation)
    covariance = np.reshape(marker.pose.covariance, (6, 6), order="F")
    other = _other_pose(marker, params.corner_sigma)
    seen = sextant.marker_sighting(
        sextant.canonical_family(marker.family), marker.id, T_base_camera, T_camera_marker,
        covariance, other, params,
    )  # fmt: skip
    width = 2 if seen.sighting.heading is None else 3
    _check_covariance(seen.sighting.covariance[:width, :width])
    return seen


def _other_pose(marker: Any, corner_sigma: float) -> float:
    """Probability that the alternative pose of a marker is right."""
    if marker.alternative_reprojection_error < 0.0:
        return 0.0
    sigmas = [sigma if sigma > 0.0 else corner_sigma for sigma in marker.corner_sigmas]
    errors = marker.reprojection_error, marker.alternative_reprojection_error
    return sextant.probability_of_other(*errors, math.sqrt(sum(sigma**2 for sigma in sigmas) / len(sigmas)))


def _sighting(message: Any, T_base_frame: np.ndarray) -> "sextant.LabelledSighting":
    """:param T_base_frame: (3,) x, y, heading"""
    if not message.class_name:
        raise DamagedMessage("a sighting has no class_name")
    label = sextant.LandmarkLabel(message.class_name, message.id if message.id >= 0 else None)
    try:
        return sextant.LabelledSighting(label, _moved(message, *T_base_frame))
    except ValueError as error:
        name = message.class_name + (f" {message.id}" if message.id >= 0 else "")
        raise DamagedMessage(f"the sighting of '{name}': {error}") from None


def _moved(message: Any, x: float, y: float, yaw: float) -> "sextant.PlaneSighting":
    heading = None if math.isnan(message.heading) else message.heading
    if not all(map(math.isfinite, (message.x, message.y, heading or 0.0))):
        raise ValueError("a number is not finite")
    width = 2 if heading is None else 3
    covariance = np.reshape(message.covariance, (3, 3))[:width, :width]
    _check_covariance(covariance)
    c, s = math.cos(yaw), math.sin(yaw)
    position = [x + (c * message.x - s * message.y), y + (s * message.x + c * message.y)]
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])[:width, :width]
    turned = _product(_product(turn, covariance), turn.T)
    return sextant.PlaneSighting(position, turned, None if heading is None else _wrapped(heading + yaw))


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two matrices. BLAS rounds otherwise than the core on some machines."""
    return (a[:, :, None] * b[None]).sum(axis=1)


def _wrapped(angle: float) -> float:
    """In (-pi, pi]."""
    rest = math.remainder(angle, 2 * math.pi)
    return math.pi if rest <= -math.pi else rest


def _check_covariance(covariance: np.ndarray) -> None:
    """:raises ValueError: it is not positive definite"""
    difference = np.linalg.norm(covariance - covariance.T)
    try:
        if difference <= 1e-6 * np.linalg.norm(covariance):  # NaN is not
            np.linalg.cholesky(covariance)
            return
    except np.linalg.LinAlgError:
        pass
    raise ValueError("the covariance is not positive definite")
