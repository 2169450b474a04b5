# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rendered photos of a marker through a lens that is known, and calibration files of it."""

import cv2
import numpy as np
import pytest

import sextant
from sextant.simulation.camera import camera_calibration
from sextant.simulation.room_markers import room_for

SIZE, FOCAL = 0.16, 532.5
DISTORTION = [-0.05, 0.02, 0.0, 0.0, 0.0]
PLACES = [(319.5, 239.5), (105.0, 95.0), (535.0, 95.0), (105.0, 385.0), (535.0, 385.0)]  # pixels


def calibration_text(focal=FOCAL, shift=0.0, distortion=DISTORTION):
    """As camera_calibration writes it."""
    K = f"[{focal}, 0., {319.5 + shift}, 0., {focal}, 239.5, 0., 0., 1.]"
    P = f"[{focal}, 0., {319.5 + shift}, 0., 0., {focal}, 239.5, 0., 0., 0., 1., 0.]"
    return f"""\
image_width: 640
image_height: 480
camera_name: camera
camera_matrix: {{rows: 3, cols: 3, data: {K}}}
distortion_model: plumb_bob
distortion_coefficients: {{rows: 1, cols: {len(distortion)}, data: {distortion}}}
rectification_matrix: {{rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}}
projection_matrix: {{rows: 3, cols: 4, data: {P}}}
"""


def truth():
    fov = 2.0 * np.arctan(320.0 / FOCAL)
    return sextant.CameraModel(camera_calibration(640, 480, fov, "plumb_bob", DISTORTION))


def marker_toward(pixel, distance, random):
    """T_camera_marker, turned by 25 degrees from facing the camera."""
    way = random.uniform(0.0, 2.0 * np.pi)
    T = np.eye(4)
    turn = sextant.exp_so3(np.deg2rad(25.0) * np.array([np.cos(way), np.sin(way), 0.0]))
    T[:3, :3], T[:3, 3] = turn @ np.diag([1.0, -1.0, -1.0]), distance * truth().unproject(pixel)
    return T


def photograph(T_camera_markers, frame):
    T_map_camera = sextant.pose_from_xyz_rpy([0.0, 0.0, 1.2], [-0.5 * np.pi, 0.0, 0.0])
    marker_map = sextant.MarkerMap()
    for number, T in enumerate(T_camera_markers):
        marker_map.add(sextant.MappedMarker("tag36h11", number, SIZE, T_map_camera @ T))
    scene = sextant.RoomScene(room_for(marker_map, obstacles=False), marker_map)
    return sextant.RoomRenderer(sextant.RoomRendererParams(), scene, truth()).render([T_map_camera], frame)


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    """A folder with calibrations, and photos in the folders 0.7, 1.2 and 2.4; and one of two markers."""
    folder, random = tmp_path_factory.mktemp("photos"), np.random.default_rng(4)
    for distance in (0.7, 1.2, 2.4):
        (folder / str(distance)).mkdir()
        for number, pixel in enumerate(PLACES):
            picture = photograph([marker_toward(pixel, distance, random)], number)
            cv2.imwrite(str(folder / str(distance) / f"{number}.png"), picture)
    (folder / "two").mkdir()
    both = [marker_toward(pixel, 1.2, random) for pixel in PLACES[1:3]]
    cv2.imwrite(str(folder / "two" / "a.png"), photograph(both, 9))
    (folder / "tape.txt").write_text("# photo metres\ntwo/a.png 1.2\n\n0.7/0.png   0.700\n")
    cv2.imwrite(str(folder / "two" / "small.pgm"), np.zeros((240, 320), np.uint8))
    (folder / "right.yaml").write_text(calibration_text())
    (folder / "long.yaml").write_text(calibration_text(focal=1.02 * FOCAL))
    (folder / "shifted.yaml").write_text(calibration_text(shift=15.0))
    return folder
