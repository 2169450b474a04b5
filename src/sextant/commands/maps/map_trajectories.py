# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The poses of a robot on a drive, by each of the maps alone."""

import argparse
import functools
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

import sextant
from sextant.bags.bag_pictures import recorded_pictures
from sextant.bags.drive_photos import PhotoParams, read_camera_view
from sextant.commands.bag_options import read_bags, read_mounts
from sextant.commands.map_landmarks import landmark_params, made_landmarks, observation_reading, robot_poses
from sextant.commands.map_markers import drive_reading
from sextant.commands.maps.moved_maps import metric_frame
from sextant.evaluation.trajectory import Trajectory
from sextant.landmarks.slam_run import SlamRun
from sextant.localization.located_drive import locate_drive
from sextant.messages.landmark_messages import planar_sensor_pose
from sextant.place_maps.place_map import PlaceMap
from sextant.place_maps.place_map_file import read_place_map
from sextant.place_points.place_points_file import points_of_map
from sextant.places.place_estimate import metric_pose
from sextant.places.place_index_update import PlaceIndexer
from sextant.places.place_localizer import Localization, PlaceLocalizer
from sextant.places.place_method_params import PlaceMethodParams

MAX_SIGMA = 0.5  # metres, standard deviation of a pose by markers; beyond, it is not used
PERIOD = 10**9  # nanoseconds between two images whose place is recognized


class PlacePoses(NamedTuple):
    """Poses of the base on one bag, by the places of its images."""

    poses: Trajectory  # T_map_base
    warnings: Tuple[str, ...]  # notes on the reading


def marker_trajectory(options: argparse.Namespace, path: Path, notes: List[str]) -> Trajectory:
    """Poses as marker_locator computes them, where they are not ambiguous.

    :param options: bags, and the options of bag_options
    :param notes: gets notes on the reading
    """
    marker_map = sextant.read_marker_map(str(path))
    read, more = read_bags(drive_reading(options, marker_map), options.bags, options)
    notes += more
    poses: Trajectory = {}
    for _, drive in read:
        located = locate_drive(drive, marker_map, sextant.LocalizationParams())
        for stamp, T, covariance in zip(located.stamps.tolist(), located.poses, located.covariances):
            if np.linalg.eigvalsh(covariance[:2, :2])[-1] <= MAX_SIGMA**2:
                poses[stamp] = T
    return poses


def landmark_trajectory(options: argparse.Namespace, path: Path, notes: List[str]) -> Trajectory:
    """Poses as landmark_slam computes them with a known map; the robot is lost at first."""
    params, _ = landmark_params(options.params)
    params.map_file, params.marker_map_file, params.start, params.read_only = str(path), "", "unknown", True
    read, more = read_bags(observation_reading(options), options.bags, options)
    made = made_landmarks([recorded for _, recorded in read], SlamRun(params), is_online=True)
    notes += [*more, *made.notes]
    return robot_poses(made.result)


def place_trajectory(options: argparse.Namespace, path: Path, notes: List[str]) -> Trajectory:
    """Poses as place_localizer computes them: metric ones, or those of the recognized photos."""
    params = PhotoParams(
        image=options.image, every=options.every, base_frame=options.base_frame,
        mounts=read_mounts(options.mounts),
    )  # fmt: skip
    reading = functools.partial(read_place_poses, map_path=path, params=params)
    read, more = read_bags(reading, options.bags, options)
    notes += more
    return {stamp: T for _, found in read for stamp, T in found.poses.items()}


TRAJECTORIES: Dict[str, Callable[[argparse.Namespace, Path, List[str]], Trajectory]] = {
    "markers": marker_trajectory,
    "landmarks": landmark_trajectory,
    "places": place_trajectory,
}


def read_place_poses(path: str, map_path: Path, params: PhotoParams) -> PlacePoses:
    """Localizes the images of a bag, one a second, without odometry.

    :raises OSError, ValueError, BagError: the map, its photos or the bag cannot be used
    """
    place_map = read_place_map(map_path)
    metric_frame(map_path, place_map)
    view, notes = read_camera_view(path, params), []
    model = view.camera.model() if view.camera else None
    localizer = _localizer(map_path, place_map)
    poses, last = {}, -PERIOD
    for picture in recorded_pictures(path, notes, params.image, params.every):
        T_base_camera = view.mount(picture.stamp)
        if picture.stamp < last + PERIOD or T_base_camera is None:
            continue
        last = picture.stamp
        camera = model if model and model.size == picture.image.shape[1::-1] else None
        T = _base_pose(place_map, localizer.localize(picture.image, camera=camera), T_base_camera)
        if T is not None:
            poses[picture.stamp] = T
    return PlacePoses(poses, (*view.warnings, *notes))


def _localizer(map_path: Path, place_map: PlaceMap) -> PlaceLocalizer:
    index = PlaceIndexer(map_path, place_map, PlaceMethodParams().index_params()).index()
    return PlaceLocalizer(place_map, index, points=points_of_map(map_path, place_map))


def _base_pose(place_map: PlaceMap, found: Localization, T_base_camera: np.ndarray) -> Optional[np.ndarray]:
    """T_map_base (4, 4); None: no place, or no heading."""
    if found.pose:
        return found.pose.T_map_camera @ np.linalg.inv(T_base_camera)
    if found.estimate is None or found.estimate.yaw is None:
        return None
    T_map_view, _ = metric_pose(place_map.georeference, place_map.overview, found.estimate)
    x, y, heading = planar_sensor_pose(T_base_camera)  # where the camera looks, seen from above
    return T_map_view @ np.linalg.inv(sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, heading]))
