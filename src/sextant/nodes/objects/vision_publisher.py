# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detections as messages of vision_msgs, if that package is installed."""

from typing import Optional, Sequence

import numpy as np
import rospy
from std_msgs.msg import Header

from sextant.objects.detections import Detections

try:
    from vision_msgs.msg import Detection2D, Detection2DArray, ObjectHypothesisWithPose, VisionInfo
except ImportError:
    Detection2DArray = None


class VisionPublisher:
    """Publishes vision_msgs/Detection2DArray, whose ids are indices of the classes' names in a parameter.

    The latched VisionInfo has the name of that parameter. Without vision_msgs it has no topics.
    """

    def __init__(self, topic: str, classes: Sequence[str]):
        """:param topic: of the detections; VisionInfo is TOPIC_info. :param classes: names by index"""
        self._detections: Optional[rospy.Publisher] = None
        if Detection2DArray is None:
            return
        names = f"{rospy.get_name()}_classes"  # not a private one: those are all parameters of the node
        rospy.set_param(names, list(classes))
        self._info = rospy.Publisher(f"{topic}_info", VisionInfo, queue_size=1, latch=True)
        self._info.publish(VisionInfo(Header(stamp=rospy.Time.now()), "object_detector", names, 0))
        self._detections = rospy.Publisher(topic, Detection2DArray, queue_size=10)

    def get_num_connections(self) -> int:
        """Number of subscribers of the detections."""
        return self._detections.get_num_connections() if self._detections else 0

    def publish(self, found: Detections, header: Header) -> None:
        """:param header: of the image"""
        if self.get_num_connections() > 0:
            self._detections.publish(detections_message(found, header))


def detections_message(found: Detections, header: Header) -> "Detection2DArray":
    """vision_msgs/Detection2DArray. (0, 0) is the outer corner of the first pixel, as in Objects."""
    return Detection2DArray(header, [_detection(*each, header) for each in zip(*found)])


def _detection(box: np.ndarray, score: float, number: int, header: Header) -> "Detection2D":
    hypothesis = ObjectHypothesisWithPose(id=int(number), score=float(score))
    hypothesis.pose.pose.orientation.w = 1.0
    message = Detection2D(header=header, results=[hypothesis])
    message.bbox.center.x, message.bbox.center.y = map(float, (box[:2] + box[2:]) / 2)
    message.bbox.size_x, message.bbox.size_y = map(float, box[2:] - box[:2])
    return message
