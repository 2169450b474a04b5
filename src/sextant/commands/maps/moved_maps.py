# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Maps that are moved to another frame by a planar transform.

A covariance of the transform is common to the whole map: it is added to that of each marker, and to the joint
covariance of a landmark map, so that a filter that uses both maps corrects the transform.
"""

from pathlib import Path
from typing import Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from scipy.linalg import block_diag

import sextant
from sextant.geometry.plane_poses import composed, rotation
from sextant.images.photo_depth import depth_path
from sextant.place_maps.photo_poses import PhotoPoses, poses_path, read_photo_poses
from sextant.place_maps.place_map import MetricFrame, PlaceMap
from sextant.place_maps.place_map_file import read_place_map


class FrameMove(NamedTuple):
    """A planar transform to another frame."""

    frame: str  # name of that frame
    T_to_from: np.ndarray  # (3,) x, y, heading; metres, radians
    covariance: np.ndarray  # (3, 3) of it

    def T(self) -> np.ndarray:
        """(4, 4) in space."""
        x, y, heading = self.T_to_from
        return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, heading])

    def turned(self, vector: np.ndarray) -> np.ndarray:
        """A vector (2,) in the other frame."""
        return rotation(self.T_to_from[2]) @ vector


def moved_marker_map(marker_map: "sextant.MarkerMap", move: FrameMove) -> "sextant.MarkerMap":
    """Moves the markers; other frames of the file are left out. The map itself if it is in that frame."""
    if marker_map.frame == move.frame and not move.T_to_from.any():
        return marker_map
    result, turn = sextant.MarkerMap(move.frame), block_diag(*[move.T()[:3, :3]] * 2)
    for each in marker_map.markers:
        J = np.zeros((6, 3))  # of position and rotation in the map's axes, by the transform
        J[:2] = _point_jacobian(move.turned(each.T_map_marker[:2, 3]))
        J[5, 2] = 1.0
        covariance = turn @ each.covariance @ turn.T + J @ move.covariance @ J.T
        pose = (move.T() @ each.T_map_marker, each.name, 0.5 * (covariance + covariance.T))
        result.add(sextant.MappedMarker(each.family, each.id, each.size, *pose))
    return result


def moved_landmark_map(landmark_map: "sextant.LandmarkMap", move: FrameMove) -> "sextant.LandmarkMap":
    """Moves the landmarks and the saved pose of the robot."""
    robot, landmarks = landmark_map.pose, landmark_map.landmarks
    parts = [_moved(robot[:2], robot[2], move)]
    parts += [_moved(each.position, each.heading, move) for each in landmarks]
    G = block_diag(*(turn for _, turn, _ in parts))
    J = np.vstack([jacobian for _, _, jacobian in parts])
    covariance = G @ landmark_map.covariance @ G.T + J @ move.covariance @ J.T
    poses = [pose for pose, _, _ in parts]
    return sextant.LandmarkMap(
        move.frame, poses[0], [sextant.Landmark2D(*_position_and_heading(pose)) for pose in poses[1:]],
        landmark_map.labels, 0.5 * (covariance + covariance.T), landmark_map.is_lost,
    )  # fmt: skip


def _position_and_heading(pose: np.ndarray) -> Tuple[np.ndarray, Optional[float]]:
    return pose[:2], float(pose[2]) if len(pose) == 3 else None


def _moved(
    position: np.ndarray, heading: Optional[float], move: FrameMove
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pose (k,), its Jacobian (k, k) by the pose before, and (k, 3) by the transform; k is 2 or 3."""
    pose = composed(move.T_to_from, np.array([*position, heading or 0.0]))
    turn, J = rotation(move.T_to_from[2]), _point_jacobian(move.turned(np.asarray(position)))
    if heading is None:
        return pose[:2], turn, J
    return pose, block_diag(turn, 1.0), np.vstack([J, [0.0, 0.0, 1.0]])


def _point_jacobian(turned: np.ndarray) -> np.ndarray:
    """(2, 3) of a moved point by the transform. :param turned: (2,) the point, rotated only"""
    return np.array([[1.0, 0.0, -turned[1]], [0.0, 1.0, turned[0]]])


class MovedPlaces(NamedTuple):
    """A place map for another folder."""

    place_map: PlaceMap  # all its files are in one folder
    files: Dict[str, bytes]  # content by name
    poses: Optional[PhotoPoses]  # None: the photos have none


def moved_place_map(path: Path, folder: Path, move: FrameMove) -> MovedPlaces:
    """Reads a place map with its photos, and moves it. Its overview remains, only its pose changes.

    :param folder: of the new map
    :raises OSError, ValueError: a file cannot be read, or the map has no tf frame
    """
    place_map = read_place_map(path)
    place = metric_frame(path, place_map)
    origin = composed(move.T_to_from, np.array(place.origin)).tolist()
    photos = tuple(photo._replace(image=_flat(photo.image)) for photo in place_map.photos)
    overview = place_map.overview._replace(image=_flat(place_map.overview.image))
    moved = PlaceMap(folder, overview, photos, place._replace(frame=move.frame, origin=tuple(origin)))
    images = [photo.image for photo in place_map.photos]
    files = _files(place_map.folder, images)
    if (place_map.folder / place_map.overview.image).is_file():
        files[overview.image] = (place_map.folder / place_map.overview.image).read_bytes()
    return MovedPlaces(moved, files, _poses(path, move))


def metric_frame(path: Path, place_map: PlaceMap) -> MetricFrame:
    """The tf frame of a place map. :raises ValueError: it has none"""
    if not isinstance(place_map.georeference, MetricFrame):
        raise ValueError(f"{path}: has no tf frame, so it cannot be moved to another one")
    return place_map.georeference


def _flat(image: str) -> str:
    """The name of a file in a subfolder, in the folder of the map itself."""
    return image.replace("/", "_")


def _files(folder: Path, images: Sequence[str]) -> Dict[str, bytes]:
    files: Dict[str, bytes] = {}
    for image in images:
        if _flat(image) in files:
            raise ValueError(f"{folder / image}: another photo would be '{_flat(image)}', too: rename one")
        files[_flat(image)] = (folder / image).read_bytes()
        depth = depth_path(folder / image)
        if depth.is_file():
            files[depth_path(Path(_flat(image))).name] = depth.read_bytes()
    return files


def _poses(path: Path, move: FrameMove) -> Optional[PhotoPoses]:
    if not poses_path(path).is_file():
        return None
    photos = {
        _flat(image): photo._replace(T_map_camera=move.T() @ photo.T_map_camera)
        for image, photo in read_photo_poses(poses_path(path)).photos.items()
    }
    return PhotoPoses(move.frame, photos)
