# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the images of one camera on a robot as a bag."""

from pathlib import Path
from typing import Iterable, Tuple

import genpy
import numpy as np
import rosbag
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

import sextant
from sextant.base.atomic_file import atomic_files
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_png_message
from sextant.messages.pose_messages import pose_to_transform

INFO, IMAGE = "/camera/camera_info", "/camera/image_raw/compressed"  # topics
BASE, CAMERA = "base_link", "camera_optical_frame"


def write_camera_bag(
    path: Path,
    images: Iterable[Tuple[int, np.ndarray]],
    calibration: "sextant.CameraCalibration",
    T_base_camera: np.ndarray,
) -> None:
    """Writes a bag atomically: images as PNG, camera_info, and the mount on /tf_static.

    :param images: stamp in nanoseconds, increasing, and uint8 (height, width); not empty
    :param T_base_camera: (4, 4) of the optical frame
    :raises OSError: the file cannot be written
    """
    with atomic_files(path.parent) as folder, rosbag.Bag(str(folder / path.name), "w") as bag:
        for number, (stamp, image) in enumerate(images):
            time = genpy.Time(*divmod(stamp, 10**9))
            if number == 0:
                mount = pose_to_transform(T_base_camera, Header(stamp=time, frame_id=BASE), CAMERA)
                bag.write("/tf_static", TFMessage([mount]), time)
            header = Header(stamp=time, frame_id=CAMERA)
            bag.write(INFO, calibration_to_message(calibration, header), time)
            bag.write(IMAGE, image_to_png_message(image, header), time)
