# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes a round through the rendered building as a bag: images, pillars, odometry and the camera's mount."""

from pathlib import Path
from typing import Dict

import cv2
import genpy
import numpy as np
import rosbag
from geometry_msgs.msg import PoseWithCovariance
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

import sextant
from sextant.base.atomic_file import atomic_files
from sextant.buildings.building_looks import PHOTO_DAY, BuildingLooks
from sextant.buildings.building_maps import QUALITY
from sextant.buildings.building_view import BuildingCamera, building_view
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.landmark_messages import observations_to_messages
from sextant.messages.pose_messages import pose_to_message, pose_to_transform
from sextant.msg import LandmarkObservations
from sextant.simulation.building import Building
from sextant.simulation.building_round import BuildingRound, RoundParams, RoundStep

BEGIN = 10**9  # nanoseconds, first stamp: a stamp of zero is none
BASE, CAMERA, ODOMETRY = "base_link", "camera_optical_frame", "odom"  # frames


def write_round_bag(path: Path, building: Building, params: RoundParams) -> Dict[int, np.ndarray]:
    """Writes the bag atomically; an image with each scan for pillars.

    :returns: true poses T_map_camera (4, 4) of the optical frame by the stamps of the images, nanoseconds
    """
    camera, looks = BuildingCamera(), BuildingLooks(building, day=PHOTO_DAY)
    truth: Dict[int, np.ndarray] = {}
    with atomic_files(path.parent) as folder, rosbag.Bag(str(folder / path.name), "w") as bag:
        for number, step in enumerate(BuildingRound(building, params)):
            stamp = BEGIN + round(1e9 * step.stamp)
            time = genpy.Time(*divmod(stamp, 10**9))
            if number == 0:
                mount = pose_to_transform(camera.T_base_camera, Header(stamp=time, frame_id=BASE), CAMERA)
                bag.write("/tf_static", TFMessage([mount]), time)
            bag.write("/odom", _odometry(time, step), time)
            if step.pillars is None:
                continue
            seen = observations_to_messages(step.pillars)
            bag.write("/landmarks", LandmarkObservations(Header(stamp=time, frame_id=BASE), seen), time)
            header = Header(stamp=time, frame_id=CAMERA)
            bag.write("/camera/camera_info", calibration_to_message(camera.calibration(), header), time)
            image = building_view(building, looks, camera, step.pose, number)
            bag.write("/camera/image_raw/compressed", _jpeg(image, header), time)
            truth[stamp] = camera.pose(step.pose)
    return truth


def _odometry(time: genpy.Time, step: RoundStep) -> Odometry:
    x, y, yaw = step.T_odom_base
    pose = pose_to_message(sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, yaw]))
    header = Header(stamp=time, frame_id=ODOMETRY)
    return Odometry(header=header, child_frame_id=BASE, pose=PoseWithCovariance(pose=pose))


def _jpeg(image: np.ndarray, header: Header) -> CompressedImage:
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return CompressedImage(header, "jpeg", data.tobytes())
