# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of localizations in a place map to messages, and of hypotheses from messages."""

import math
from typing import List

import numpy as np
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, PoseWithCovarianceStamped, Quaternion
from sensor_msgs.msg import NavSatFix, NavSatStatus
from std_msgs.msg import Header

from sextant import msg
from sextant.messages.pose_messages import pose_to_message
from sextant.place_maps.overview_renderer import Hypothesis
from sextant.place_maps.place_map import GeoCorners, MetricFrame, PlaceMap
from sextant.places.place_estimate import PlaceEstimate, geographic_covariance, metric_pose, scale_of
from sextant.places.place_localizer import Localization, PlaceHypothesis, Status

NAN = float("nan")


def places_message(found: Localization, header: Header) -> msg.Places:
    """Ids and probabilities; [0] and [0] if there is no hypothesis."""
    hypotheses = found.hypotheses if found.status != Status.UNUSABLE else []
    ids, probabilities = [each.photo.id for each in hypotheses], [each.probability for each in hypotheses]
    return msg.Places(header, ids or [0], probabilities or [0.0])


def hypotheses_message(place_map: PlaceMap, found: Localization, header: Header) -> msg.PlaceHypotheses:
    """Status, hypotheses with their poses, and probability of an unknown place."""
    frame = place_map.georeference
    name = frame.frame if isinstance(frame, MetricFrame) else ""
    places = [_hypothesis(place_map, hypothesis) for hypothesis in found.hypotheses]
    if name and found.estimate:
        places[0].pose = pose_message(place_map, found, header.stamp).pose
    return msg.PlaceHypotheses(header, int(found.status), found.unknown_probability, name, places)


def _hypothesis(place_map: PlaceMap, hypothesis: PlaceHypothesis) -> msg.PlaceHypothesis:
    photo, frame = hypothesis.photo, place_map.georeference
    pose = PoseWithCovariance(Pose(Point(NAN, NAN, NAN), Quaternion(NAN, NAN, NAN, NAN)), [NAN] * 36)
    latitude, longitude = NAN, NAN
    if isinstance(frame, MetricFrame):
        pose = _pose(*metric_pose(frame, place_map.overview, hypothesis.estimate))
    if isinstance(frame, GeoCorners):
        latitude, longitude = frame.coordinates(place_map.overview, photo.x, photo.y)
    return msg.PlaceHypothesis(
        photo.id, photo.image, hypothesis.probability, photo.x, photo.y, pose, latitude, longitude
    )


def _pose(T: np.ndarray, covariance: np.ndarray) -> PoseWithCovariance:
    return PoseWithCovariance(pose_to_message(T), covariance.ravel().tolist())


def hypotheses_from_message(message: msg.Places) -> List[Hypothesis]:
    """The hypotheses of a message in its order.

    :raises ValueError: the numbers of ids and probabilities differ, or a probability is invalid
    """
    if len(message.poses) != len(message.probabilities):
        raise ValueError(f"{len(message.poses)} places with {len(message.probabilities)} probabilities")
    wrong = [value for value in message.probabilities if not 0 <= value <= 1.0001]  # nan, too
    if wrong:
        raise ValueError(f"a probability is {wrong[0]:g}")
    return [Hypothesis(*each) for each in zip(message.poses, message.probabilities)]


def pose_message(place_map: PlaceMap, found: Localization, stamp) -> PoseWithCovarianceStamped:
    """Pose in the frame of a metric map: the metric pose, or the position of the recognized places."""
    if found.pose:
        T, covariance = found.pose.T_map_body(), found.pose.covariance
    else:
        T, covariance = metric_pose(place_map.georeference, place_map.overview, found.estimate)
    header = Header(stamp=stamp, frame_id=place_map.georeference.frame)
    return PoseWithCovarianceStamped(header, _pose(T, covariance))


def fix_message(place_map: PlaceMap, place: PlaceEstimate, header: Header) -> NavSatFix:
    """Fix of a georeferenced map; the altitude is NaN."""
    latitude, longitude = place_map.georeference.coordinates(place_map.overview, place.x, place.y)
    covariance = geographic_covariance(scale_of(place_map), place).ravel().tolist()
    return NavSatFix(
        header, NavSatStatus(NavSatStatus.STATUS_FIX, 0), latitude, longitude, math.nan, covariance,
        NavSatFix.COVARIANCE_TYPE_KNOWN,
    )  # fmt: skip
