# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the messages of landmark SLAM in the same way as src/ros/landmarks/landmark_conversions.cpp."""

import math
from typing import Any, List, Optional

import numpy as np

import sextant
from sextant.geometry.plane_poses import planar
from sextant.geometry.poses import pose_of_fields
from sextant.messages.damaged_message import DamagedMessage
from sextant.msg import LandmarkObservation

MIN_COS_TILT = 0.999  # of a frame whose z axis is up


def planar_pose(pose: Any) -> np.ndarray:
    """(3,) x, y, heading of a geometry_msgs/Pose seen from above. :raises ValueError: it is not valid"""
    return planar(pose_of_fields(pose.position, pose.orientation))


def planar_sensor_pose(T_base_frame: np.ndarray) -> np.ndarray:
    """(3,) x, y, heading of a sensor; the heading is its viewing direction, seen from above.

    :param T_base_frame: (4, 4) of its frame; it looks along x, or along z if that is level (an optical frame)
    """
    ahead = T_base_frame[:2, 2 if abs(T_base_frame[2, 2]) < np.sqrt(0.5) else 0]
    return np.array([*T_base_frame[:2, 3], math.atan2(ahead[1], ahead[0])])


def landmark_observations(message: Any, T_base_frame: np.ndarray) -> List["sextant.LabelledObservation"]:
    """Converts sextant/LandmarkObservations to the robot frame.

    :param T_base_frame: (4, 4) of the frame of the message
    :raises DamagedMessage: the first invalid observation, or the frame is not level
    """
    if T_base_frame[2, 2] < MIN_COS_TILT:
        frame = message.header.frame_id
        raise DamagedMessage(f"the z axis of its frame '{frame}' is not up")
    return [_observation(each, planar(T_base_frame)) for each in message.observations]


def observations_to_messages(observations: List["sextant.LabelledObservation"]) -> List[LandmarkObservation]:
    """Converts observations to messages in the same frame."""
    messages = []
    for each in observations:
        seen, id = each.observation, -1 if each.label.id is None else each.label.id
        heading = math.nan if seen.heading is None else seen.heading
        covariance = np.ravel(seen.covariance).tolist()
        messages.append(LandmarkObservation(each.label.class_name, id, *seen.position, heading, covariance))
    return messages


def marker_observations(
    message: Any,
    T_base_camera: np.ndarray,
    params: "sextant.MarkerLandmarkParams",
    marker_map: Optional["sextant.MarkerMap"] = None,
) -> List["sextant.LabelledObservation"]:
    """Converts sextant/MarkerArray to observations in the robot frame; skips markers without a size.

    :param T_base_camera: (4, 4) of the optical frame
    :param marker_map: its markers measure the slope below the robot, with params.ramp_sigma
    :raises DamagedMessage: the first invalid marker
    """
    markers = [marker for marker in message.markers if marker.size > 0.0]
    seen = [_seen_marker(marker, params.corner_sigma) for marker in markers]
    found = sextant.marker_observations(seen, T_base_camera, params, marker_map)
    for marker, each in zip(markers, found):
        dimensions = 2 if each.observation.heading is None else 3
        try:
            _check_covariance(each.observation.covariance[:dimensions, :dimensions])
        except ValueError as error:
            raise DamagedMessage(f"marker {marker.id}: {error}") from None
    return found


def _seen_marker(marker: Any, corner_sigma: float) -> "sextant.SeenMarker":
    """:raises DamagedMessage: it is not valid"""
    try:
        T_camera_marker = pose_of_fields(marker.pose.pose.position, marker.pose.pose.orientation)
        family = sextant.canonical_family(marker.family)
    except ValueError as error:
        raise DamagedMessage(f"marker {marker.id}: {error}") from None
    covariance = np.reshape(marker.pose.covariance, (6, 6), order="F")
    probability = _alternative_probability(marker, corner_sigma)
    return sextant.SeenMarker(family, marker.id, T_camera_marker, covariance, probability)


def _alternative_probability(marker: Any, corner_sigma: float) -> float:
    """Probability that the alternative pose of a marker is the true one."""
    if marker.alternative_reprojection_error < 0.0:  # there is none
        return 0.0
    sigmas = [sigma if sigma > 0.0 else corner_sigma for sigma in marker.corner_sigmas]
    errors = marker.reprojection_error, marker.alternative_reprojection_error
    sigma = math.sqrt(sum(sigma**2 for sigma in sigmas) / len(sigmas))
    return sextant.alternative_pose_probability(*errors, sigma)


def _observation(message: Any, frame_pose: np.ndarray) -> "sextant.LabelledObservation":
    """:param frame_pose: (3,) x, y, heading of the message's frame in the robot frame"""
    if not message.class_name:
        raise DamagedMessage("an observation has no class_name")
    label = sextant.LandmarkLabel(message.class_name, message.id if message.id >= 0 else None)
    try:
        return sextant.LabelledObservation(label, _in_robot_frame(message, *frame_pose))
    except ValueError as error:
        name = message.class_name + (f" {message.id}" if message.id >= 0 else "")
        raise DamagedMessage(f"the observation of '{name}': {error}") from None


def _in_robot_frame(message: Any, x: float, y: float, yaw: float) -> "sextant.Observation2D":
    heading = None if math.isnan(message.heading) else message.heading
    if not all(map(math.isfinite, (message.x, message.y, heading or 0.0))):
        raise ValueError("a number is not finite")
    dimensions = 2 if heading is None else 3
    covariance = np.reshape(message.covariance, (3, 3))[:dimensions, :dimensions]
    _check_covariance(covariance)
    c, s = math.cos(yaw), math.sin(yaw)
    position = [x + (c * message.x - s * message.y), y + (s * message.x + c * message.y)]
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])[:dimensions, :dimensions]
    turned = _product(_product(turn, covariance), turn.T)
    return sextant.Observation2D(position, turned, None if heading is None else _wrapped(heading + yaw))


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of two matrices. Without BLAS: on some machines it rounds differently from the C++ library."""
    return (a[:, :, None] * b[None]).sum(axis=1)


def _wrapped(angle: float) -> float:
    """In (-pi, pi]."""
    rest = math.remainder(angle, 2 * math.pi)
    return math.pi if rest <= -math.pi else rest


def _check_covariance(covariance: np.ndarray) -> None:
    """:raises ValueError: it is not positive definite"""
    difference = np.linalg.norm(covariance - covariance.T)
    try:
        if difference <= 1e-6 * np.linalg.norm(covariance):  # false if it contains NaN
            np.linalg.cholesky(covariance)
            return
    except np.linalg.LinAlgError:
        pass
    raise ValueError("the covariance is not positive definite")
