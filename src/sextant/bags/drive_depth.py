# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images of a recorded drive, in the view of its photos."""

from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_cameras import one_info
from sextant.bags.bag_file import BagFile
from sextant.bags.camera_topics import IMAGE
from sextant.bags.mounts import mount_of
from sextant.bags.stamps import Losses
from sextant.bags.transforms import TransformTree
from sextant.geometry.registered_depth import DepthRegistration
from sextant.images.photo_depth import encoded_depth
from sextant.messages.camera_messages import camera_from_info
from sextant.messages.damaged_message import DamagedMessage
from sextant.messages.frame_name import frame_name
from sextant.messages.image_messages import depth_image

MAX_LAG = 25_000_000  # nanoseconds between a photo and its depth image
RECORD = "record the depth camera's camera_info and tf, too, or leave out --depth"


class PhotoView(NamedTuple):
    """The camera of the photos."""

    model: "sextant.CameraModel"  # its projection
    frame: str  # of its images
    tree: TransformTree  # tf of the bag


def read_drive_depth(
    bag: BagFile, topic: str, stamps: Sequence[int], camera: PhotoView, scale: float = 1.0
) -> Tuple[Dict[int, bytes], List[str]]:
    """Depth of photos by stamp, of encoded_depth(), and notes.

    :param topic: depth images
    :param stamps: of the photos, nanoseconds; those without a depth image within MAX_LAG are left out
    :param scale: factor that corrects the depths
    :raises BagError: the topic, its calibration or the transform to the photos' camera cannot be used
    """
    topic = bag.named(topic, "image", IMAGE)
    registrar = _Registrar(bag, topic, camera, scale)
    wanted = np.sort(np.array(stamps, np.int64))
    found: Dict[int, Tuple[int, bytes]] = {}  # lag and depth by stamp
    losses = Losses()
    for recorded in bag.messages([topic]):
        try:
            message = recorded.message()
            depth = depth_image(message)
        except DamagedMessage as error:
            losses.lost(topic, str(error))
            continue
        losses.used(topic)
        lags = np.abs(wanted - message.header.stamp.to_nsec())
        lag, stamp = int(lags.min()), int(wanted[lags.argmin()])
        if lag <= MAX_LAG and (stamp not in found or lag < found[stamp][0]):
            found[stamp] = lag, registrar.encoded(depth, frame_name(message.header.frame_id), stamp)
    losses.check(bag, topic)
    notes = losses.notes()
    if len(found) < len(wanted):
        notes.append(f"{len(wanted) - len(found)} of {len(wanted)} photos have no depth image")
    return {stamp: depth for stamp, (_, depth) in sorted(found.items())}, notes


class _Registrar:
    """Takes depth images to the view of the photos."""

    def __init__(self, bag: BagFile, topic: str, camera: PhotoView, scale: float):
        self._bag, self._topic, self._camera, self._scale = bag, topic, camera, scale
        self._model = _model(bag, topic)
        self._T = np.zeros((4, 4))  # of the registration
        self._registration: Optional[DepthRegistration] = None

    def encoded(self, depth: np.ndarray, frame: str, stamp: int) -> bytes:
        T = _transform(self._bag, self._camera, frame, stamp)
        if self._registration is None or not np.allclose(T, self._T, atol=1e-6):
            self._registration, self._T = DepthRegistration(self._camera.model, self._model, T), T
        try:
            return encoded_depth(self._registration.registered(self._scale * depth))
        except ValueError as error:
            raise self._bag.error(f"{self._topic}: {error}", RECORD) from None


def _model(bag: BagFile, topic: str) -> "sextant.CameraModel":
    info_topic = topic.rpartition("/")[0] + "/camera_info"
    if not bag.find(info_topic):
        raise bag.error(f"{topic} has no camera_info beside it ({info_topic})", RECORD)
    try:
        return camera_from_info(one_info(bag, info_topic), rectified=False).model()
    except ValueError as error:
        raise bag.error(f"{info_topic}: {error}", RECORD) from None


def _transform(bag: BagFile, camera: PhotoView, frame: str, stamp: int) -> np.ndarray:
    """T_colour_depth (4, 4) at a stamp."""
    mount = mount_of(bag, frame, camera.frame, {}, camera.tree)
    T = mount(stamp) if mount else None
    if T is None:
        what = f"tf does not connect '{camera.frame}' with '{frame}' (depth)"
        raise bag.error(f"{what} at the stamp of a photo", RECORD)
    return T
