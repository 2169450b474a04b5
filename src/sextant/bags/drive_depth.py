# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Depth images of a recorded drive, in the view of its photos."""

from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

import numpy as np

import sextant
from sextant.bags.bag_cameras import one_info
from sextant.bags.bag_file import BagFile
from sextant.bags.camera_topics import IMAGE
from sextant.bags.mounts import mount_of
from sextant.bags.stamps import Losses
from sextant.bags.transforms import TransformTree
from sextant.geometry.registered_depth import DepthRegistration
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
) -> Tuple[Dict[int, np.ndarray], List[str]]:
    """Depth of photos by stamp, as DepthRegistration.registered(), and notes.

    :param topic: depth images
    :param stamps: of the photos, nanoseconds; those without a depth image within MAX_LAG are left out
    :param scale: factor that corrects the depths
    :raises BagError: the topic, its calibration or the transform to the photos' camera cannot be used
    """
    topic = bag.named(topic, "image", IMAGE)
    model = _model(bag, topic)
    nearest, notes = _nearest(bag, topic, np.sort(np.array(stamps, np.int64)))
    if len(nearest) < len(stamps):
        notes.append(f"{len(stamps) - len(nearest)} of {len(stamps)} photos have no depth image")
    registrations: Dict[bytes, DepthRegistration] = {}  # by transform: a camera on a joint has several
    found = {}
    for stamp, message in nearest.items():
        T = _transform(bag, camera, frame_name(message.header.frame_id), stamp)
        key = np.round(T, 6).tobytes()
        if key not in registrations:
            registrations[key] = DepthRegistration(camera.model, model, T)
        try:
            found[stamp] = registrations[key].registered(scale * depth_image(message))
        except ValueError as error:
            raise bag.error(f"{topic}: {error}", RECORD) from None
    return found, notes


def _model(bag: BagFile, topic: str) -> "sextant.CameraModel":
    info_topic = topic.rpartition("/")[0] + "/camera_info"
    if not bag.find(info_topic):
        raise bag.error(f"{topic} has no camera_info beside it ({info_topic})", RECORD)
    try:
        return camera_from_info(one_info(bag, info_topic), rectified=False).model()
    except ValueError as error:
        raise bag.error(f"{info_topic}: {error}", RECORD) from None


def _nearest(bag: BagFile, topic: str, stamps: np.ndarray) -> Tuple[Dict[int, Any], List[str]]:
    """The depth message nearest to each stamp, and notes on messages that cannot be used."""
    found: Dict[int, Tuple[int, Any]] = {}
    losses = Losses()
    for recorded in bag.messages([topic]):
        try:
            message = recorded.message()
            depth_image(message)
        except DamagedMessage as error:
            losses.lost(topic, str(error))
            continue
        losses.used(topic)
        lags = np.abs(stamps - message.header.stamp.to_nsec())
        lag, stamp = int(lags.min()), int(stamps[lags.argmin()])
        if lag <= MAX_LAG and (stamp not in found or lag < found[stamp][0]):
            found[stamp] = lag, message
    losses.check(bag, topic)
    return {stamp: message for stamp, (_, message) in sorted(found.items())}, losses.notes()


def _transform(bag: BagFile, camera: PhotoView, frame: str, stamp: int) -> np.ndarray:
    """T_colour_depth (4, 4) at a stamp."""
    mount = mount_of(bag, frame, camera.frame, {}, camera.tree)
    T = mount(stamp) if mount else None
    if T is None:
        what = f"tf does not connect '{camera.frame}' with '{frame}' (depth)"
        raise bag.error(f"{what} at the stamp of a photo", RECORD)
    return T
