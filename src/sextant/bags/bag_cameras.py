# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras of a bag: their calibrations, and the markers in their messages."""

from typing import Any, List

import numpy as np

import sextant
from sextant.bags.bag_file import BagFile
from sextant.bags.calibrations import camera_from_file
from sextant.bags.camera_topics import COMPRESSED, IMAGE, MARKERS, CameraTopic
from sextant.localization.drive_observations import DriveCamera
from sextant.messages.camera_messages import camera_from_info, same_calibration
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name
from sextant.messages.image_messages import grey_compressed, grey_image
from sextant.msg import MarkerArray

NAME_A_FILE = "name the camera's calibration file in place of its camera_info"
SPLIT = "name a calibration file for the camera, or read the parts one by one with start and end"


class BagCamera:
    """A camera of which images were recorded.

    :raises BagError: there is no message to read, or no usable calibration
    """

    _decoders = {IMAGE: grey_image, COMPRESSED: grey_compressed}

    def __init__(self, bag: BagFile, topic: CameraTopic, detector: "sextant.MarkerDetector"):
        self.topic, self._bag, self._detector = topic, bag, detector
        first = bag.first(topic.topic)
        if first is None:
            raise bag.error(
                f"there is no message on {topic.topic} in the part that is read", "see start and end"
            )
        self.frame = frame_name(first.header.frame_id)
        self.camera = self._calibrated(first)
        self._model = self.camera.model()

    def _calibrated(self, first: Any) -> DriveCamera:
        topic = self.topic
        if topic.calibration:
            return camera_from_file(topic.calibration, topic.rectified)
        info = one_info(self._bag, topic.info_topic)
        self.frame = self.frame or frame_name(info.header.frame_id)
        return self._from_info(info, topic.rectified, topic.info_topic)

    def _from_info(self, info: Any, rectified: bool, where: str) -> DriveCamera:
        try:
            return camera_from_info(info, rectified)
        except ValueError as error:
            raise self._bag.error(f"{where}: {error}", NAME_A_FILE) from None

    def check_frame(self, message: Any) -> None:
        """:raises DamagedMessage: its frame is not that of the first message"""
        frame = frame_name(message.header.frame_id)
        if frame and frame != self.frame:
            raise DamagedMessage(f"its frame is '{frame}', the first one's '{self.frame}'")

    def markers(self, message: Any) -> List["sextant.Detection"]:
        """Detects the markers in a message.

        :raises DamagedMessage: it contains no image, or one of another size than the calibration
        """
        image = self._decoders[self.topic.type](message)
        size, expected = image.shape[::-1], (self._model.width, self._model.height)
        if size != expected:
            raise DamagedMessage(
                f"the image has {size[0]} x {size[1]} pixels, its calibration is for "
                f"{expected[0]} x {expected[1]}"
            )
        return self._detector.detect(image, self._model)


class MarkersCamera(BagCamera):
    """A camera of which markers were recorded, with its calibration."""

    def _calibrated(self, first: Any) -> DriveCamera:
        if first._md5sum != MarkerArray._md5sum:
            what = f"the markers on {self.topic.topic} were recorded by another version of Sextant"
            raise self._bag.error(what, "read the images instead, or read it with that version")
        self._first = first
        if self.topic.calibration:
            return camera_from_file(self.topic.calibration, first.rectified)
        return self._from_info(first.camera_info, first.rectified, self.topic.topic)

    def markers(self, message: Any) -> List["sextant.Detection"]:
        """Returns the markers in a message.

        :raises DamagedMessage: a corner is not finite, or the family is unknown
        :raises BagError: the calibration changes, or markers of raw and of rectified images are mixed
        """
        same = same_calibration(message.camera_info, self._first.camera_info)
        if not self.topic.calibration and not same:
            raise self._bag.error(f"the calibration on {self.topic.topic} changes", SPLIT)
        if message.rectified != self._first.rectified:
            what = f"{self.topic.topic} has markers of raw and of rectified images"
            raise self._bag.error(what, "read the parts one by one with start and end")
        return [_recorded_marker(each) for each in message.markers]


def _recorded_marker(marker: Any) -> "sextant.Detection":
    corners = np.array(marker.corners, dtype=float).reshape(4, 2)
    sigmas = np.array(marker.corner_sigmas, dtype=float)
    if not np.all(np.isfinite(corners)):
        raise DamagedMessage(f"a corner of marker {marker.id} is not finite")
    try:
        family = sextant.canonical_family(marker.family)
    except ValueError:
        raise DamagedMessage(f"there is no family '{marker.family}'") from None
    # Zero means not set: no corner is exact.
    return sextant.Detection(family, marker.id, corners, np.where(sigmas > 0.0, sigmas, -1.0))


def one_info(bag: BagFile, topic: str) -> Any:
    """The sensor_msgs/CameraInfo of a topic, from the whole bag if the part to read has none.

    :raises BagError: there is no message, or the calibration changes
    """
    found = bag.find(topic) or ""
    if bag.types.get(found) != "sensor_msgs/CameraInfo":
        raise bag.error(f"{topic} is no camera_info but {bag.types.get(found)}", NAME_A_FILE)
    for whole in (False, True):
        first = None
        for recorded in bag.messages([found], whole):
            try:
                info = recorded.message()
            except DamagedMessage:
                continue
            if first is not None and not same_calibration(first, info):
                raise bag.error(f"{topic} changes after {bag.seconds(recorded.received):.2f} s", SPLIT)
            first = first or info
        if first is not None:
            return first
    raise bag.error(f"there is no message on {topic} that can be read", NAME_A_FILE)


CAMERAS = {IMAGE: BagCamera, COMPRESSED: BagCamera, MARKERS: MarkersCamera}
