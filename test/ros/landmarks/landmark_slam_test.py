#!/usr/bin/env python3
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import tempfile
import unittest

import numpy as np
import rospy
import rostest
from geometry_msgs.msg import PoseWithCovarianceStamped
from landmark_robot import (
    LandmarkRobot,
    observations_msg,
    odometry_msg,
    planar,
    planar_covariance,
    seconds,
    squared_distance,
)
from ros_probe import Diagnostics, Recorder, TransformRecorder, until
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker as Shape
from visualization_msgs.msg import MarkerArray as Shapes

import sextant
from sextant.msg import PlaceHypotheses, PlaceHypothesis
from sextant.simulation.landmark_world import SimulatedObservation
from sextant.srv import LandmarkMapFile

NEAR = 0.3  # m and rad, of a robot that has found itself
THREE_SIGMA = 14.16  # squared, in three dimensions: 0.27 % are beyond
LAST = rospy.Time(2**32 - 1, 10**9 - 1)  # its seconds, as a float, are 2**32: no stamp any more
LATE = rospy.Time(2**32 - 1)  # a rospy.Duration cannot hold its difference from stamps of today
WORLD = {"seed": 3, "landmarks": 15, "half_side": 5.0, "field_of_view": 2.0}


class LandmarkSlamTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.transforms = TransformRecorder()

    def robot(self, name, **world):
        self.name = name
        robot = LandmarkRobot(name, **{**WORLD, **world})
        self.assertTrue(robot.connect())
        robot.begin()
        return robot

    def call(self, service, type_=Trigger, *request):
        """The answer of one of the robot's services."""
        name = f"/{self.name}/slam/{service}"
        rospy.wait_for_service(name, 10)
        return rospy.ServiceProxy(name, type_)(*request)

    def status(self):
        return f"{self.name}/slam: slam"

    def summary(self, text):
        return until(lambda: text in self.diagnostics.summary(self.status()))

    def assert_drives(self, robot, duration, done=lambda: False):
        self.assertTrue(robot.drive(duration, done), "observations were not used")

    def assert_found(self, robot, least=0):
        """It is lost, and drives until it knows where it is."""
        self.assert_drives(robot, 1)
        self.assertFalse(robot.poses.has(robot.stamp))
        self.assertFalse(robot.filtered.has(robot.stamp))
        self.assertTrue(self.summary("lost"), self.diagnostics.summary(self.status()))
        self.assert_drives(robot, 60, lambda: robot.poses.at(robot.stamp, 0.02) is not None)
        off = planar(robot.poses.at(robot.stamp).pose.pose) - robot.truth[robot.stamp]
        self.assertLess(np.hypot(*off[:2]), NEAR)
        self.assertLess(abs(math.remainder(off[2], 2 * math.pi)), NEAR)

    def test_a_drive(self):
        robot = self.robot("a")
        self.assert_drives(robot, 40)
        squares = [squared_distance(robot.poses.at(at).pose, truth) for at, truth in robot.truth.items()]
        self.assertEqual(len(squares), 200)
        self.assertGreater(np.mean(np.array(squares) < THREE_SIGMA), 0.97, squares)
        self.assert_places_are_true(robot)
        self.assert_same_offline(robot)
        self.assert_transform_changes_with_observations(robot)
        self.assert_diagnostics()
        self.assert_pictures(robot)

    def assert_places_are_true(self, robot):
        found = robot.entries.at(robot.stamp).landmarks
        self.assertGreater(len(found), 10)
        for entry in found:
            off = robot.places - [entry.x, entry.y]
            nearest = np.argmin(np.hypot(*off.T))
            covariance = np.reshape(entry.covariance, (3, 3))[:2, :2]
            self.assertLess(off[nearest] @ np.linalg.solve(covariance, off[nearest]), THREE_SIGMA)
            self.assertEqual(entry.class_name, robot.world.classes[nearest])
            self.assertTrue(math.isnan(entry.heading))
        self.assertEqual(len({entry.key for entry in found}), len(found))

    def assert_same_offline(self, robot):
        """Bit by bit, with one more odometry: it may be published before the observations of its stamp."""
        entries = robot.entries.at(robot.stamp).landmarks
        self.assert_drives(robot, 0.05)
        now, published = robot.timeline.now, robot.filtered.at(robot.stamp)
        self.assertEqual(now.stamp, seconds(robot.stamp))
        self.assertEqual([published.pose.pose.position.x, published.pose.pose.position.y], list(now.pose[:2]))
        self.assertAlmostEqual(planar(published.pose.pose)[2], now.pose[2], 12)
        np.testing.assert_array_equal(planar_covariance(published.pose), now.covariance)
        landmarks = robot.timeline.slam.filter.landmarks
        np.testing.assert_array_equal([each.position for each in landmarks], [[e.x, e.y] for e in entries])
        self.assertEqual([e.key for e in entries], robot.timeline.slam.keys)
        self.assertEqual((published.header.frame_id, published.child_frame_id), ("map", "base_a"))
        self.assertEqual(published.twist.twist.linear.x, 0.5)

    def assert_transform_changes_with_observations(self, robot):
        received = sorted(
            (stamp, T) for (parent, child, stamp), T in self.transforms.seen.items() if child == "odom_a"
        )
        self.assertEqual({key[0] for key in self.transforms.seen if key[1] == "odom_a"}, {"map"})
        self.assertGreater(len(received), 700)  # 800 readings of odometry
        moves = {
            False: [0.0],
            True: [0.0],
        }  # by whether there were observations; they may come after odometry
        for (last, before), (now, T) in zip(received, received[1:]):
            moves[last in robot.truth or now in robot.truth].append(np.abs(T - before).max())
        self.assertLess(max(moves[False]), 1e-9)
        self.assertGreater(max(moves[True]), 1e-4)

    def assert_diagnostics(self):
        self.assertTrue(self.summary("working"))
        self.assertTrue(self.diagnostics.reaches(self.status(), "observations associated", 400))
        self.assertEqual(self.diagnostics.count(self.status(), "scans too late"), 0)
        self.assertLess(float(self.diagnostics.row(self.status(), "NIS per degree of freedom")), 1.5)

    def assert_pictures(self, robot):
        shapes = []
        listener = rospy.Subscriber("/a/landmark_map", Shapes, lambda msg: shapes.append(msg.markers))
        self.addCleanup(listener.unregister)
        self.assertTrue(until(lambda: shapes))
        pillars = [shape for shape in shapes[-1] if shape.ns == "pillars" and shape.action == Shape.ADD]
        self.assertEqual(len(pillars), len(robot.timeline.slam.labels))

    def test_maps_are_written_and_read_and_the_robot_finds_itself(self):
        robot = self.robot("b")
        refused = self.call("relocalize")
        self.assertFalse(refused.success)
        self.assertFalse(self.call("save_map", LandmarkMapFile, "").success)  # there is no ~map_file
        self.assert_drives(robot, 40)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "map.yaml")
            answer = self.call("save_map", LandmarkMapFile, path)
            self.assertTrue(answer.success, answer.message)
            entries = robot.entries.at(robot.stamp).landmarks
            self.assertEqual(answer.message, f"{len(entries)} landmarks written to {path}")
            saved = sextant.read_landmark_map(path)
            np.testing.assert_array_equal(
                [each.position for each in saved.landmarks], [[e.x, e.y] for e in entries]
            )
            self.assert_bad_maps_change_nothing(robot, folder)
            self.assertTrue(self.call("load_map", LandmarkMapFile, path).success)
            self.assert_found(robot)
            starts = Recorder("/b/initialpose", PoseWithCovarianceStamped)
            self.assertTrue(starts.connected())
            self.assertTrue(self.call("relocalize").success)
            self.assert_found(robot)
            self.assertEqual(starts.at(robot.stamp).pose, robot.poses.at(robot.stamp).pose)  # for amcl
            self.assert_drives(robot, 1)
            self.assertEqual(len(starts.all()), 1)
            starts.close()
            self.assert_initialpose(robot)
            self.assert_reset(robot)

    def assert_bad_maps_change_nothing(self, robot, folder):
        broken = os.path.join(folder, "broken.yaml")
        with open(broken, "w") as file:
            file.write("frame: map\nrobot: [0, 0]\nlandmarks: []\ncovariance: []\n")
        for path, reason in [(broken, broken + ":2"), (folder + "/none.yaml", "none.yaml: cannot be read")]:
            answer = self.call("load_map", LandmarkMapFile, path)
            self.assertFalse(answer.success)
            self.assertIn(reason, answer.message)
        before = len(robot.entries.at(robot.stamp).landmarks)
        self.assert_drives(robot, 0.6)
        self.assertIsNotNone(robot.poses.at(robot.stamp))
        self.assertGreaterEqual(len(robot.entries.at(robot.stamp).landmarks), before)

    def publish_pose(self, robot, frame, pose, variance):
        msg = PoseWithCovarianceStamped(pose=odometry_msg(robot.stamp, pose, self.name).pose)
        msg.header.frame_id = frame
        msg.pose.covariance = np.diag([variance, variance, 0, 0, 0, variance]).ravel().tolist()
        poses = rospy.Publisher(f"/{self.name}/initialpose", PoseWithCovarianceStamped, queue_size=5)
        self.addCleanup(poses.unregister)
        self.assertTrue(until(lambda: poses.get_num_connections() > 0))
        poses.publish(msg)

    def assert_initialpose(self, robot):
        for frame, variance, count in [("odom_b", 0.01, 1), ("map", 0.0, 2), ("map", math.nan, 3)]:
            self.publish_pose(robot, frame, np.array([50.0, 50.0, 0.0]), variance)
            self.assertTrue(self.diagnostics.reaches(self.status(), "not used: initialpose", count))
        self.assertTrue(self.call("relocalize").success)
        truth = robot.truth[robot.stamp]
        self.publish_pose(robot, "map", truth, 0.01)

        def published():
            robot.stamp += rospy.Duration(0.001)
            robot.publish_odometry(robot.pose)
            return robot.filtered.at(robot.stamp, 0.2) is not None

        self.assertTrue(until(published))
        estimate = robot.filtered.at(robot.stamp).pose
        np.testing.assert_allclose(planar(estimate.pose), truth, atol=1e-6)
        np.testing.assert_allclose(planar_covariance(estimate), 0.01 * np.eye(3), atol=1e-4)
        self.assert_drives(robot, 2)
        seen = max(robot.truth)
        self.assertLess(squared_distance(robot.poses.at(seen).pose, robot.truth[seen]), 25)

    def assert_reset(self, robot):
        self.assertTrue(self.call("reset").success)
        self.assert_drives(robot, 0.3)
        seen = max(robot.truth)
        self.assertEqual(robot.entries.at(seen).landmarks, [])
        self.assertLess(np.hypot(*planar(robot.poses.at(seen).pose.pose)[:2]), 0.2)  # 0.3 s of motion

    def test_what_cannot_be_is_left_out(self):
        robot = self.robot("c")
        self.assert_drives(robot, 2)
        for number, (kind, publish) in enumerate(bad_messages(robot)):
            before = self.diagnostics.count(self.status(), "not used: " + kind)
            publish()
            self.assertTrue(
                self.diagnostics.reaches(self.status(), "not used: " + kind, before + 1), (number, kind)
            )
            if kind == "odometry":  # it comes, but is not used
                self.assertNotIn("no odometry", self.diagnostics.summary(self.status()))
        self.assert_drives(robot, 2)
        self.assertLess(squared_distance(robot.poses.at(robot.stamp).pose, robot.truth[robot.stamp]), 25)
        robot.publish_odometry(robot.pose + [3, 0, 0], robot.stamp + rospy.Duration(0.05))
        self.assertTrue(self.diagnostics.reaches(self.status(), "not used: odometry jump", 1))

    def places(self, robot, frame, *poses):
        """Of the newest image: pairs of a pose (3,) and its probability."""
        msg = PlaceHypotheses(frame=frame)
        msg.header.stamp = robot.stamp
        for number, (pose, probability) in enumerate(poses):
            place = PlaceHypothesis(id=number, probability=probability)
            place.pose.pose = odometry_msg(robot.stamp, pose, self.name).pose.pose
            place.pose.covariance = np.diag([0.1, 0.1, 1e6, 3.0, 3.0, 0.1]).ravel().tolist()
            msg.places.append(place)
        return msg

    def test_a_lost_robot_is_at_the_recognized_places_until_landmarks_decide(self):
        robot = self.robot("e")
        self.assert_drives(robot, 40)
        publisher = rospy.Publisher("/e/places/hypotheses", PlaceHypotheses, queue_size=5)
        self.assertTrue(until(lambda: publisher.get_num_connections() > 0))
        self.assertTrue(self.call("relocalize").success)
        truth = robot.truth[max(robot.truth)]
        elsewhere = truth + [3.0, -2.0, 1.0]
        for number, frame in enumerate(("", "nowhere"), 1):
            publisher.publish(self.places(robot, frame, (truth, 0.9)))
            self.assertTrue(self.diagnostics.reaches(self.status(), "not used: places", number))
        publisher.publish(self.places(robot, "map", (elsewhere, 0.5), (truth, 0.4)))
        self.assertTrue(self.diagnostics.reaches(self.status(), "images that relocalized the robot", 1))
        self.assertTrue(self.diagnostics.reaches(self.status(), "hypotheses", 2))
        self.assert_drives(robot, 5)
        seen = max(robot.truth)
        self.assertLess(squared_distance(robot.poses.at(seen).pose, robot.truth[seen]), 25)
        self.assertLess(np.trace(planar_covariance(robot.poses.at(seen).pose)), 0.3)

    def test_a_recording_that_is_played_twice(self):
        robot = self.robot("d")
        self.assert_drives(robot, 30)
        known = len(robot.entries.at(robot.stamp).landmarks)
        for recorder in (robot.poses, robot.filtered, robot.entries):
            recorder.forget()
        robot.begin()  # observations that come before odometry has jumped are too late
        self.assertTrue(self.diagnostics.reaches(self.status(), "not used: clock", 1))
        self.assert_found(robot)
        self.assertGreaterEqual(len(robot.entries.at(robot.stamp).landmarks), known)
        self.assertEqual(self.diagnostics.count(self.status(), "not used: clock"), 1)


def bad_messages(robot):
    """(kind, what publishes it) of messages that cannot be."""
    soon = robot.stamp + rospy.Duration(0.001)

    def odometry(change, stamp=soon):
        msg = odometry_msg(stamp, robot.pose, robot.name)
        change(msg)
        return "odometry", lambda: robot.odometry.publish(msg)

    def observations(kind, stamp=robot.stamp, **change):
        seen = SimulatedObservation(np.array([2.0, 0.0]), 0.01 * np.eye(2), "pillar", None)
        msg = observations_msg(stamp, [seen, seen], robot.name)
        msg.header.frame_id = change.pop("frame", msg.header.frame_id)
        for name, value in change.items():
            setattr(msg.observations[1], name, value)
        return kind, lambda: robot.observations.publish(msg)

    return [
        odometry(lambda msg: setattr(msg.pose.pose.position, "x", math.nan)),
        odometry(lambda msg: setattr(msg.pose.pose.position, "y", math.inf)),
        odometry(lambda msg: setattr(msg.pose.pose.position, "x", 1e300)),
        odometry(lambda msg: setattr(msg.pose.pose.orientation, "w", 2.0)),
        odometry(lambda msg: setattr(msg, "child_frame_id", "")),
        odometry(lambda msg: setattr(msg.header, "frame_id", "")),
        odometry(lambda msg: None, rospy.Time(0)),
        odometry(lambda msg: None, robot.stamp),  # again
        observations("observations", x=math.nan),
        observations("observations", heading=math.inf),
        observations("observations", covariance=[0.0] * 9),
        observations("observations", covariance=[-1.0, 0, 0, 0, -1.0, 0, 0, 0, 0]),
        observations("observations", class_name=""),
        observations("observations", stamp=LAST),
        odometry(lambda msg: None, LAST),
        observations("observations too late", stamp=robot.stamp - rospy.Duration(5)),
        observations("observations ahead", stamp=robot.stamp + rospy.Duration(60)),
        odometry(lambda msg: None, LATE),
        observations("transform", frame="nowhere"),
        observations("transform", frame=""),
        observations("transform", stamp=rospy.Time(0)),
    ]


if __name__ == "__main__":
    rospy.init_node("landmark_slam_test")
    rostest.rosrun("sextant", "landmark_slam", LandmarkSlamTest)
