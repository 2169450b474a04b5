# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that drives through a simulated plane and publishes what it measures, in lockstep with the node."""

import math

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from ros_probe import Recorder, until

import sextant
from sextant.geometry.plane_poses import composed, in_frame
from sextant.msg import LandmarkMapEntries, LandmarkObservation, LandmarkObservations
from sextant.simulation.landmark_world import LandmarkWorld, LandmarkWorldParams

BEGIN = 1000.0  # s
START_SIGMA = 0.001  # m and rad


def seconds(stamp):
    """As ros::Time::toSec(), to the last bit."""
    return stamp.secs + 1e-9 * stamp.nsecs


def odometry_msg(stamp, pose, robot):
    """A pose (3,) by odometry; the speed is a mark that must come back."""
    msg = Odometry(child_frame_id=f"base_{robot}")
    msg.header.stamp, msg.header.frame_id = stamp, f"odom_{robot}"
    msg.pose.pose.position.x, msg.pose.pose.position.y = pose[:2]
    msg.pose.pose.orientation.z, msg.pose.pose.orientation.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
    msg.twist.twist.linear.x = 0.5
    return msg


def observations_msg(stamp, seen, robot):
    """Of SimulatedObservation."""
    msg = LandmarkObservations()
    msg.header.stamp, msg.header.frame_id = stamp, f"base_{robot}"
    for each in seen:
        covariance = np.zeros((3, 3))
        covariance[:2, :2] = each.covariance
        msg.observations.append(
            LandmarkObservation(each.class_name, -1, *each.position, math.nan, covariance.ravel().tolist())
        )
    return msg


def planar(pose):
    """(3,) of a message, computed as planarFromMsg() does."""
    z, w = pose.orientation.z, pose.orientation.w
    length = math.sqrt(z * z + w * w)
    z, w = z / length, w / length
    return np.array([pose.position.x, pose.position.y, math.atan2(2 * z * w, 1 - 2 * z * z)])


def planar_covariance(estimate):
    """(3, 3) of x, y, heading of a PoseWithCovariance."""
    return np.reshape(estimate.covariance, (6, 6))[np.ix_([0, 1, 5], [0, 1, 5])]


def squared_distance(estimate, truth):
    """Squared deviations of a PoseWithCovariance from a pose (3,)."""
    off = planar(estimate.pose) - truth
    off[2] = math.remainder(off[2], 2 * math.pi)
    return off @ np.linalg.solve(planar_covariance(estimate), off)


class LandmarkRobot:
    """In a namespace that its frames end in. The map's frame is where it starts."""

    def __init__(self, name, **world):
        self.name = name
        self.world = LandmarkWorld(LandmarkWorldParams(**world))
        self.places = in_frame(self.world.start, self.world.positions)  # (n, 2) of the landmarks
        self.odometry = rospy.Publisher(f"/{name}/odom", Odometry, queue_size=1000)
        self.observations = rospy.Publisher(f"/{name}/landmarks", LandmarkObservations, queue_size=100)
        self.poses = Recorder(f"/{name}/pose", PoseWithCovarianceStamped)
        self.filtered = Recorder(f"/{name}/odometry/filtered", Odometry)
        self.entries = Recorder(f"/{name}/landmark_map/entries", LandmarkMapEntries)
        self.timeline = sextant.LandmarkTimeline(
            sextant.LandmarkTimelineParams(),
            sextant.LandmarkSlam(
                sextant.LandmarkSlamParams(), np.zeros(3), START_SIGMA * START_SIGMA * np.eye(3)
            ),
        )

    def connect(self):
        """Whether everything has its connection."""
        return (
            all(each.connected() for each in (self.poses, self.filtered, self.entries))
            and until(lambda: self.odometry.get_num_connections() > 0)
            and until(lambda: self.observations.get_num_connections() > 0)
        )

    def begin(self):
        """The same drive from its start."""
        self.steps = self.world.steps()
        self.pose = np.zeros(3)  # by odometry
        self.truth = {}  # pose (3,) in the map by the stamps that the sensor looked at
        self.stamp = rospy.Time.from_sec(BEGIN)
        self.publish_odometry(self.pose)

    def publish_odometry(self, pose, stamp=None):
        """Publishes odometry and adds it to the timeline."""
        msg = odometry_msg(self.stamp if stamp is None else stamp, pose, self.name)
        self.odometry.publish(msg)
        self.timeline.odometry(seconds(msg.header.stamp), planar(msg.pose.pose))

    def drive(self, duration, done=lambda: False):
        """For so many seconds, or until it is done. False: something was not used, or the drive is over."""
        end = seconds(self.stamp) + duration
        for step in self.steps:
            self.stamp = rospy.Time.from_sec(BEGIN + step.stamp)
            self.pose = composed(self.pose, step.odometry_step)
            self.publish_odometry(self.pose)
            if step.scan is not None and not self.scan(step):
                return False
            if done() or seconds(self.stamp) >= end - 1e-6:
                return True
        return False

    def scan(self, step):
        x, y, heading = step.pose
        self.truth[self.stamp] = np.array(
            [*in_frame(self.world.start, step.pose[None, :2])[0], heading - self.world.start[2]]
        )
        msg = observations_msg(self.stamp, step.scan.observations, self.name)
        self.observations.publish(msg)
        self.timeline.observe(seconds(self.stamp), [labelled(each) for each in msg.observations])
        return self.entries.at(self.stamp) is not None


def labelled(msg):
    """LabelledObservation of a LandmarkObservation without a heading."""
    covariance = np.reshape(msg.covariance, (3, 3))[:2, :2]
    return sextant.LabelledObservation(
        sextant.LandmarkLabel(msg.class_name), sextant.Observation2D([msg.x, msg.y], covariance)
    )
