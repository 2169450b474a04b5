# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads recorded drives: the markers of all cameras, their mounts, and odometry."""

from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

import sextant
from sextant.bags.bag_cameras import CAMERAS, BagCamera
from sextant.bags.bag_file import BagFile, Recorded
from sextant.bags.bag_params import BagParams
from sextant.bags.camera_topics import choose_topics
from sextant.bags.mounts import Mount, find_mounts
from sextant.bags.odometry import read_odometry
from sextant.bags.stamps import Losses, StampOrder
from sextant.bags.transforms import read_transforms
from sextant.localization.drive_observations import DriveCamera, DriveObservations, ImageDetections
from sextant.localization.recorded_instants import mounted_camera_name
from sextant.messages.damaged_message import DamagedMessage

Progress = Callable[[float], None]  # called with the fraction of the bag that is read, 0 to 1

SAME_PLACE = 1e-4  # metres and radians, within which a camera has not moved on the robot


@dataclass(frozen=True)
class RecordedDrive(DriveObservations):
    """A drive with warnings on how it was read."""

    warnings: Tuple[str, ...] = ()  # one per problem


def read_drive(
    path: str, params: Optional[BagParams] = None, progress: Optional[Progress] = None
) -> RecordedDrive:
    """Reads a bag without a master, with the same results as the nodes, bit for bit.

    A camera is named by its topic of images (without `/compressed`) or of markers. One on a joint that moves
    is a DriveCamera for each place on the robot that it took images from, named by mounted_camera_name().
    Messages that cannot be used are left out, and counted in the warnings; a topic none of which can be used
    is refused, and so is a clock that jumps back.

    :raises BagError: the bag, a calibration, the tf or a named topic cannot be used, no message of a topic is
        usable, or its clock jumps back; and what to do
    """
    params = params or BagParams()
    with BagFile(path, params.start, params.end) as bag:
        topics, notes = choose_topics(bag, params)
        detector = sextant.MarkerDetector(_detector_params(params))
        cameras = {each.topic: CAMERAS[each.type](bag, each, detector) for each in topics}
        tree = read_transforms(bag)
        frames = {camera.topic.camera: camera.frame for camera in cameras.values()}
        mounts = find_mounts(bag, frames, params, tree)
        odometry = read_odometry(bag, params, tree, mounts.camera_is_base)
        images = _Images(bag, cameras, mounts.by_camera, params.every)
        images.read(progress or (lambda share: None))
    warnings = [*notes, *tree.notes, *mounts.notes, *odometry.notes, *images.notes()]
    seen = sorted(images.seen, key=lambda image: (image.stamp, image.camera))
    return RecordedDrive(
        str(path), images.cameras(), seen, odometry.stamps, odometry.poses, tuple(dict.fromkeys(warnings))
    )


def _detector_params(params: BagParams) -> "sextant.DetectorParams":
    detector = sextant.DetectorParams()
    detector.families, detector.search = list(params.families), "full"
    return detector


class _Places:
    """The poses of a camera on the robot."""

    def __init__(self, camera: str, mount: Mount):
        self._camera, self._mount = camera, mount
        self.by_name: Dict[str, np.ndarray] = {}

    def at(self, stamp: int) -> str:
        T = self._mount(stamp)
        if T is None:
            raise DamagedMessage("tf was not recorded at its stamp")
        new = mounted_camera_name(self._camera, len(self.by_name))
        name = next((name for name, other in self.by_name.items() if _same(T, other)), new)
        self.by_name.setdefault(name, T)
        return name


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    turned = np.linalg.norm(sextant.log_so3(a[:3, :3].T @ b[:3, :3]))
    return bool(np.linalg.norm(a[:3, 3] - b[:3, 3]) < SAME_PLACE and turned < SAME_PLACE)


class _Images:
    """Reads the messages of all cameras."""

    def __init__(self, bag: BagFile, cameras: Dict[str, BagCamera], mounts: Dict[str, Mount], every: int):
        self._bag, self._cameras, self._every = bag, cameras, every
        self._places = {
            topic: _Places(camera.topic.camera, mounts[camera.topic.camera])
            for topic, camera in cameras.items()
        }
        self._order, self._losses = StampOrder(bag), Losses()
        self.seen: List[ImageDetections] = []

    def read(self, progress: Progress) -> None:
        """:raises BagError: as read_drive()"""
        counts = dict.fromkeys(self._cameras, 0)
        for recorded in self._bag.messages(list(self._cameras)):
            if counts[recorded.topic] % self._every == 0:
                self._read(recorded)
            counts[recorded.topic] += 1
            progress(self._bag.fraction_read(recorded.received))
        for topic in self._cameras:
            self._losses.check(self._bag, topic)
        progress(1.0)

    def _read(self, recorded: Recorded) -> None:
        try:
            self.seen.append(self._image(recorded, recorded.message()))
            self._losses.used(recorded.topic)
        except DamagedMessage as error:
            self._losses.lost(recorded.topic, str(error))

    def _image(self, recorded: Recorded, message: Any) -> ImageDetections:
        camera, stamp = self._cameras[recorded.topic], message.header.stamp.to_nsec()
        self._order.check(recorded, stamp)
        camera.check_frame(message)
        place = self._places[recorded.topic].at(stamp)
        return ImageDetections(stamp, place, camera.markers(message))

    def cameras(self) -> Dict[str, DriveCamera]:
        """Cameras by the names used in the images."""
        return {
            name: replace(self._cameras[topic].camera, T_base_camera=T)
            for topic, places in self._places.items()
            for name, T in places.by_name.items()
        }

    def notes(self) -> List[str]:
        """Notes on the messages that were read."""
        moved = [
            f"{topic}: its camera moves on the robot, it took images from {len(places.by_name)} places"
            for topic, places in self._places.items()
            if len(places.by_name) > 1
        ]
        return self._losses.notes() + moved
