# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Node publish_image: publishes photos as a camera would, rotated upright by their EXIF data.

camera_driver does not rotate photos, since it publishes the calibration of the unrotated sensor.
"""

import re
import threading
import time
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Iterator, List, Union

import numpy as np
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Header

from sextant.base.strict_params import not_empty, param, required, within
from sextant.images.photo_file import find_photos, read_rgb
from sextant.messages.image_messages import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.init_node import init_node
from sextant.nodes.base.params import read_params
from sextant.nodes.base.subscriber_wait import wait_for_subscriber

LINGER = 1.0  # minimum time from the last photo to the end, seconds, so that it is transmitted


@dataclass(frozen=True)
class PublisherParams:
    """Parameters of the node."""

    source: str = required("a photo, or a folder of photos", not_empty)
    rate: float = param(1.0, "publishing rate", within(0.001, 1000.0), "Hz")
    loop: bool = param(False, "repeat the photos")
    keep_alive: bool = param(True, "keep running after the last photo, for later subscribers")
    wait_for_subscriber: float = param(
        10.0, "maximum time to wait for a subscriber before the first photo", within(0.0, 3600.0), "s"
    )
    frame_id: str = param("camera_optical_frame", "frame of the images", not_empty)


class PhotoPublisher:
    """Publishes photos on a latched topic, so that later subscribers get the last one."""

    def __init__(self, params: PublisherParams):
        """:raises ValueError: there is no photo"""
        self._params = params
        self._photos = photos_of(Path(params.source).absolute())
        self._stop = threading.Event()
        rospy.on_shutdown(self._stop.set)
        self._publisher = rospy.Publisher("image", Image, queue_size=10, latch=True)

    def run(self) -> None:
        """Publishes the photos until the end or shutdown.

        :raises ValueError: none of the photos can be read
        """
        period, due = 1.0 / self._params.rate, 0.0
        wait_for_subscriber(self._publisher, self._params.wait_for_subscriber, self._stop)
        for image in self._images():
            if self._stop.wait(max(0.0, due - time.monotonic())):
                return
            header = Header(stamp=rospy.Time.now(), frame_id=self._params.frame_id)
            due = time.monotonic() + period
            self._publisher.publish(image_to_message(image, header))
        self._stop.wait(None if self._params.keep_alive else max(period, LINGER))

    def _images(self) -> Iterator[np.ndarray]:
        """Yields the photos; those that cannot be read are logged and left out."""
        photos = self._photos
        while photos and not self._stop.is_set():
            readable = []
            for photo in photos:
                try:
                    image = _read(photo)
                except (OSError, ValueError) as error:
                    rospy.logerr("left out: %s", error)
                    continue
                readable.append(photo)
                yield image
            if not readable:
                raise ValueError(f"{self._params.source}: no photo can be read")
            photos = readable if self._params.loop else []


_read = lru_cache(maxsize=1)(read_rgb)  # one photo in a loop is decoded once


def photos_of(source: Path) -> List[Path]:
    """Finds the photos of a folder and its subfolders in natural order (2.jpg before 10.jpg), or one photo.

    :raises ValueError: there is no photo
    """
    if not source.exists():
        raise ValueError(f"{source}: does not exist; source must be a photo or a folder of photos")
    photos = sorted(find_photos(source), key=_natural) if source.is_dir() else [source]
    if not photos:
        raise ValueError(f"{source}: there is no photo (jpg, png, …) in this folder")
    return photos


def _natural(path: Path) -> List[Union[int, str]]:
    """Splits a path into text and numbers for natural sorting."""
    return [int(part) if i % 2 else part for i, part in enumerate(re.split(r"(\d+)", str(path)))]


def main() -> None:
    """Runs the node; it exits with status 1 and the reason if no photo can be read."""
    init_node("publish_image")
    params = read_params(PublisherParams)
    with fatal(ValueError):
        PhotoPublisher(params).run()
