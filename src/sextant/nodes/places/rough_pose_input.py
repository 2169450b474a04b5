# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rough poses of another node or of a GPS receiver, for place_localizer."""

from typing import Dict, Optional, Union

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from sensor_msgs.msg import NavSatFix, NavSatStatus

from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.pose_messages import pose_from_message
from sextant.place_maps.place_map import GeoCorners, MetricFrame, PlaceMap
from sextant.places.place_estimate import ANY_ANGLE, scale_of
from sextant.places.rough_pose import RoughPose

MAX_AGE = 2.0  # difference of the stamps of image and rough pose, seconds
WARN_EVERY = 10.0  # seconds
SINGULAR = 1e-9  # ratio of the eigenvalues of a covariance that is singular but for rounding
FIX_DEVIATION = 10.0  # standard deviation of fixes without a covariance, m

Message = Union[PoseWithCovarianceStamped, NavSatFix]


class RoughPoseInput:
    """Subscribes to rough_pose and rough_fix and keeps the last message of each."""

    def __init__(self) -> None:
        self._last: Dict[type, Message] = {}
        rospy.Subscriber("rough_pose", PoseWithCovarianceStamped, self._keep, queue_size=1)
        rospy.Subscriber("rough_fix", NavSatFix, self._keep, queue_size=1)

    def _keep(self, message: Message) -> None:
        self._last[type(message)] = message

    def at(self, place_map: PlaceMap, stamp: rospy.Time) -> Optional[RoughPose]:
        """For an image with this stamp; None: there is none, or it cannot be used."""
        kind = NavSatFix if isinstance(place_map.georeference, GeoCorners) else PoseWithCovarianceStamped
        message = self._last.get(kind)
        if message is None:
            return None
        try:
            age = (stamp - message.header.stamp).to_sec()
            if abs(age) > MAX_AGE:
                raise DamagedMessage(f"its stamp is {age:.1f} s before that of the image")
            return rough_pose(place_map, message)
        except DamagedMessage as error:
            rospy.logwarn_throttle(WARN_EVERY, f"a rough pose is not used: {error}")
            return None


def rough_pose(place_map: PlaceMap, message: Message) -> Optional[RoughPose]:
    """Converts a message to the overview of a map; a fix without a position to None.

    :raises DamagedMessage: the map has no such coordinates, or the message is not valid
    """
    if isinstance(message, NavSatFix):
        return _from_fix(place_map, message)
    return _from_pose(place_map, message)


def _from_pose(place_map: PlaceMap, message: PoseWithCovarianceStamped) -> RoughPose:
    frame, overview = place_map.georeference, place_map.overview
    if not isinstance(frame, MetricFrame):
        raise DamagedMessage("the map has no metric frame")
    if message.header.frame_id != frame.frame:
        raise DamagedMessage(f"its frame is '{message.header.frame_id}', that of the map is '{frame.frame}'")
    try:
        T = pose_from_message(message.pose.pose)
    except ValueError as error:
        raise DamagedMessage(str(error)) from error
    covariance = np.reshape(message.pose.covariance, (6, 6))
    cosine, sine = np.cos(frame.origin[2]), np.sin(frame.origin[2])
    to_pixels = np.array([[cosine, sine], [sine, -cosine]]) / frame.resolution
    of_position = to_pixels @ _checked(covariance[:2, :2]) @ to_pixels.T
    x, y = frame.pixel(overview, T[0, 3], T[1, 3])
    if not 0 < covariance[5, 5] < ANY_ANGLE:  # nan, too
        return RoughPose(x, y, of_position)
    yaw = frame.photo_yaw(float(np.arctan2(T[1, 0], T[0, 0])))
    return RoughPose(x, y, of_position, yaw, float(np.sqrt(covariance[5, 5])))


def _from_fix(place_map: PlaceMap, fix: NavSatFix) -> Optional[RoughPose]:
    corners, overview = place_map.georeference, place_map.overview
    if not isinstance(corners, GeoCorners):
        raise DamagedMessage("the map has no geographic coordinates")
    if fix.status.status == NavSatStatus.STATUS_NO_FIX:
        return None
    position = np.array(corners.pixel(overview, fix.latitude, fix.longitude))
    if not np.isfinite(position).all():
        raise DamagedMessage("its latitude or longitude is not finite")
    covariance = FIX_DEVIATION**2 * np.eye(2)
    if fix.position_covariance_type != NavSatFix.COVARIANCE_TYPE_UNKNOWN:
        covariance = _checked(np.reshape(fix.position_covariance, (3, 3))[:2, :2])
    east, north = scale_of(place_map)
    to_pixels = np.diag([1 / east, -1 / north])
    return RoughPose(*position, to_pixels @ covariance @ to_pixels.T)


def _checked(covariance: np.ndarray) -> np.ndarray:
    """A covariance (2, 2) of a position, m^2."""
    symmetric = (covariance + covariance.T) / 2
    if np.isfinite(symmetric).all():
        least, largest = np.linalg.eigvalsh(symmetric)
        if least > SINGULAR * largest:
            return symmetric
    raise DamagedMessage("the covariance of its position is not positive definite")
