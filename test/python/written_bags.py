# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Bags that tests write, with what is in them known."""

import cv2
import genpy
import numpy as np
import rosbag
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

import sextant
from sextant.messages.camera_messages import calibration_to_message
from sextant.messages.image_messages import image_to_message
from sextant.messages.pose_messages import pose_to_message, pose_to_transform
from sextant.msg import Marker, MarkerArray
from sextant.simulation.camera import camera_calibration

START = 1_600_000_000 * 10**9  # nanoseconds
SMALL = camera_calibration(64, 48)
PIXELS = {
    "mono8": 1,
    "bgr8": 3,
    "rgb8": 3,
    "rgba8": 4,
    "8UC3": 3,
    "8UC4": 4,
    "mono16": 2,
    "32FC1": 4,
    "16UC1": 2,
}


def nanoseconds(seconds):
    return START + round(seconds * 1e9)


def time(seconds):
    """genpy.Time so many seconds after START; None: zero."""
    if seconds is None:
        return genpy.Time()
    return genpy.Time(*divmod(nanoseconds(seconds), 10**9))


def header(seconds, frame):
    return Header(stamp=time(seconds), frame_id=frame)


def flat(value=128):
    """A picture with nothing in it."""
    return np.full((48, 64), value, dtype=np.uint8)


class WrittenBag:
    """A bag in a folder; a context manager. Messages are received at their stamp by default."""

    def __init__(self, path, **settings):
        self.path = str(path)
        self._bag = rosbag.Bag(self.path, "w", **settings)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._bag.close()

    def write(self, topic, message, seconds):
        self._bag.write(topic, message, time(seconds))

    def info(self, topic, calibration, seconds=0.0, frame="camera", **fields):
        info = calibration_to_message(calibration, header(seconds, frame))
        for name, value in fields.items():
            setattr(info, name, value)
        self.write(topic, info, seconds)

    def image(self, topic, image, seconds, frame="camera", received=None, **fields):
        message = image_to_message(image, header(seconds, frame))
        for name, value in fields.items():
            setattr(message, name, value)
        self.write(topic, message, seconds if received is None else received)

    def encoded(self, topic, data, encoding, seconds, padding=0, big=False, frame="camera"):
        """An image of these bytes, its rows padded with so many."""
        height, width = data.shape[:2]
        rows = np.ascontiguousarray(data).view(np.uint8).reshape(height, -1)
        padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
        step = width * PIXELS[encoding] + padding
        message = Image(header(seconds, frame), height, width, encoding, big, step, padded.tobytes())
        self.write(topic, message, seconds)

    def compressed(self, topic, image, seconds, frame="camera", ending=".png"):
        data = image if isinstance(image, bytes) else cv2.imencode(ending, image)[1].tobytes()
        self.write(topic, CompressedImage(header(seconds, frame), ending[1:], data), seconds)

    def markers(self, topic, detections, calibration, seconds, frame="camera", rectified=False):
        info = calibration_to_message(calibration, header(seconds, frame))
        message = MarkerArray(
            header(seconds, frame), info, rectified, [marker_message(d) for d in detections]
        )
        self.write(topic, message, seconds)

    def transforms(self, edges, seconds=0.0, topic="/tf_static", received=None):
        """edges: (parent, child, T_parent_child)"""
        all_of = [pose_to_transform(T, header(seconds, parent), child) for parent, child, T in edges]
        self.write(topic, TFMessage(all_of), seconds if received is None else received)

    def odometry(self, topic, T, seconds, frame="odom", child="base_link", received=None):
        message = Odometry(header=header(seconds, frame), child_frame_id=child)
        message.pose.pose = pose_to_message(T)
        self.write(topic, message, seconds if received is None else received)


def marker_message(detection):
    """sextant/Marker as the detector node fills it in, without poses."""
    return Marker(
        family=detection.family,
        id=detection.id,
        corners=detection.corners.ravel().tolist(),
        corner_sigmas=list(detection.corner_sigmas),
    )


def small_drive(path, images=3, **settings):
    """The least that can be read: pictures without markers, two a second, of a camera without tf."""
    with WrittenBag(path, **settings) as bag:
        bag.info("/cam/camera_info", SMALL)
        for index in range(images):
            bag.image("/cam/image_raw", flat(100 + index), 0.5 * index)
    return str(path)


def calibration_file(path, calibration, **changes):
    """As camera_calibration writes it; changes of a value None leave its line out."""
    matrices = {
        "camera_matrix": calibration.K,
        "distortion_coefficients": np.atleast_2d(calibration.D),
        "rectification_matrix": calibration.R,
        "projection_matrix": calibration.P,
    }
    lines = {
        "image_width": str(calibration.width),
        "image_height": str(calibration.height),
        "camera_name": "narrow_stereo",
        "distortion_model": calibration.distortion_model,
        **{
            name: f"\n  rows: {matrix.shape[0]}\n  cols: {matrix.shape[1]}\n"
            f"  data: [{', '.join(map(repr, map(float, matrix.ravel())))}]"
            for name, matrix in matrices.items()
        },
        **changes,
    }
    path.write_text("".join(f"{name}: {value}\n" for name, value in lines.items() if value is not None))
    return str(path)


def detect(image, calibration, families=("tag36h11",), rectified=False):
    """What the detector finds, called directly."""
    params = sextant.DetectorParams()
    params.families = list(families)
    return sextant.MarkerDetector(params).detect(image, sextant.CameraModel(calibration, rectified))
