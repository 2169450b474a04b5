# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of rough poses against the published poses and fixes of the same places."""

import math
from pathlib import Path

import numpy as np
import pytest
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from sensor_msgs.msg import NavSatFix, NavSatStatus
from std_msgs.msg import Header

from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.pose_messages import pose_to_message
from sextant.nodes.places.place_messages import fix_message
from sextant.nodes.places.rough_pose_input import FIX_DEVIATION, MAX_AGE, RoughPoseInput, rough_pose
from sextant.place_maps.place_map import GeoCorners, MetricFrame, Overview, PlaceMap
from sextant.places.place_estimate import PlaceEstimate, metric_pose

FRAME = MetricFrame("town", 0.05, (7.0, -3.0, 2.0))
TOWN = PlaceMap(Path(), Overview("town.png", 1000, 500), georeference=FRAME)
EARTH = TOWN._replace(georeference=GeoCorners((55.01, 13.0), (55.0, 13.02)))
SINGULAR = np.zeros((6, 6))  # but for rounding: its least eigenvalue is computed as 3.5e-18
SINGULAR[:2, :2] = [[0.03, 0.09], [0.09, 0.27]]
PLACE = PlaceEstimate(300.0, 120.0, np.array([[90.0, 20.0], [20.0, 40.0]]), 0.7)


def pose_message(frame_id="town", covariance=None, yaw=PLACE.yaw):
    T, of_place = metric_pose(FRAME, TOWN.overview, PLACE._replace(yaw=yaw))
    message = PoseWithCovarianceStamped(header=Header(frame_id=frame_id))
    message.pose.pose = pose_to_message(T)
    message.pose.covariance = (of_place if covariance is None else covariance).ravel().tolist()
    return message


def test_a_pose_is_converted_back_to_the_overview():
    rough = rough_pose(TOWN, pose_message())
    assert (rough.x, rough.y, rough.yaw) == pytest.approx((PLACE.x, PLACE.y, PLACE.yaw))
    np.testing.assert_allclose(rough.covariance, PLACE.covariance)
    assert rough.yaw_deviation == pytest.approx(0.35)


def test_an_unknown_yaw_remains_unknown():
    assert rough_pose(TOWN, pose_message(yaw=None)).yaw is None


def test_a_fix_is_converted_back_to_the_overview():
    message = fix_message(EARTH, PLACE, Header())
    rough = rough_pose(EARTH, message)
    assert (rough.x, rough.y, rough.yaw) == (pytest.approx(PLACE.x), pytest.approx(PLACE.y), None)
    np.testing.assert_allclose(rough.covariance, PLACE.covariance)
    message.position_covariance_type = NavSatFix.COVARIANCE_TYPE_UNKNOWN
    metres = 0.01 * 111_320.0 / 500  # of a pixel from north to south
    assert rough_pose(EARTH, message).covariance[1, 1] == pytest.approx((FIX_DEVIATION / metres) ** 2)
    message.status.status = NavSatStatus.STATUS_NO_FIX
    assert rough_pose(EARTH, message) is None


@pytest.mark.parametrize(
    "place_map, message, reason",
    [
        (TOWN, pose_message("odom"), "its frame is 'odom', that of the map is 'town'"),
        (EARTH, pose_message(), "no metric frame"),
        (TOWN, fix_message(EARTH, PLACE, Header()), "no geographic coordinates"),
        (TOWN, pose_message(covariance=np.zeros((6, 6))), "not positive definite"),
        (TOWN, pose_message(covariance=np.full((6, 6), math.nan)), "not positive definite"),
        (TOWN, pose_message(covariance=SINGULAR), "not positive definite"),
        (EARTH, NavSatFix(latitude=math.nan), "not finite"),
    ],
)
def test_what_cannot_be_used_is_refused(place_map, message, reason):
    with pytest.raises(DamagedMessage, match=reason):
        rough_pose(place_map, message)


def test_a_pose_that_is_not_finite_is_refused():
    message = pose_message()
    message.pose.pose.position.x = math.inf
    with pytest.raises(DamagedMessage):
        rough_pose(TOWN, message)


def test_a_rough_pose_is_used_for_images_of_about_its_time_and_a_fix_does_not_replace_it(monkeypatch):
    received, warned = {}, []
    monkeypatch.setattr(
        rospy, "Subscriber", lambda topic, _, call, queue_size: received.update({topic: call})
    )
    monkeypatch.setattr(rospy, "logwarn_throttle", lambda _, text: warned.append(text))
    rough = RoughPoseInput()
    assert rough.at(TOWN, rospy.Time(100)) is None
    message = pose_message()
    message.header.stamp = rospy.Time(100)
    received["rough_pose"](message)
    received["rough_fix"](NavSatFix())
    for seconds, is_used in ((-0.1, False), (0.1, True), (3.9, True), (4.1, False)):
        stamp = rospy.Time.from_sec(100 - MAX_AGE + seconds)
        assert (rough.at(TOWN, stamp) is not None) == is_used
    assert [text.partition("stamp is ")[2] for text in warned] == [
        "-2.1 s before that of the image",
        "2.1 s before that of the image",
    ]
