# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node picture_collector: collects pictures of a topic for labelling."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from diagnostic_updater import DiagnosticStatusWrapper, Updater
from sensor_msgs.msg import Image

from sextant.base.strict_params import nested, not_empty, param
from sextant.labels.picture_collection import CollectionParams, PictureCollection
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.image_messages import colour_image
from sextant.nodes.base.exits import fatal, until_shutdown
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.images.latest_image import LatestImage


@dataclass(frozen=True)
class PictureCollectorParams:
    """Parameters of the node."""

    folder: str = param("pictures", "folder of the pictures; those in it stay", not_empty)
    collection: CollectionParams = nested(CollectionParams)


class PictureCollector:
    """Offers the newest image to the collection; older ones are dropped."""

    def __init__(self, params: PictureCollectorParams):
        """:raises OSError, ValueError: the folder cannot be used"""
        self._collection = PictureCollection(Path(params.folder).expanduser(), params.collection)
        self._updater = Updater()
        self._updater.setHardwareID("none")
        self._updater.add("pictures", self._fill_diagnostics)

    def run(self) -> None:
        """Collects until the node is shut down, and logs what became of the pictures."""
        try:
            LatestImage("image", Image, lambda: True, self._process).run(self._updater)
        finally:
            self._collection.write_counts()
            for line in self._collection.summary():
                rospy.loginfo("%s", line)

    def _process(self, message: Image) -> None:
        try:
            image = colour_image(message)
        except DamagedMessage as error:
            rospy.logwarn_throttle(10.0, f"{rospy.resolve_name('image')} is not used: {error}")
            return
        colour = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image
        try:
            stamp = message.header.stamp if message.header.stamp else rospy.Time.now()
            self._collection.offer(f"{stamp.to_nsec() / 1e9:.3f}", colour)
        except OSError as error:
            rospy.logerr_throttle(10.0, f"a picture cannot be written: {error}")

    def _fill_diagnostics(self, row: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        row.summary(DiagnosticStatus.OK, f"{len(self._collection)} pictures")
        for reason, count in self._collection.counts.items():
            row.add(reason, str(count))
        return row


def main() -> None:
    """Runs the node; exits with status 1 and the reason if a parameter or the folder is invalid."""
    init_node("picture_collector")
    params = read_params(PictureCollectorParams)
    with fatal(OSError, ValueError):
        node = PictureCollector(params)
    with until_shutdown():
        node.run()
