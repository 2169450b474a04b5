# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is known of a robot's place, as messages."""

import math

from geometry_msgs.msg import Point, PoseWithCovarianceStamped
from sensor_msgs.msg import NavSatFix, NavSatStatus
from std_msgs.msg import Header

from sextant.msg import PlaceHypotheses, PlaceHypothesis, Places
from sextant.nodes.base.conversions import pose_to_message
from sextant.place_maps.place_map import GeoCorners, MetricFrame, PlaceMap
from sextant.places.place_estimate import PlaceEstimate, geographic_covariance, metric_pose, scale_of
from sextant.places.place_localization import Localization, PlaceAnswer, Status

NAN = float("nan")


def places_message(found: Localization, header: Header) -> Places:
    """Ids and probabilities; [0] and [0] where there is none."""
    told = found.answers if found.status != Status.UNUSABLE else []
    ids, probabilities = [each.photo.id for each in told], [each.probability for each in told]
    return Places(header, ids or [0], probabilities or [0.0])


def hypotheses_message(place_map: PlaceMap, found: Localization, header: Header) -> PlaceHypotheses:
    """All that is known, but for the pose."""
    frame = place_map.georeference
    name = frame.frame if isinstance(frame, MetricFrame) else ""
    places = [_hypothesis(place_map, answer) for answer in found.answers]
    return PlaceHypotheses(header, int(found.status), found.nowhere, name, places)


def _hypothesis(place_map: PlaceMap, answer: PlaceAnswer) -> PlaceHypothesis:
    photo, frame = answer.photo, place_map.georeference
    position, latitude, longitude = Point(NAN, NAN, NAN), NAN, NAN
    if isinstance(frame, MetricFrame):
        position = Point(*frame.position(place_map.overview, photo.x, photo.y), 0.0)
    if isinstance(frame, GeoCorners):
        latitude, longitude = frame.coordinates(place_map.overview, photo.x, photo.y)
    return PlaceHypothesis(
        photo.id, photo.image, answer.probability, photo.x, photo.y, position, latitude, longitude
    )


def pose_message(place_map: PlaceMap, place: PlaceEstimate, stamp) -> PoseWithCovarianceStamped:
    """Of a map with a metric frame."""
    T, covariance = metric_pose(place_map.georeference, place_map.overview, place)
    message = PoseWithCovarianceStamped(header=Header(stamp=stamp, frame_id=place_map.georeference.frame))
    message.pose.pose, message.pose.covariance = pose_to_message(T), covariance.ravel().tolist()
    return message


def fix_message(place_map: PlaceMap, place: PlaceEstimate, header: Header) -> NavSatFix:
    """Of a georeferenced map; the height is not known."""
    latitude, longitude = place_map.georeference.coordinates(place_map.overview, place.x, place.y)
    covariance = geographic_covariance(scale_of(place_map), place).ravel().tolist()
    return NavSatFix(
        header, NavSatStatus(NavSatStatus.STATUS_FIX, 0), latitude, longitude, math.nan, covariance,
        NavSatFix.COVARIANCE_TYPE_KNOWN,
    )  # fmt: skip
