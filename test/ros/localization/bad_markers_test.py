#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The locator receives invalid markers and maps. It then publishes nothing, or correct poses."""

import math

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion
from marker_chain import PoseTest, publish_mount
from marker_scene import FAMILY, SIZE, T_MAP_MARKER, corners_of, marker_msg, markers_msg
from ros_probe import Diagnostics, quaternion, stamps, until

from sextant.msg import MarkerArray, MarkerMapEntries, MarkerMapEntry

LOCALIZATION = "locator: localization"


def entry(like, position=None, **fields):
    T = T_MAP_MARKER[like]
    place = Pose(Point(*(T[:3, 3] if position is None else position)), Quaternion(*quaternion(T[:3, :3])))
    made = MarkerMapEntry(FAMILY, like, SIZE, "", PoseWithCovariance(pose=place))
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def map_msg(entries=None, frame="map"):
    msg = MarkerMapEntries(markers=[entry(3), entry(5)] if entries is None else entries)
    msg.header.frame_id = frame
    return msg


def calibrated(**fields):
    """Markers of which the calibration is changed."""
    msg = markers_msg(None)
    for name, value in fields.items():
        setattr(msg.camera_info, name, value)
    return msg


def shifted(id, value):
    corners = corners_of(id)
    corners[2, 0] = value
    return marker_msg(id, corners=corners)


def bad_markers():
    """By what is wrong."""
    nowhere = marker_msg(3, corners=np.tile(corners_of(3)[0], (4, 1)))
    line = marker_msg(3, corners=[[100, 100], [150, 150], [200, 200], [250, 250]])
    mirrored = marker_msg(3, corners=corners_of(3)[::-1])
    return {
        "corner is NaN": markers_msg(None, [shifted(3, math.nan), marker_msg(5)]),
        "corner is infinite": markers_msg(None, [shifted(3, math.inf), marker_msg(5)]),
        "corner is far away": markers_msg(None, [shifted(3, 1e300)]),
        "corners are one point": markers_msg(None, [nowhere]),
        "corners are on a line": markers_msg(None, [line]),
        "corners are mirrored": markers_msg(None, [mirrored]),
        "unknown family": markers_msg(None, [marker_msg(3, family="tag99h99"), marker_msg(5)]),
        "not in the map": markers_msg(None, [marker_msg(3, family="tag25h9")]),
        "id below zero": markers_msg(None, [marker_msg(-3, corners=corners_of(3))]),
        "same id twice": markers_msg(None, [marker_msg(3), marker_msg(3, corners=corners_of(5))]),
        "K = 0": calibrated(K=[0.0] * 9),
        "K = NaN": calibrated(K=[math.nan] * 9),
        "D = NaN": calibrated(D=[math.nan] * 5),
        "unknown distortion": calibrated(distortion_model="barrel"),
        "frame that tf does not know": markers_msg(None, frame="nowhere"),
        "no frame": markers_msg(None, frame=""),
    }


def bad_maps():
    infinite = PoseWithCovariance(pose=Pose(Point(math.inf, 0, 0), Quaternion(0, 0, 0, 1)))
    unturned = PoseWithCovariance(pose=Pose(Point(0, 0, 0), Quaternion()))
    uncertain = entry(3, position=[9, 9, 9])
    uncertain.pose.covariance = [math.nan] * 36
    moved = [9, 9, 9]
    return {
        "same id twice": map_msg([entry(3), entry(3, position=moved)]),
        "same name twice": map_msg([entry(3, name="a"), entry(5, name="a", position=moved)]),
        "unknown family": map_msg([entry(3, family="tag99h99", position=moved)]),
        "id that the family has not": map_msg([entry(3, id=587, position=moved)]),
        "no size": map_msg([entry(3, size=0.0)]),
        "size is NaN": map_msg([entry(3, size=math.nan)]),
        "position is infinite": map_msg([entry(3, pose=infinite)]),
        "quaternion is zero": map_msg([entry(3, pose=unturned)]),
        "covariance is NaN": map_msg([uncertain]),
        "no frame": map_msg([entry(3, position=moved)], frame=""),
    }


class BadMarkersTest(PoseTest):
    @classmethod
    def setUpClass(cls):
        cls.stamps = stamps()
        cls.mount = publish_mount()
        cls.diagnostics = Diagnostics()
        cls.markers = rospy.Publisher("markers", MarkerArray, queue_size=10)
        cls.maps = rospy.Publisher("marker_map/entries", MarkerMapEntries, queue_size=10)

    def setUp(self):
        super().setUp()
        self.assertTrue(until(lambda: self.markers.get_num_connections() > 0))
        self.assertTrue(until(lambda: self.maps.get_num_connections() > 0))
        self.take_map()

    def take_map(self):
        """Makes the true map the locator's."""

        def answered():
            self.maps.publish(map_msg())
            return self.poses.at(self.show(), 0.2) is not None

        self.assertTrue(until(answered))

    def show(self, msg=None):
        msg = markers_msg(None) if msg is None else msg
        msg.header.stamp = next(self.stamps)
        self.markers.publish(msg)
        return msg.header.stamp

    def assert_still_right(self):
        self.assertTrue(until(lambda: self.poses.at(self.show(), 0.2) is not None), "no pose any more")

    def test_what_cannot_be_gives_no_pose(self):
        for name, msg in bad_markers().items():
            bad = self.show(msg)
            rospy.sleep(0.1)  # longer than transform_timeout, so that the next does not take its place
            self.assert_still_right()
            self.assertFalse(self.poses.has(bad), name)
        count = self.diagnostics.count
        self.assertTrue(self.diagnostics.reaches(LOCALIZATION, "not used: markers", 6))
        self.assertTrue(self.diagnostics.reaches(LOCALIZATION, "not used: transform", 1))
        self.assertGreaterEqual(count(LOCALIZATION, "not used: repeated marker"), 1)
        self.assertEqual(count(LOCALIZATION, "not in the map: tag25h9/3"), 1)

    def test_a_marker_that_the_map_does_not_have_or_that_is_there_twice_is_left_out(self):
        more = [marker_msg(7, corners=corners_of(3)), marker_msg(3), marker_msg(5)]
        self.assertIsNotNone(self.poses.at(self.show(markers_msg(None, more))))
        twice = [marker_msg(3, corners=corners_of(3) + 50), marker_msg(5), marker_msg(3)]
        self.assertIsNotNone(self.poses.at(self.show(markers_msg(None, twice))))

    def test_a_stamp_of_zero_gives_no_pose(self):
        msg = markers_msg(rospy.Time(0))
        self.markers.publish(msg)
        rospy.sleep(0.1)
        self.assert_still_right()
        self.assertFalse(self.poses.has(rospy.Time(0)))

    def test_a_map_that_cannot_be_leaves_the_old_one(self):
        for number, (name, msg) in enumerate(bad_maps().items(), 1):
            before = self.diagnostics.count(LOCALIZATION, "not used: map")
            self.maps.publish(msg)
            self.assertTrue(
                self.diagnostics.reaches(LOCALIZATION, "not used: map", before + 1), (number, name)
            )
            self.assert_still_right()

    def test_no_marker_and_no_map(self):
        stamp = self.show(markers_msg(None, []))
        self.assert_still_right()
        self.assertFalse(self.poses.has(stamp))

        def silent():
            self.maps.publish(map_msg([]))
            return self.poses.at(self.show(), 0.2) is None

        self.assertTrue(until(silent))
        self.take_map()


if __name__ == "__main__":
    rospy.init_node("bad_markers_test")
    rostest.rosrun("sextant", "bad_markers", BadMarkersTest)
