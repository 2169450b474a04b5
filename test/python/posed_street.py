# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A map of a few photos of a simulated street with their true poses."""

from functools import lru_cache

import cv2
import numpy as np

import sextant
from sextant.geometry.poses import R_BODY_OPTICAL
from sextant.place_maps.photo_poses import PhotoCamera, PhotoPoses, PosedPhoto, poses_path, write_photo_poses
from sextant.place_maps.place_map import MetricFrame, Overview, Photo, PlaceMap
from sextant.place_maps.place_map_file import write_place_map
from sextant.simulation.camera import camera_calibration
from sextant.streets.street import Street
from sextant.streets.street_camera import CAMERAS
from sextant.streets.street_view import street_view

SIZE, STEP, COUNT = (480, 360), 3.0, 6
CAMERA = PhotoCamera(camera_calibration(*SIZE))


@lru_cache(maxsize=1)
def street():
    return Street(5)


def view(arc, aside=0.0, turn=0.0, seed=0):
    """Image and T_map_camera at an arc length, with an offset to the left and a rotation."""
    x, y, yaw = street().pose(arc, aside, turn)
    T = sextant.pose_from_xyz_rpy([x, y, CAMERAS["ideal"].height], [0.0, 0.0, yaw])
    T[:3, :3] = T[:3, :3] @ R_BODY_OPTICAL
    return street_view(street(), (x, y, yaw), SIZE, seed), T


def write_street(folder, frame="map"):
    """Writes map, photos and poses; returns the map's path and content."""
    overview, place = Overview("none.png", 1000, 1000), MetricFrame("map", 0.2, (-20.0, -20.0, 0.0))
    photos, posed = [], {}
    for number in range(COUNT):
        image, T = view(STEP * number, seed=number)
        name = f"{number}.png"
        cv2.imwrite(str(folder / name), image)
        photos.append(Photo(number, name, *place.pixel(overview, *T[:2, 3]), 0.0))
        posed[name] = PosedPhoto(CAMERA, T)
    place_map = PlaceMap(folder, overview, tuple(photos), place)
    write_place_map(folder / "map.txt", place_map)
    write_photo_poses(poses_path(folder / "map.txt"), PhotoPoses(frame, posed))
    return folder / "map.txt", place_map


def errors(T, pose):
    """Distance in metres and angle in radians."""
    error = np.asarray(sextant.pose_error(T, pose.T_map_camera))
    return np.linalg.norm(error[:3]), np.linalg.norm(error[3:])
