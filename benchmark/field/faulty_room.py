# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that drives through a room whose camera, markers or map are not what the locator is given."""

from dataclasses import dataclass, field, replace
from typing import Iterator, List, NamedTuple, Optional

import cv2
import numpy as np
from real_data import calibration
from simulated_observations import FAMILY, T_BASE_CAMERA
from under_test import map_of

import sextant

WIDTH, HEIGHT = 1280, 720
FOCAL_LENGTH = 0.55 * WIDTH  # pixels
SIZE = 0.2  # m
MARKERS, HALF = 12, 3.0  # on the four walls of a square room; half its width, m
RATE = 10.0  # images per second
NEAREST, MIN_COSINE, MAX_TANGENT = 0.4, 0.3, 1.26  # m; of markers in sight
ROW_ROUNDS = 3  # the row of a corner depends on the time, and the time on the row


@dataclass(frozen=True)
class Truth:
    """What is; the default is what the locator is given."""

    focal_length: float = FOCAL_LENGTH  # pixels
    centre: float = WIDTH / 2 - 0.5  # of the columns, pixels
    k1: float = 0.0
    readout_time: float = 0.0  # s, from the first to the last row
    size: float = SIZE  # m
    offsets: np.ndarray = field(default_factory=lambda: np.zeros((MARKERS, 3)))  # of the markers, m


class Seen(NamedTuple):
    """The markers in one image."""

    stamp: float  # s
    T_map_base: np.ndarray
    view: "sextant.MarkerView"


def room(random: np.random.Generator) -> List[np.ndarray]:
    """Poses of markers on four walls, facing the middle."""
    poses = []
    for number in range(MARKERS):
        yaw = np.pi / 2 * (number % 4)
        along, up = random.uniform(-2.4, 2.4), random.uniform(0.6, 1.6)
        wall = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, 0.0, yaw])
        x, y, z = wall[:3, :3] @ [HALF, along, up]
        poses.append(sextant.pose_from_xyz_rpy([x, y, z], [np.pi / 2, 0.0, yaw - np.pi / 2]))
    return poses


def mapped(poses: List[np.ndarray], sigma: float = 0.0):
    """Returns a sextant.MarkerMap. :param sigma: declared, of the positions, m"""
    covariance = np.diag([sigma**2] * 3 + [0.0] * 3)
    return map_of(
        sextant.MappedMarker(FAMILY, id, SIZE, pose, "", covariance) for id, pose in enumerate(poses)
    )


def at(stamp: float) -> np.ndarray:
    """Pose of the base on its curved path."""
    x, y = 1.2 * np.cos(0.35 * stamp), 1.2 * np.sin(0.47 * stamp)
    return sextant.pose_from_xyz_rpy([x, y, 0.0], [0.0, 0.0, 0.6 * stamp + 0.8 * np.sin(0.9 * stamp)])


def drive(
    poses: List[np.ndarray], truth: Truth, images: int, sigma: float, random: np.random.Generator
) -> Iterator[Seen]:
    """Images with markers, projected by OpenCV. :param sigma: corner noise, pixels"""
    model = sextant.CameraModel(_calibration(Truth()))
    placed = [_shifted(pose, offset) for pose, offset in zip(poses, truth.offsets)]
    for number in range(images):
        stamp, detections = number / RATE, []
        for id, pose in enumerate(placed):
            pixels = _corners(pose, truth, stamp)
            if pixels is not None:
                noise = sigma * random.normal(size=(4, 2))
                detections.append(sextant.Detection(FAMILY, id, pixels + noise))
        if detections:
            yield Seen(stamp, at(stamp), sextant.MarkerView(model, T_BASE_CAMERA, detections))


def _calibration(truth: Truth):
    K = [truth.focal_length, 0.0, truth.centre, 0.0, truth.focal_length, HEIGHT / 2 - 0.5, 0.0, 0.0, 1.0]
    return calibration((WIDTH, HEIGHT), K, [truth.k1, 0.0, 0.0, 0.0, 0.0], "plumb_bob")


def _shifted(pose: np.ndarray, offset: np.ndarray) -> np.ndarray:
    shifted = pose.copy()
    shifted[:3, 3] += offset
    return shifted


def _corners(pose: np.ndarray, truth: Truth, stamp: float) -> Optional[np.ndarray]:
    """Pixels (4, 2); None: not in sight. The stamp is that of the middle row."""
    corners = np.c_[sextant.marker_corners(truth.size), np.ones(4)] @ pose.T
    points = _in_camera(corners[:, :3], stamp)
    if points[:, 2].min() < NEAREST or not _faces(pose, stamp):
        return None
    if np.linalg.norm(points[:, :2], axis=1).max() > MAX_TANGENT * points[:, 2].min():
        return None
    pixels = _projected(points, truth)
    for _ in range(ROW_ROUNDS if truth.readout_time else 0):
        stamps = stamp + truth.readout_time * ((pixels[:, 1] + 0.5) / HEIGHT - 0.5)
        seen = [_in_camera(corners[i : i + 1, :3], row) for i, row in enumerate(stamps)]
        pixels = _projected(np.concatenate(seen), truth)
    inside = (pixels >= 0).all() and (pixels <= [WIDTH - 1, HEIGHT - 1]).all()
    return pixels if inside else None


def _faces(pose: np.ndarray, stamp: float) -> bool:
    toward = (at(stamp) @ T_BASE_CAMERA)[:3, 3] - pose[:3, 3]
    return bool(toward @ pose[:3, 2] > MIN_COSINE * np.linalg.norm(toward))


def _in_camera(points: np.ndarray, stamp: float) -> np.ndarray:
    T_map_camera = at(stamp) @ T_BASE_CAMERA
    return (points - T_map_camera[:3, 3]) @ T_map_camera[:3, :3]


def _projected(points: np.ndarray, truth: Truth) -> np.ndarray:
    camera = _calibration(truth)
    pixels, _ = cv2.projectPoints(
        points, np.zeros(3), np.zeros(3), np.array(camera.K).reshape(3, 3), np.array(camera.D)
    )
    return pixels.reshape(-1, 2)


def faulty(cause: str, random: np.random.Generator) -> Truth:
    """What is, with one of the causes of field.causes."""
    sign = random.choice([-1.0, 1.0])
    offsets = np.zeros((MARKERS, 3))
    if cause == "focal length 1 %":
        return replace(Truth(), focal_length=FOCAL_LENGTH * (1 + 0.01 * sign))
    if cause == "centre 8 px":
        return replace(Truth(), centre=WIDTH / 2 - 0.5 + 8 * sign)
    if cause == "k1 missing":
        return replace(Truth(), k1=-0.1)
    if cause == "shutter 20 ms":
        return replace(Truth(), readout_time=0.02)
    if cause == "marker size 2 %":
        return replace(Truth(), size=SIZE * (1 + 0.02 * sign))
    if cause == "map 0.5 cm":
        return replace(Truth(), offsets=0.005 * random.normal(size=offsets.shape))
    if cause == "marker moved 4 cm":
        direction = random.normal(size=3)
        offsets[random.integers(MARKERS)] = 0.04 * direction / np.linalg.norm(direction)
    return replace(Truth(), offsets=offsets)
