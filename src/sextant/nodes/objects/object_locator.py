# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node object_locator: locates detected pillars and balls in depth images, and tracks the ball."""

import threading
import time
from typing import Iterable, List, Tuple

import numpy as np
import rospy
from diagnostic_updater import Updater
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from sextant.messages.image_messages import depth_image
from sextant.msg import LandmarkObservations, ObjectBox, Objects
from sextant.nodes.base.exits import until_shutdown
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.base.stamp_pairs import Pair, StampPairs
from sextant.nodes.objects.ball_follower import BallFollower, TrackedBall
from sextant.nodes.objects.object_locator_node_params import ObjectLocatorNodeParams
from sextant.nodes.objects.object_locator_report import ObjectLocatorReport
from sextant.nodes.objects.object_messages import (
    SeenObject,
    ball_markers,
    ball_message,
    observations_message,
    seen_markers,
)
from sextant.nodes.objects.rgbd_locator import COLOUR, DEPTH, RgbdLocator
from sextant.objects.ball_observations import BallObservations
from sextant.objects.ball_tracker import BallTracker
from sextant.objects.ball_visibility import BallVisibility
from sextant.objects.object_kinds import kinds_of

REPORT_EVERY = 1.0  # seconds between diagnostics
BUFFER = 2**24  # bytes, receive buffer of a subscription


class ObjectLocatorNode:
    """Processes everything in the callbacks, one at a time."""

    def __init__(self, params: ObjectLocatorNodeParams):
        self._params, self._kinds = params, kinds_of(params.kinds)
        self._radius = min(
            [kind.radius for kind in self._kinds.values() if kind.shape == "ball"], default=0.0
        )
        self._locator = RgbdLocator(params.locator, params.base_frame)
        self._pairs, self._ball = StampPairs(params.slop), BallFollower(BallTracker(params.ball))
        self._drawn: List[Marker] = []  # markers of the ball
        self._lock, self._stop = threading.Lock(), threading.Event()
        self._report, self._updater = ObjectLocatorReport(), Updater()
        self._updater.setHardwareID("none")
        self._updater.add("objects", lambda row: self._report.fill_diagnostics(row, self._pairs.unmatched))
        rospy.on_shutdown(self._stop.set)
        self._landmarks = rospy.Publisher("landmarks", LandmarkObservations, queue_size=10)
        self._balls = rospy.Publisher("ball", Odometry, queue_size=10)
        self._visualization = rospy.Publisher("visualization", MarkerArray, queue_size=1)
        for topic in (COLOUR, DEPTH):
            rospy.Subscriber(topic, CameraInfo, self._on_info, topic, queue_size=1)
        rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=100)
        rospy.Subscriber("depth/image", Image, self._on_depth, queue_size=5, buff_size=BUFFER)
        rospy.Subscriber("objects", Objects, self._on_objects, queue_size=10)

    def run(self) -> None:
        """Publish diagnostics until the node is shut down."""
        while not self._stop.wait(REPORT_EVERY):
            self._updater.force_update()

    def _on_info(self, info: CameraInfo, topic: str) -> None:
        with self._lock:
            self._locator.set_info(topic, info)

    def _on_objects(self, objects: Objects) -> None:
        with self._lock:
            self._process(self._pairs.add_first(objects))

    def _on_depth(self, depth: Image) -> None:
        with self._lock:
            self._process(self._pairs.add_second(depth))

    def _on_odometry(self, odometry: Odometry) -> None:
        with self._lock:
            try:
                self._publish_ball(self._ball.add_odometry(odometry))
            except ValueError as error:
                rospy.logwarn_throttle(10.0, "odometry rejected: %s", error)

    def _process(self, pairs: Iterable[Pair]) -> None:
        for objects, depth in pairs:
            begin = time.perf_counter()
            try:
                seen, T_base_colour = self._seen(objects, depth)
            except ValueError as error:
                self._report.rejected(str(error))
                continue
            self._report.processed(len(objects.objects), len(seen), time.perf_counter() - begin)
            self._publish(seen, T_base_colour, objects.header.stamp)

    def _seen(self, objects: Objects, depth: Image) -> Tuple[List[SeenObject], np.ndarray]:
        """The located objects, and T_base_colour. :raises ValueError: why nothing can be located"""
        metres = depth_image(depth)
        if not metres.any():
            raise ValueError(f"{rospy.resolve_name('depth/image')}: no pixel has a depth")
        locator, T_base_colour = self._locator.at(objects.header, depth.header)
        size = tuple(self._locator.colour.size)
        if (objects.width, objects.height) != size:
            image, camera = f"{objects.width}×{objects.height}", f"{size[0]}×{size[1]}"
            raise ValueError(f"the image is {image}, its camera_info has {camera}")
        known = self._known(objects.objects)
        boxes = np.array([[each.left, each.top, each.right, each.bottom] for each in known]).reshape(-1, 4)
        kinds = [self._kinds[each.class_name] for each in known]
        places = locator.locate(metres, boxes, kinds, T_base_colour)
        seen = [SeenObject(each.class_name, *rest) for each, *rest in zip(known, kinds, places)]
        return [each for each in seen if each.place is not None], T_base_colour

    def _known(self, objects: List[ObjectBox]) -> List[ObjectBox]:
        """The objects of classes in kinds; others are reported."""
        for name in {each.class_name for each in objects} - set(self._kinds):
            self._report.unknown(name)
        return [each for each in objects if each.class_name in self._kinds]

    def _publish(self, seen: List[SeenObject], T_base_colour: np.ndarray, stamp: rospy.Time) -> None:
        header = Header(stamp=stamp, frame_id=self._params.base_frame)
        self._landmarks.publish(observations_message(seen, header))
        if self._radius:
            observations = BallObservations.of(
                [(each.kind, each.place) for each in seen], T_base_colour, self._visibility()
            )
            self._publish_ball(self._ball.add_observations(stamp.to_nsec(), observations))
        if self._visualization.get_num_connections():
            self._visualization.publish(MarkerArray(seen_markers(seen, header) + self._drawn))

    def _visibility(self) -> BallVisibility:
        params = self._params
        return BallVisibility(
            self._locator.colour, self._radius, params.locator.min_depth + 0.2, params.ball_detection_range
        )

    def _publish_ball(self, tracked: Iterable[TrackedBall]) -> None:
        for stamp, frame, ball in tracked:
            header = Header(stamp=rospy.Time(nsecs=stamp), frame_id=frame)
            self._drawn = ball_markers(ball, self._radius, header) if ball else []
            if ball:
                self._balls.publish(ball_message(ball, self._radius, header))
        self._report.counts["images without odometry"] = self._ball.without_odometry


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter is invalid."""
    init_node("object_locator")
    node = ObjectLocatorNode(read_params(ObjectLocatorNodeParams))
    with until_shutdown():
        node.run()
