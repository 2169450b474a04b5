# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What robots' cameras saw on their drives, as the map maker takes it: instant by instant."""

from collections import deque
from typing import Deque, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy.spatial.transform import Rotation

import sextant
from sextant.markers.drive_sightings import DriveSightings, SeenImage

LONGEST_ODOMETRY_GAP = 0.5  # seconds between two readings that are interpolated
_PLACE = "#"  # not allowed in a topic

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


def recorded_instants(drives: Sequence[DriveSightings], near: float = 0.01) -> RecordedInstants:
    """Puts together what was seen at one time on one drive, with the odometry of that time.

    As the locator does (stamp_groups.hpp): an instant begins with the oldest image, holds one of each other
    camera that is no later than `near` seconds, and has the stamp of its last one; with odometry, a camera
    that saw a little earlier is put where it then was. Instants without markers are kept where there is
    odometry: they carry the path.

    :raises ValueError: near is out of range, or an image is of a camera that the drive does not have
    """
    if not 0.0 <= near <= 1.0:
        raise ValueError(f"near is {near}, allowed is [0, 1] seconds")
    names = sorted({camera_name(name) for drive in drives for name in drive.cameras})
    instants: List[sextant.RecordedInstant] = []
    stamps: List[int] = []
    for number, drive in enumerate(drives):
        for stamp, instant in _drive_instants(drive, number, names, round(near * 1e9)):
            instants.append(instant)
            stamps.append(stamp)
    return RecordedInstants(instants, names, np.array(stamps, dtype=np.int64))


def _drive_instants(
    drive: DriveSightings, number: int, names: List[str], near: int
) -> Iterator[Tuple[int, "sextant.RecordedInstant"]]:
    models = {name: camera.model() for name, camera in drive.cameras.items()}
    groups = list(_groups(drive, names, near))
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


def _groups(drive: DriveSightings, names: List[str], near: int) -> Iterator[Views]:
    waiting: Dict[int, Deque[SeenImage]] = {index: deque() for index in range(len(names))}
    for image in sorted(drive.images, key=lambda image: image.stamp):
        if image.camera not in drive.cameras:
            raise ValueError(f"{drive.name}: an image is of '{image.camera}', which is none of its cameras")
        waiting[names.index(camera_name(image.camera))].append(image)
    while any(waiting.values()):
        last = near + min(images[0].stamp for images in waiting.values() if images)
        yield [
            (index, images.popleft())
            for index, images in waiting.items()
            if images and images[0].stamp <= last
        ]


def _odometry(drive: DriveSightings, stamps: Sequence[int]) -> Dict[int, Optional[np.ndarray]]:
    """T_odom_base by stamp, None where it is not known."""
    at = np.unique(np.array(stamps, dtype=np.int64))
    poses = interpolated_poses(drive.odometry_stamps, drive.odometry, at, LONGEST_ODOMETRY_GAP)
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
    detections = []
    for marker in image.markers:
        detection = sextant.Detection(marker.family, marker.id, marker.corners)
        detection.corner_sigmas = list(marker.sigmas)
        detections.append(detection)
    view = sextant.MarkerView(models[image.camera], T_base_camera, detections)
    view.camera_index = index
    return view


def interpolated_poses(
    stamps: np.ndarray, poses: np.ndarray, at: np.ndarray, longest_gap: float
) -> List[Optional[np.ndarray]]:
    """Poses between recorded ones: positions along the line, rotations at constant speed (slerp).

    :param stamps: (N,) int64 nanoseconds, growing; poses: (N, 4, 4)
    :param at: (M,) int64 nanoseconds
    :param longest_gap: seconds
    :returns: M poses (4, 4); None outside of the stamps and in gaps; at a stamp, exactly its pose
    """
    if len(stamps) == 0:
        return [None] * len(at)
    after = np.searchsorted(stamps, at)  # the first that is not before
    inside = np.minimum(after, len(stamps) - 1)
    exact = stamps[inside] == at
    before = np.where(exact, inside, np.maximum(inside - 1, 0))
    span = stamps[inside] - stamps[before]
    known = exact | ((after > 0) & (after < len(stamps)) & (span <= round(longest_gap * 1e9)))
    share = (at - stamps[before]) / np.maximum(span, 1)
    between = _between(poses[before], poses[inside], np.where(known, share, 0.0))
    between[exact] = poses[inside[exact]]
    return [T if good else None for T, good in zip(between, known)]


def _between(first: np.ndarray, second: np.ndarray, share: np.ndarray) -> np.ndarray:
    """(M, 4, 4) poses that share (M,) of the way from the first to the second."""
    if len(share) == 0:
        return np.zeros((0, 4, 4))
    R = Rotation.from_matrix(first[:, :3, :3])
    turn = (R.inv() * Rotation.from_matrix(second[:, :3, :3])).as_rotvec()
    T = np.tile(np.eye(4), (len(share), 1, 1))
    T[:, :3, :3] = (R * Rotation.from_rotvec(share[:, None] * turn)).as_matrix()
    T[:, :3, 3] = first[:, :3, 3] + share[:, None] * (second[:, :3, 3] - first[:, :3, 3])
    return T
