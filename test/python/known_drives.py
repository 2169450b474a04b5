# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags of a robot that drives one metre a second along x, and then turns left on the spot."""

import numpy as np
from made_photos import picture
from written_bags import SMALL, WrittenBag

import sextant
from sextant.simulation.camera import camera_mount

SIZE = (64, 48)
RATE = 4  # images a second
MOUNT = camera_mount([0.25, 0.0, 1.0], [0.0, 0.0, 0.0])  # looks ahead
LEFT = camera_mount([0.0, 0.5, 1.0], [0.0, 0.0, 0.5 * np.pi])


def pose(seconds):
    """T_map_base: to x = 4 in four seconds, then 30 degrees a second to the left."""
    yaw = np.radians(30) * max(0.0, seconds - 4)
    return sextant.pose_from_xyz_rpy([min(seconds, 4.0), 2.0, 0.0], [0.0, 0.0, yaw])


def write_drive(
    path, seconds=4.0, mount=MOUNT, poses=True, image=lambda i: picture(i, SIZE), topic="/front/image_raw",
    calibration=None,
):  # fmt: skip
    """Images of seeds 0, 1, ..., with tf of the robot's pose ten times a second."""
    with WrittenBag(path) as bag:
        if calibration:
            bag.info("/front/camera_info", calibration)
        bag.transforms([("base_link", "camera", mount)])
        for i in range(int(seconds * RATE) + 1):
            bag.image(topic, image(i), i / RATE)
        for t in np.arange(-0.1, seconds + 0.2, 0.1) if poses else ():
            bag.transforms([("map", "base_link", pose(t))], t, "/tf", received=max(t, 0.0))
    return str(path)


def write_depth_drive(path, depth_frame="camera", info=True, lag=0.01):
    """A drive whose depth images see a wall two metres from the depth camera, 0.1 m behind the other one."""
    with WrittenBag(path) as bag:
        bag.info("/front/camera_info", SMALL)
        if info:
            bag.info("/depth/camera_info", SMALL, frame=depth_frame)
        bag.transforms([("base_link", "camera", MOUNT)])
        if depth_frame == "depth_camera":
            bag.transforms([("camera", depth_frame, sextant.pose_from_xyz_rpy([0, 0, -0.1], [0, 0, 0]))])
        for i in range(9):
            bag.image("/front/image_raw", picture(i, SIZE), i / RATE)
            depth = np.full(SIZE[::-1], 2000, np.uint16)
            bag.encoded("/depth/image_raw", depth, "16UC1", i / RATE + lag, frame=depth_frame)
            bag.transforms([("map", "base_link", pose(i / RATE))], i / RATE, "/tf")
    return str(path)
