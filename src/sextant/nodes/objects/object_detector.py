# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tells where in a camera's pictures objects are, and of which class."""

import cv2
import numpy as np
import rospy
from diagnostic_updater import Updater
from sensor_msgs.msg import Image

from sextant.bags.bag_file import DamagedMessage
from sextant.bags.pictures import colour_image
from sextant.msg import Objects
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal, until_shutdown
from sextant.nodes.base.params import read_params
from sextant.nodes.images.newest_picture import NewestPicture
from sextant.nodes.objects.object_detector_params import ObjectDetectorParams
from sextant.nodes.objects.object_detector_report import ObjectDetectorReport
from sextant.nodes.objects.object_messages import objects_message
from sextant.objects.box_picture import box_picture
from sextant.objects.detection import Detector


class ObjectDetectorNode:
    """Works in the main thread; of pictures that come faster than it works, the newest wins."""

    def __init__(self, detector: Detector):
        self._detector, self._report = detector, ObjectDetectorReport()
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("objects", self._report.tell)
        self._objects = rospy.Publisher("objects", Objects, queue_size=10)
        self._pictures = rospy.Publisher("objects/image", Image, queue_size=1)
        rospy.loginfo("finds %s", ", ".join(detector.classes))

    def run(self) -> None:
        """Until the node ends."""
        NewestPicture("image", Image, self._is_wanted, self._work).run(self._updater)

    def _is_wanted(self) -> bool:
        self._report.is_heard = any(each.get_num_connections() for each in (self._objects, self._pictures))
        return self._report.is_heard

    def _work(self, message: Image) -> None:
        try:
            image = _colours(message)
            found = self._detector.detect(image)
        except ValueError as error:  # also a network that cannot make anything of it
            self._report.refused(f"{rospy.resolve_name('image')}: {error}")
            return
        self._report.used(len(found.scores), self._detector.seconds)
        size = image.shape[1], image.shape[0]
        self._objects.publish(objects_message(found, self._detector.classes, size, message.header))
        if self._pictures.get_num_connections():
            drawn = box_picture(image, found, self._detector.classes)
            self._pictures.publish(image_to_message(drawn, message.header))


def _colours(message: Image) -> np.ndarray:
    """uint8 (height, width, 3), red first. :raises DamagedMessage: the message holds no such picture"""
    image = colour_image(message)
    if image.ndim == 2:
        raise DamagedMessage(f"the encoding '{message.encoding}' has no colours, publish rgb8 or bgr8")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)


def main() -> None:
    """Runs the node; a model that cannot be used ends it with status 1 and the reason."""
    rospy.init_node("object_detector")
    params = read_params(ObjectDetectorParams)
    if params.threads:
        cv2.setNumThreads(params.threads)
    with fatal(OSError, ValueError):
        node = ObjectDetectorNode(params.opened())
    with until_shutdown():
        node.run()
