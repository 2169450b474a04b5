# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of recordings: colour images of a bag, with depth where there is some, or of a video."""

import zlib
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Sequence, Tuple

import cv2
import numpy as np

from sextant.bags.bag_cameras import one_info
from sextant.bags.bag_file import BagFile
from sextant.bags.camera_topics import COMPRESSED, IMAGE, choose_image_topic
from sextant.bags.drive_depth import PhotoView, read_drive_depth
from sextant.bags.drive_photos import photo_prefix
from sextant.bags.stamps import Losses
from sextant.bags.transforms import read_transforms
from sextant.messages.camera_messages import camera_from_info
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name
from sextant.messages.image_messages import colour_compressed, colour_image

VIDEOS = (".mp4", ".avi", ".mkv", ".mov", ".m4v", ".webm", ".mpg", ".mpeg")
_DECODERS: Dict[str, Callable[[Any], np.ndarray]] = {IMAGE: colour_image, COMPRESSED: colour_compressed}


class RecordedPicture(NamedTuple):
    """A picture of a recording."""

    name: str  # unique among recordings with different names, without suffix
    image: np.ndarray  # uint8 (height, width, 3), BGR
    stamp: int = 0  # nanoseconds; 0: of a video


def recorded_pictures(
    path: str, notes: List[str], topic: str = "", every: int = 1
) -> Iterator[RecordedPicture]:
    """Pictures of a bag or a video, in order.

    :param notes: gets notes on images that cannot be read, at the end
    :param topic: of the images of a bag; empty: that of the only camera
    :param every: every n-th one only
    :raises BagError, ValueError: the file cannot be read
    """
    if Path(path).suffix.lower() in VIDEOS:
        return _of_video(path, every)
    return _of_bag(path, notes, topic, every)


def _of_video(path: str, every: int) -> Iterator[RecordedPicture]:
    if not Path(path).is_file():
        raise ValueError(f"{path}: there is no such file")
    video, number = cv2.VideoCapture(path), 0
    # Cameras number their files: there may be another one of this name in another folder.
    prefix = f"{Path(path).stem}_{zlib.crc32(str(Path(path).resolve().parent).encode()):08x}"
    try:
        while video.grab():
            done, image = video.retrieve() if number % every == 0 else (False, None)
            if done:
                yield RecordedPicture(f"{prefix}_{number:06d}", image)
            number += 1
    finally:
        video.release()
    if not number:
        raise ValueError(f"{path}: no picture can be read; is it a video that OpenCV knows?")


def _of_bag(path: str, notes: List[str], topic: str, every: int) -> Iterator[RecordedPicture]:
    with BagFile(path) as bag:
        camera, _ = choose_image_topic(bag, topic)
        prefix, losses = photo_prefix(bag, camera), Losses()
        for number, recorded in enumerate(bag.messages([camera.topic])):
            if number % every:
                continue
            try:
                message = recorded.message()
                image = _DECODERS[camera.type](message)
            except DamagedMessage as error:
                losses.lost(camera.topic, str(error))
                continue
            losses.used(camera.topic)
            stamp = message.header.stamp.to_nsec()
            colour = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) if image.ndim == 2 else image
            yield RecordedPicture(f"{prefix}_{(stamp or recorded.received) / 1e9:.3f}", colour, stamp)
        losses.check(bag, camera.topic)
        notes += losses.notes()


def depth_of_pictures(
    path: str, topic: str, depth: str, stamps: Sequence[int]
) -> Tuple[Dict[int, bytes], List[str]]:
    """Depth in the view of pictures of a bag, by their stamps, of encoded_depth(), and notes.

    :param depth: topic of depth images
    :raises BagError: a topic, a calibration or a transform cannot be used
    """
    if not stamps:
        return {}, []
    with BagFile(path) as bag:
        camera, _ = choose_image_topic(bag, topic)
        info = one_info(bag, camera.info_topic)
        try:
            model = camera_from_info(info, camera.rectified).model()
        except ValueError as error:
            raise bag.error(f"{camera.info_topic}: {error}", "leave out --depth") from None
        frame = frame_name(bag.first(camera.topic, whole=True).header.frame_id)
        return read_drive_depth(bag, depth, stamps, PhotoView(model, frame, read_transforms(bag)))
