# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Groups the observations of recorded drives into instants, the input of the map maker."""

from collections import deque
from typing import Deque, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.geometry.poses import MAX_GAP, interpolated_poses
from sextant.localization.drive_observations import DriveObservations, ImageDetections

_MOUNT = "#"  # separator of camera and mount; not allowed in a topic
MAX_STAMP_DIFFERENCE = 10_000_000  # nanoseconds between images of one instant

Views = List[Tuple[int, ImageDetections]]  # camera_index and detections


class RecordedInstants(NamedTuple):
    """A recording for sextant.make_marker_map()."""

    instants: List["sextant.RecordedInstant"]  # drive by drive, by ascending stamp
    cameras: List[str]  # name by camera_index
    stamps: np.ndarray  # (N,) int64 nanoseconds, of the instants


def mounted_camera_name(camera: str, mount: int) -> str:
    """Returns the key in DriveObservations.cameras of a camera whose mount changed; plain for mount 0."""
    return f"{camera}{_MOUNT}{mount + 1}" if mount else camera


def camera_name(name: str) -> str:
    """Returns the camera's own name, without the mount: its noise does not depend on the mount."""
    return name.partition(_MOUNT)[0]


def recorded_instants(drives: Sequence[DriveObservations]) -> RecordedInstants:
    """Groups images of one time on one drive into instants, with the odometry of that time.

    Grouping as in the locator (stamp_groups.hpp): an instant begins with the oldest image and contains at
    most one image of each other camera, up to MAX_STAMP_DIFFERENCE later. Its stamp is that of the last
    image; odometry compensates the motion since the earlier ones. Instants without markers are kept if there
    is odometry, since they connect the path.

    :raises ValueError: an image is of a camera that is not in DriveObservations.cameras
    """
    names = sorted({camera_name(name) for drive in drives for name in drive.cameras})
    found = [each for number, drive in enumerate(drives) for each in _drive_instants(drive, number, names)]
    stamps = np.array([stamp for stamp, _ in found], dtype=np.int64)
    return RecordedInstants([instant for _, instant in found], names, stamps)


def count_instants(drive: DriveObservations) -> int:
    """Returns the number of instants of a drive, with and without markers and odometry.

    :raises ValueError: as recorded_instants()
    """
    return sum(1 for _ in _groups(drive, sorted({camera_name(name) for name in drive.cameras})))


def _drive_instants(
    drive: DriveObservations, number: int, names: List[str]
) -> Iterator[Tuple[int, "sextant.RecordedInstant"]]:
    models = {name: camera.model() for name, camera in drive.cameras.items()}
    groups = list(_groups(drive, names))
    at = np.unique(np.array([image.stamp for group in groups for _, image in group], dtype=np.int64))
    poses = interpolated_poses(drive.odometry_stamps, drive.odometry, at, MAX_GAP)
    odometry = dict(zip(at.tolist(), poses))  # T_odom_base by stamp; None: unknown
    for group in groups:
        stamp = max(image.stamp for _, image in group)
        T_odom_base = odometry[stamp]
        views = [
            _view(drive, models, index, image, T_odom_base, odometry[image.stamp])
            for index, image in group
            if image.markers
        ]
        if views or T_odom_base is not None:
            yield stamp, sextant.RecordedInstant(views, T_odom_base, number)


def _groups(drive: DriveObservations, names: List[str]) -> Iterator[Views]:
    waiting: Dict[int, Deque[ImageDetections]] = {index: deque() for index in range(len(names))}
    for image in sorted(drive.images, key=lambda image: image.stamp):
        if image.camera not in drive.cameras:
            raise ValueError(f"{drive.name}: an image is of '{image.camera}', which is none of its cameras")
        waiting[names.index(camera_name(image.camera))].append(image)
    while any(waiting.values()):
        last = MAX_STAMP_DIFFERENCE + min(images[0].stamp for images in waiting.values() if images)
        yield [
            (index, images.popleft())
            for index, images in waiting.items()
            if images and images[0].stamp <= last
        ]


def _view(
    drive: DriveObservations,
    models: Dict[str, "sextant.CameraModel"],
    index: int,
    image: ImageDetections,
    T_odom_base: Optional[np.ndarray],
    T_odom_then: Optional[np.ndarray],
) -> "sextant.MarkerView":
    T_base_camera = drive.cameras[image.camera].T_base_camera
    if T_odom_base is not None and T_odom_then is not None and T_odom_then is not T_odom_base:
        T_base_camera = np.linalg.inv(T_odom_base) @ T_odom_then @ T_base_camera
    view = sextant.MarkerView(models[image.camera], T_base_camera, image.markers)
    view.camera_index = index
    return view
