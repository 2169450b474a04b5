# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two markers on a wall, the robot before it, and what its camera sees: the truth of the tests here.

Independent of Sextant's own camera model and renderer: a marker's modules go through a plane's homography.
"""

import cv2
import numpy as np
from sensor_msgs.msg import CameraInfo, Image

from sextant import marker_image
from sextant.msg import Marker, MarkerArray

FAMILY = "tag36h11"
SIZE = 0.2  # m
WIDTH, HEIGHT = 640, 480
K = np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]])
SUPERSAMPLING = 4
WALL = 180  # grey level
CAMERA = "camera_optical_frame"
# As one looks at the wall x = 3 m from the middle of the room: right is -y, up is z, out of it is -x.
WALL_AXES = np.array([[0.0, 0, -1], [-1, 0, 0], [0, 1, 0]])
OPTICAL_AXES = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # z ahead, x right, y down


def pose(rotation, translation):
    """4 x 4 matrix of a rotation (3 x 3) and a translation (3, metres)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation, translation
    return T


def turned(yaw):
    """Rotation (3 x 3) about z by yaw radians."""
    return np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])


T_MAP_MARKER = {3: pose(WALL_AXES, [3, 0.5, 1.0]), 5: pose(WALL_AXES, [3, -0.4, 1.3])}
# Tilted by 0.1 rad: supersampling rounds an upright edge to one side, a slanted one to both.
T_BASE_CAMERA = pose(OPTICAL_AXES @ turned(0.1), [0.1, 0, 1.0])
T_MAP_BASE = pose(turned(0.15), [1.0, -0.2, 0])
T_MAP_CAMERA = T_MAP_BASE @ T_BASE_CAMERA
T_CAMERA_MARKER = {id: np.linalg.inv(T_MAP_CAMERA) @ T for id, T in T_MAP_MARKER.items()}


def corners_of(id):
    """Pixels (4 x 2): top left, top right, bottom right, bottom left."""
    return corners_at(T_CAMERA_MARKER[id])


def corners_at(T_camera_marker):
    """Pixels (4 x 2) of a marker that stands there."""
    h = SIZE / 2
    points = np.array([[-h, h, 0, 1], [h, h, 0, 1], [h, -h, 0, 1], [-h, -h, 0, 1]])
    pixels = (K @ (T_camera_marker @ points.T)[:3]).T
    return pixels[:, :2] / pixels[:, 2:]


def paint(canvas, id, T_camera_marker):
    """Draws the print with a white border of one module onto a supersampled picture."""
    modules, begin, end = marker_image(FAMILY, id)
    print_ = cv2.copyMakeBorder(modules, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=255)
    module, centre = SIZE / (end - begin), (begin + end - 1) / 2 + 1
    plane = np.array([[module, 0, -module * centre], [0, -module, module * centre], [0, 0, 1]])
    half = (SUPERSAMPLING - 1) / 2
    fine = np.array([[SUPERSAMPLING, 0, half], [0, SUPERSAMPLING, half], [0, 0, 1]])
    H = fine @ K @ T_camera_marker[:3][:, [0, 1, 3]] @ plane
    size = (canvas.shape[1], canvas.shape[0])
    cv2.warpPerspective(print_, H, size, canvas, cv2.INTER_NEAREST, cv2.BORDER_TRANSPARENT)


def picture(poses=None):
    """Grey image (480 x 640) of the markers at these poses in the camera frame, by (id, number) or id."""
    canvas = np.full((HEIGHT * SUPERSAMPLING, WIDTH * SUPERSAMPLING), WALL, np.uint8)
    for key, T in (T_CAMERA_MARKER if poses is None else poses).items():
        paint(canvas, key[0] if isinstance(key, tuple) else key, T)
    return cv2.resize(canvas, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)


def image_msg(pixels, stamp, encoding="mono8"):
    """Image message of an array (height x width x channels, any type of the encoding's depth)."""
    msg = Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding)
    msg.header.stamp, msg.header.frame_id = stamp, CAMERA
    msg.step = pixels.strides[0]
    msg.data = pixels.tobytes()
    return msg


def camera_info(stamp=None, width=WIDTH, height=HEIGHT):
    """The true calibration, as that of an image of this size."""
    info = CameraInfo(width=width, height=height, distortion_model="plumb_bob", D=[0.0] * 5)
    info.header.frame_id = CAMERA
    if stamp is not None:
        info.header.stamp = stamp
    info.K = K.ravel().tolist()
    info.R = np.eye(3).ravel().tolist()
    info.P = np.hstack([K, np.zeros((3, 1))]).ravel().tolist()
    return info


def marker_msg(id, family=FAMILY, corners=None):
    """A marker with true corners, as a detector publishes it; the poses are left out."""
    corners = corners_of(id) if corners is None else corners
    return Marker(family=family, id=id, corners=np.asarray(corners, float).ravel().tolist())


def markers_msg(stamp, markers=None, frame=CAMERA):
    """What a detector publishes of the scene."""
    msg = MarkerArray(camera_info=camera_info(stamp))
    msg.header.stamp, msg.header.frame_id = stamp, frame
    msg.markers = [marker_msg(3), marker_msg(5)] if markers is None else markers
    return msg
