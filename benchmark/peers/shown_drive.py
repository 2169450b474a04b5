# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Publishes the images of a simulated drive, with calibration and tf, as a camera does."""

from typing import List, NamedTuple, Tuple

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header
from tf2_ros import StaticTransformBroadcaster

import sextant
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.messages.pose_messages import pose_to_transform
from sextant.simulation.drive import DriveParams, SimulatedDrive
from sextant.simulation.room_markers import default_map

CAMERA, BASE = "camera_optical_frame", "base_link"


class ShownDrive(NamedTuple):
    """Images of an ideal lens, which are raw and rectified at once, and what is true of them."""

    images: List[np.ndarray]
    truth: List[np.ndarray]  # T_map_base (4, 4) by image
    T_base_camera: np.ndarray
    map: "sextant.MarkerMap"
    calibration: "sextant.CameraCalibration"


def shown_drive(family: str, size: Tuple[int, int], rate: float, count: int) -> ShownDrive:
    """Renders the first images. :param size: width and height, pixels :param rate: Hz"""
    params = DriveParams(width=size[0], height=size[1], rate=rate)
    drive = SimulatedDrive(params, default_map(family))
    frames = list(drive.frames(count))
    images, truth = [frame.image for frame in frames], [frame.T_map_base for frame in frames]
    return ShownDrive(images, truth, drive.T_base_camera, drive.map, drive.calibration)


class Camera:
    """Publishers of camera/image_raw and camera/camera_info, and the static transform of the mount."""

    def __init__(self, drive: ShownDrive):
        self._drive = drive
        self._images = rospy.Publisher("camera/image_raw", Image, queue_size=10)
        self._infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=10)
        self._tf = StaticTransformBroadcaster()
        self._tf.sendTransform(pose_to_transform(drive.T_base_camera, Header(frame_id=BASE), CAMERA))

    @property
    def has_subscribers(self) -> bool:
        """Whether both topics have some."""
        return self._images.get_num_connections() > 0 and self._infos.get_num_connections() > 0

    def show(self, number: int) -> int:
        """Publish an image of the drive; returns its stamp, nanoseconds."""
        header = Header(stamp=rospy.Time.now(), frame_id=CAMERA)
        self._infos.publish(calibration_to_message(self._drive.calibration, header))
        self._images.publish(image_to_message(self._drive.images[number], header))
        return header.stamp.to_nsec()

    def unregister(self) -> None:
        """Unregister the publishers."""
        self._images.unregister()
        self._infos.unregister()
