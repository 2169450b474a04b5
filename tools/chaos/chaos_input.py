# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Good input of each system for a robot that stands still, and recorders of the answers."""

import itertools
import math

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from made_photos import picture, shifted
from marker_scene import CAMERA, T_BASE_CAMERA, T_MAP_BASE, camera_info, image_msg
from marker_scene import picture as marker_picture
from nav_msgs.msg import Odometry
from ros_probe import matrix, transform
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.msg import LandmarkObservation, LandmarkObservations
from sextant.msg import Places as PlacesMessage
from sextant.nodes.simulation.ball_messages import depth_to_message
from sextant.simulation.ball_ground import Pillar
from sextant.simulation.ball_simulation import BallSimulation, BallSimulationParams
from sextant.simulation.ball_world import BallWorld

PILLARS = (
    (2.0, 0.5, "red_pillar"),
    (2.5, -0.7, "blue_pillar"),
    (3.5, 0.2, "red_pillar"),
    (1.5, 1.0, "blue_pillar"),
)
POSITION = 0.05  # m that a pose from markers may be wrong


class System:
    """Topics with a type for each, and the topic of the answer."""

    name, topics, answer = "", {}, ("", None)

    def __init__(self):
        self._publishers = {
            topic: rospy.Publisher(topic, kind, queue_size=5) for topic, kind in self.topics.items()
        }
        self._last = rospy.Time()  # of the input that was answered
        rospy.Subscriber(*self.answer, self._on_answer, queue_size=10)

    def publish(self, topic, message):
        """Publishes a message of a topic of this system."""
        self._publishers[topic].publish(message)

    def messages(self, stamp):
        """[(topic, message)] of good input."""
        raise NotImplementedError

    def is_right(self, message):
        """Whether an answer is right."""
        raise NotImplementedError

    def static_transforms(self):
        """Of the robot: [TransformStamped]."""
        return []

    def _on_answer(self, message):
        if self.is_right(message):
            self._last = message.header.stamp

    def answers_since(self, stamp):
        """Whether good input of this stamp or later was answered. The clock may have jumped back since."""
        return stamp <= self._last <= stamp + rospy.Duration(60.0)


class Markers(System):
    """Images of two markers: a pose."""

    name, answer = "markers", ("pose", PoseWithCovarianceStamped)
    topics = {"image": Image, "camera_info": CameraInfo}

    def __init__(self):
        super().__init__()
        self._pixels = marker_picture()

    def messages(self, stamp):
        return [("camera_info", camera_info(stamp)), ("image", image_msg(self._pixels, stamp))]

    def is_right(self, message):
        return np.linalg.norm(matrix(message.pose.pose)[:3, 3] - T_MAP_BASE[:3, 3]) < POSITION

    def static_transforms(self):
        return [transform(T_BASE_CAMERA, "base_link", CAMERA, rospy.Time())]


class Landmarks(System):
    """Odometry and observations of pillars: a pose, which is published when observations were used.

    Wrong odometry moves the robot in its map: any finite pose is right.
    """

    name, answer = "landmarks", ("landmarks/pose", PoseWithCovarianceStamped)
    topics = {"landmarks/odom": Odometry, "landmarks/landmarks": LandmarkObservations}

    def messages(self, stamp):
        odometry = Odometry(
            header=Header(stamp=stamp, frame_id="odom_landmarks"), child_frame_id="base_landmarks"
        )
        odometry.pose.pose.orientation.w = 1.0
        seen = LandmarkObservations(header=Header(stamp=stamp, frame_id="base_landmarks"))
        covariance = (0.03**2 * np.eye(3)).ravel().tolist()
        seen.observations = [
            LandmarkObservation(kind, -1, x, y, math.nan, covariance) for x, y, kind in PILLARS
        ]
        return [("landmarks/odom", odometry), ("landmarks/landmarks", seen)]

    def is_right(self, message):
        return np.isfinite(matrix(message.pose.pose)).all()


class Places(System):
    """Images of known places: a list of places."""

    name, answer = "places", ("places/places", PlacesMessage)
    topics = {"places/camera/image_raw": Image}

    def __init__(self, count):
        super().__init__()
        self._images = [shifted(picture(number), 6, 2) for number in range(count)]
        self._numbers = itertools.cycle(range(count))
        self._shown = {}  # number of the photo by stamp

    def messages(self, stamp):
        number = self._shown[stamp] = next(self._numbers)
        return [("places/camera/image_raw", image_msg(self._images[number], stamp))]

    def is_right(self, message):
        return message.probabilities[0] > 0 and message.poses[0] == self._shown.get(message.header.stamp)


class ObjectInput(System):
    """Images, depth images and odometry of a robot before two pillars and a ball: located pillars."""

    name, answer = "objects", ("objects/landmarks", LandmarkObservations)
    topics = {
        "objects/image": Image, "objects/depth/image": Image, "objects/odom": Odometry,
        "objects/camera_info": CameraInfo, "objects/depth/camera_info": CameraInfo,
    }  # fmt: skip

    def __init__(self):
        super().__init__()
        pillars = [Pillar(1.0, 0.5, 0.05, "blue_pillar"), Pillar(1.8, -0.3, 0.05, "red_pillar")]
        world = BallWorld((8.0, 6.0), pillars, np.array([1.6, 0.2]), np.array([-0.5, 0.1, 0.0]))
        simulation = BallSimulation(world, BallSimulationParams(seed=4))
        self._camera, self._images = simulation.camera, simulation.take_images()

    def messages(self, stamp):
        colour, depth = (
            Header(stamp=stamp, frame_id=f"{name}_optical_frame") for name in ("colour", "depth")
        )
        odometry = Odometry(header=Header(stamp=stamp, frame_id="odom_objects"), child_frame_id="base_link")
        odometry.pose.pose.orientation.w = 1.0
        return [
            ("objects/odom", odometry),
            ("objects/camera_info", calibration_to_message(self._camera.colour, colour)),
            ("objects/depth/camera_info", calibration_to_message(self._camera.depth, depth)),
            ("objects/depth/image", depth_to_message(self._images.depth, "32FC1", depth)),
            ("objects/image", image_to_message(self._images.colour, colour)),
        ]

    def is_right(self, message):
        return len(message.observations) == 2

    def static_transforms(self):
        mounts = {"colour": self._camera.T_base_colour, "depth": self._camera.T_base_depth}
        return [
            transform(T, "base_link", f"{name}_optical_frame", rospy.Time()) for name, T in mounts.items()
        ]
