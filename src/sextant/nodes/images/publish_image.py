# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Publishes a photo, or those of a folder, as a camera would; upright, as their EXIF says.

camera_driver does not turn photos: it tells the calibration, which is of the sensor as it is.
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
from sextant.nodes.base.conversions import image_to_message
from sextant.nodes.base.exits import fatal
from sextant.nodes.base.listeners import wait_for_listener
from sextant.nodes.base.params import read_params
from sextant.place_maps.exif_map import find_photos
from sextant.place_maps.photo_file import read_rgb

LINGER = 1.0  # seconds at least from the last photo to the end, so that it goes out


@dataclass(frozen=True)
class PublisherParams:
    """What is published, and how."""

    source: str = required(not_empty)  # a photo, or a folder of them
    rate: float = param(1.0, within(0.001, 1000.0))  # photos a second
    loop: bool = param(False)  # after the last one the first again
    stay: bool = param(True)  # after the last one, for whoever listens later; false: the node ends
    wait_for_listener: float = param(10.0, within(0.0, 3600.0))  # seconds that the first one waits
    frame_id: str = param("camera_optical_frame", not_empty)


class PhotoPublisher:
    """Its topic is latched: whoever joins late gets the photo that was published last.

    :raises ValueError: there is no photo
    """

    def __init__(self, params: PublisherParams):
        self._params = params
        self._photos = photos_of(Path(params.source).absolute())
        self._stop = threading.Event()
        rospy.on_shutdown(self._stop.set)
        self._publisher = rospy.Publisher("image", Image, queue_size=10, latch=True)

    def run(self) -> None:
        """Until the last photo was shown for as long as the others, or the node is ended.

        :raises ValueError: not one of the photos can be read
        """
        period, due = 1.0 / self._params.rate, 0.0
        wait_for_listener(self._publisher, self._params.wait_for_listener, self._stop)
        for picture in self._pictures():
            if self._stop.wait(max(0.0, due - time.monotonic())):
                return
            header = Header(stamp=rospy.Time.now(), frame_id=self._params.frame_id)
            due = time.monotonic() + period
            self._publisher.publish(image_to_message(picture, header))
        self._stop.wait(None if self._params.stay else max(period, LINGER))

    def _pictures(self) -> Iterator[np.ndarray]:
        """One after another; those that cannot be read are named and left out."""
        photos = self._photos
        while photos and not self._stop.is_set():
            readable = []
            for photo in photos:
                try:
                    picture = _read(photo)
                except (OSError, ValueError) as error:
                    rospy.logerr("left out: %s", error)
                    continue
                readable.append(photo)
                yield picture
            if not readable:
                raise ValueError(f"{self._params.source}: no photo can be read")
            photos = readable if self._params.loop else []


_read = lru_cache(maxsize=1)(read_rgb)  # one photo in a loop is decoded once


def photos_of(source: Path) -> List[Path]:
    """The photos in a folder and those below it, 2.jpg before 10.jpg; or one photo.

    :raises ValueError: there is none
    """
    if not source.exists():
        raise ValueError(f"{source}: is not there; source must be a photo or a folder of photos")
    photos = sorted(find_photos(source), key=_natural) if source.is_dir() else [source]
    if not photos:
        raise ValueError(f"{source}: there is no photo (jpg, png, …) in this folder")
    return photos


def _natural(path: Path) -> List[Union[int, str]]:
    """Every second one is a number."""
    return [int(part) if i % 2 else part for i, part in enumerate(re.split(r"(\d+)", str(path)))]


def main() -> None:
    """Runs the node; no photo that can be read ends it with status 1 and the reason."""
    rospy.init_node("publish_image")
    params = read_params(PublisherParams)
    with fatal(ValueError):
        PhotoPublisher(params).run()
