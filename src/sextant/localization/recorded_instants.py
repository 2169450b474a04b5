# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What robots' cameras saw on their drives, as the map maker takes it: instant by instant."""

from collections import deque
from typing import Deque, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

import sextant
from sextant.geometry.poses import LONGEST_GAP, interpolated_poses
from sextant.localization.drive_sightings import DriveSightings, SeenImage

_PLACE = "#"  # not allowed in a topic
NEAR = 10_000_000  # nanoseconds between images of one instant

Views = List[Tuple[int, SeenImage]]  # index of the camera, and what it saw


class RecordedInstants(NamedTuple):
    """A recording for sextant.make_marker_map()."""

    instants: List["sextant.RecordedInstant"]  # drive after drive, in order of time
    cameras: List[str]  # name by camera_index
    stamps: np.ndarray  # (N,) int64 nanoseconds, of each instant


def place_name(camera: str, place: int) -> str:
    """How DriveSightings.cameras names a camera at one of its places on the robot; plain for the first, 0."""
    return f"{camera}{_PLACE}{place + 1}" if place else camera


def camera_name(name: str) -> str:
    """The camera's own name: however it is turned, it is one camera with one noise."""
    return name.partition(_PLACE)[0]


def recorded_instants(drives: Sequence[DriveSightings]) -> RecordedInstants:
    """Puts together what was seen at one time on one drive, with the odometry of that time.

    As the locator does (stamp_groups.hpp): an instant begins with the oldest image, holds one of each other
    camera that is no later than NEAR, and has the stamp of its last one; with odometry, a camera
    that saw a little earlier is put where it then was. Instants without markers are kept where there is
    odometry: they carry the path.

    :raises ValueError: an image is of a camera that the drive does not have
    """
    names = sorted({camera_name(name) for drive in drives for name in drive.cameras})
    instants: List[sextant.RecordedInstant] = []
    stamps: List[int] = []
    for number, drive in enumerate(drives):
        for stamp, instant in _drive_instants(drive, number, names):
            instants.append(instant)
            stamps.append(stamp)
    return RecordedInstants(instants, names, np.array(stamps, dtype=np.int64))


def _drive_instants(
    drive: DriveSightings, number: int, names: List[str]
) -> Iterator[Tuple[int, "sextant.RecordedInstant"]]:
    models = {name: camera.model() for name, camera in drive.cameras.items()}
    groups = list(_groups(drive, names))
    odometry = _odometry(drive, [image.stamp for group in groups for _, image in group])
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


def _groups(drive: DriveSightings, names: List[str]) -> Iterator[Views]:
    waiting: Dict[int, Deque[SeenImage]] = {index: deque() for index in range(len(names))}
    for image in sorted(drive.images, key=lambda image: image.stamp):
        if image.camera not in drive.cameras:
            raise ValueError(f"{drive.name}: an image is of '{image.camera}', which is none of its cameras")
        waiting[names.index(camera_name(image.camera))].append(image)
    while any(waiting.values()):
        last = NEAR + min(images[0].stamp for images in waiting.values() if images)
        yield [
            (index, images.popleft())
            for index, images in waiting.items()
            if images and images[0].stamp <= last
        ]


def _odometry(drive: DriveSightings, stamps: Sequence[int]) -> Dict[int, Optional[np.ndarray]]:
    """T_odom_base by stamp, None where it is not known."""
    at = np.unique(np.array(stamps, dtype=np.int64))
    poses = interpolated_poses(drive.odometry_stamps, drive.odometry, at, LONGEST_GAP)
    return dict(zip(at.tolist(), poses))


def _view(
    drive: DriveSightings,
    models: Dict[str, "sextant.CameraModel"],
    index: int,
    image: SeenImage,
    T_odom_base: Optional[np.ndarray],
    T_odom_then: Optional[np.ndarray],
) -> "sextant.MarkerView":
    T_base_camera = drive.cameras[image.camera].T_base_camera
    if T_odom_base is not None and T_odom_then is not None and T_odom_then is not T_odom_base:
        T_base_camera = np.linalg.inv(T_odom_base) @ T_odom_then @ T_base_camera
    view = sextant.MarkerView(models[image.camera], T_base_camera, image.markers)
    view.camera_index = index
    return view
