# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node object_detector: detects objects in images and publishes their classes and boxes."""

import cv2
import numpy as np
import rospy
from diagnostic_updater import Updater
from sensor_msgs.msg import Image

from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.image_messages import colour_image
from sextant.msg import Objects
from sextant.nodes.base.exits import fatal, until_shutdown
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.images.image_publisher import ImagePublisher
from sextant.nodes.images.latest_image import LatestImage
from sextant.nodes.objects.object_detector_node_params import ObjectDetectorParams
from sextant.nodes.objects.object_detector_report import ObjectDetectorReport
from sextant.nodes.objects.object_messages import objects_message
from sextant.nodes.objects.vision_publisher import VisionPublisher
from sextant.objects.detection_image import detection_image
from sextant.objects.detections import Detector


class ObjectDetectorNode:
    """Processes the newest image in the main thread; older ones are dropped."""

    def __init__(self, detector: Detector):
        self._detector, self._report = detector, ObjectDetectorReport()
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("objects", self._report.fill_diagnostics)
        self._objects = rospy.Publisher("objects", Objects, queue_size=10)
        self._detections = VisionPublisher("objects/detections", detector.classes)
        self._drawn_images = ImagePublisher("objects/image")
        rospy.loginfo("detects %s", ", ".join(detector.classes))
        for note in detector.notes:
            rospy.loginfo("%s", note)

    def run(self) -> None:
        """Process images until the node is shut down."""
        LatestImage("image", Image, self._has_subscribers, self._process).run(self._updater)

    def _has_subscribers(self) -> bool:
        self._report.has_subscribers = any(
            each.get_num_connections() for each in (self._objects, self._detections, self._drawn_images)
        )
        return self._report.has_subscribers

    def _process(self, message: Image) -> None:
        try:
            image = _rgb_image(message)
            found = self._detector.detect(image)
        except ValueError as error:  # also raised by the network's runtime
            self._report.rejected(f"{rospy.resolve_name('image')}: {error}")
            return
        self._report.processed(len(found.scores), self._detector.seconds)
        size = image.shape[1], image.shape[0]
        self._objects.publish(objects_message(found, self._detector.classes, size, message.header))
        self._detections.publish(found, message.header)
        if self._drawn_images.get_num_connections():
            drawn = detection_image(image, found, self._detector.classes)
            self._drawn_images.publish(drawn, message.header)


def _rgb_image(message: Image) -> np.ndarray:
    """uint8 (height, width, 3), RGB. :raises DamagedMessage: damaged, or without colours"""
    image = colour_image(message)
    if image.ndim == 2:
        raise DamagedMessage(f"the encoding '{message.encoding}' has no colours, publish rgb8 or bgr8")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter or the model is invalid."""
    init_node("object_detector")
    params = read_params(ObjectDetectorParams)
    if params.threads:
        cv2.setNumThreads(params.threads)
    with fatal(OSError, ValueError):
        node = ObjectDetectorNode(params.create_detector())
    with until_shutdown():
        node.run()
