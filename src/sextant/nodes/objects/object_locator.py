# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells where detected pillars are, where a ball is and how fast, by the depth image beside the picture."""

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

from sextant.bags.pictures import depth_image
from sextant.msg import LandmarkSightings, ObjectBox, Objects
from sextant.nodes.base.exits import until_shutdown
from sextant.nodes.base.params import read_params
from sextant.nodes.base.stamp_pairs import Pair, StampPairs
from sextant.nodes.objects.ball_follower import BallFollower, Followed
from sextant.nodes.objects.object_locator_node_params import ObjectLocatorNodeParams
from sextant.nodes.objects.object_locator_report import ObjectLocatorReport
from sextant.nodes.objects.object_messages import (
    SeenObject,
    ball_markers,
    ball_message,
    seen_markers,
    sightings_message,
)
from sextant.nodes.objects.rgbd_locator import COLOUR, DEPTH, RgbdLocator
from sextant.objects.ball_look import BallLook
from sextant.objects.ball_tracker import BallTracker
from sextant.objects.ball_view import BallView
from sextant.objects.object_kinds import kinds_of

REPORT_EVERY = 1.0  # seconds, to diagnostics
BUFFER = 2**24  # bytes, of a connection


class ObjectLocatorNode:
    """Works in the callbacks, one at a time."""

    def __init__(self, params: ObjectLocatorNodeParams):
        self._params, self._kinds = params, kinds_of(params.kinds)
        self._radius = min(
            [kind.radius for kind in self._kinds.values() if kind.shape == "ball"], default=0.0
        )
        self._locator = RgbdLocator(params.locator, params.base_frame)
        self._pairs, self._ball = StampPairs(params.slop), BallFollower(BallTracker(params.ball))
        self._drawn: List[Marker] = []  # of the ball
        self._lock, self._stop = threading.Lock(), threading.Event()
        self._report, self._updater = ObjectLocatorReport(), Updater()
        self._updater.setHardwareID("none")
        self._updater.add("objects", lambda row: self._report.tell(row, self._pairs.alone))
        rospy.on_shutdown(self._stop.set)
        self._landmarks = rospy.Publisher("landmarks", LandmarkSightings, queue_size=10)
        self._balls = rospy.Publisher("ball", Odometry, queue_size=10)
        self._visualization = rospy.Publisher("visualization", MarkerArray, queue_size=1)
        for topic in (COLOUR, DEPTH):
            rospy.Subscriber(topic, CameraInfo, self._on_info, topic, queue_size=1)
        rospy.Subscriber("odom", Odometry, self._on_odometry, queue_size=100)
        rospy.Subscriber("depth/image", Image, self._on_depth, queue_size=5, buff_size=BUFFER)
        rospy.Subscriber("objects", Objects, self._on_objects, queue_size=10)

    def run(self) -> None:
        """Until the node ends."""
        while not self._stop.wait(REPORT_EVERY):
            self._updater.force_update()

    def _on_info(self, info: CameraInfo, topic: str) -> None:
        with self._lock:
            self._locator.hear(topic, info)

    def _on_objects(self, objects: Objects) -> None:
        with self._lock:
            self._look(self._pairs.add_first(objects))

    def _on_depth(self, depth: Image) -> None:
        with self._lock:
            self._look(self._pairs.add_second(depth))

    def _on_odometry(self, odometry: Odometry) -> None:
        with self._lock:
            try:
                self._tell_ball(self._ball.move(odometry))
            except ValueError as error:
                rospy.logwarn_throttle(10.0, "odometry is not used: %s", error)

    def _look(self, pairs: Iterable[Pair]) -> None:
        for objects, depth in pairs:
            begin = time.perf_counter()
            try:
                seen, T_base_colour = self._seen(objects, depth)
            except ValueError as error:
                self._report.refused(str(error))
                continue
            self._report.used(len(objects.objects), len(seen), time.perf_counter() - begin)
            self._tell(seen, T_base_colour, objects.header.stamp)

    def _seen(self, objects: Objects, depth: Image) -> Tuple[List[SeenObject], np.ndarray]:
        """What was located, and T_base_colour. :raises ValueError: why nothing can be"""
        metres = depth_image(depth)
        if not metres.any():
            raise ValueError(f"{rospy.resolve_name('depth/image')}: no pixel has a depth")
        locator, T_base_colour = self._locator.at(objects.header, depth.header)
        size = tuple(self._locator.colour.size)
        if (objects.width, objects.height) != size:
            raise ValueError(
                f"the picture is {objects.width}×{objects.height}, its camera {size[0]}×{size[1]}"
            )
        known = self._known(objects.objects)
        boxes = np.array([[each.left, each.top, each.right, each.bottom] for each in known]).reshape(-1, 4)
        kinds = [self._kinds[each.class_name] for each in known]
        places = locator.locate(metres, boxes, kinds, T_base_colour)
        seen = [SeenObject(each.class_name, *rest) for each, *rest in zip(known, kinds, places)]
        return [each for each in seen if each.place is not None], T_base_colour

    def _known(self, objects: List[ObjectBox]) -> List[ObjectBox]:
        """Those of the kinds that there are."""
        for name in {each.class_name for each in objects} - set(self._kinds):
            self._report.unknown(name)
        return [each for each in objects if each.class_name in self._kinds]

    def _tell(self, seen: List[SeenObject], T_base_colour: np.ndarray, stamp: rospy.Time) -> None:
        header = Header(stamp=stamp, frame_id=self._params.base_frame)
        self._landmarks.publish(sightings_message(seen, header))
        if self._radius:
            look = BallLook.of([(each.kind, each.place) for each in seen], T_base_colour, self._view())
            self._tell_ball(self._ball.see(stamp.to_nsec(), look))
        if self._visualization.get_num_connections():
            self._visualization.publish(MarkerArray(seen_markers(seen, header) + self._drawn))

    def _view(self) -> BallView:
        params = self._params
        return BallView(self._locator.colour, self._radius, params.locator.nearest + 0.2, params.sure_range)

    def _tell_ball(self, looks: Iterable[Followed]) -> None:
        for stamp, frame, ball in looks:
            header = Header(stamp=rospy.Time(nsecs=stamp), frame_id=frame)
            self._drawn = ball_markers(ball, self._radius, header) if ball else []
            if ball:
                self._balls.publish(ball_message(ball, self._radius, header))
        self._report.counts["looks without odometry"] = self._ball.without_odometry


def main() -> None:
    """Runs the node; a parameter that cannot be taken ends it with status 1 and the reason."""
    rospy.init_node("object_locator")
    node = ObjectLocatorNode(read_params(ObjectLocatorNodeParams))
    with until_shutdown():
        node.run()
