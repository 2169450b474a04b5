#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from landmark_robot import planar
from launched_demo import DemoTest
from nav_msgs.msg import Odometry
from ros_probe import Recorder, until
from sensor_msgs.msg import Image
from std_srvs.srv import Trigger

from sextant.msg import MarkerArray, PlaceHypotheses

PATIENCE = 240.0  # s of the wall's clock, on a busy machine
NEAR, DEVIATION = 1.0, 1.0  # m: error of the pose, and standard deviation that it states
STEADY = 40  # poses


class BuildingDemoTest(DemoTest):
    """With fewer photos than the launch file has."""

    LAUNCH, ARGS = "building_demo.launch", {"spacing": 6.0, "seed": 1}
    UNWANTED = ("Traceback",)  # on a busy machine a node may take longer to end than roslaunch waits

    @classmethod
    def setUpClass(cls):
        cls.truth, cls.poses = Recorder("ground_truth", Odometry), Recorder("pose", PoseWithCovarianceStamped)
        cls.places = Recorder("places/hypotheses", PlaceHypotheses)
        cls.markers = Recorder("markers", MarkerArray)
        super().setUpClass()

    def last(self):
        """Errors and standard deviations of the newest poses, m."""
        newest = self.poses.all()[-2 * STEADY :]
        poses = [each for each in newest if self.truth.has(each.header.stamp)][-STEADY:]
        deviations = [np.sqrt(each.pose.covariance[0] + each.pose.covariance[7]) for each in poses]
        return np.array([self.error(each) for each in poses]), np.array(deviations)

    def error(self, pose):
        """Metres from the truth of that stamp."""
        truth = self.truth.at(pose.header.stamp)
        return np.hypot(*(planar(pose.pose.pose) - planar(truth.pose.pose))[:2])

    def is_localized(self):
        errors, deviations = self.last()
        return len(errors) == STEADY and errors.max() < NEAR and deviations.max() < DEVIATION

    def has_place(self):
        return any(each.places and each.unknown_probability < 0.5 for each in self.places.all())

    def test_the_robot_is_localized_and_relocalized_after_it_was_carried(self):
        self.assertTrue(until(self.is_localized, PATIENCE), self.log.read_text())
        self.assertTrue(until(self.has_place, PATIENCE), "no place was recognized")
        self.assertTrue(until(lambda: any(each.markers for each in self.markers.all())), "no marker detected")
        answer = rospy.ServiceProxy("building_simulator/kidnap", Trigger)()
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(until(lambda: self.last()[0].max(initial=0) > NEAR), "it was not carried")
        self.assertTrue(until(self.is_localized, PATIENCE), self.last())
        for topic in ("markers/image", "places/image"):
            self.assertGreater(rospy.wait_for_message(topic, Image, 60.0).width, 0)


if __name__ == "__main__":
    rospy.init_node("building_demo_test")
    rostest.rosrun("sextant", "building_demo", BuildingDemoTest)
