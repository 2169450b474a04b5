# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Series of a still camera in front of a marker, simulated without images: truth and noise are known."""

import numpy as np
from written_bags import WrittenBag

import sextant
from sextant.localization.drive_observations import DriveCamera, DriveObservations, ImageDetections
from sextant.simulation.camera import camera_calibration

CALIBRATION = camera_calibration(1280, 720)
FAMILY, ID, SIZE = "tag36h11", 7, 0.2
START = 1_600_000_000 * 10**9  # nanoseconds
STEP = 50_000_000


def facing(distance, aside=0.5):
    """T_marker_camera, 4x4: the camera looks at the marker's middle from z = distance.

    :param aside: angle between its view and the marker's normal, radians: head-on a square has two poses
    """
    turn = sextant.pose_from_xyz_rpy([0.0, 0.0, 0.0], [0.0, aside, 0.0])
    return turn @ sextant.pose_from_xyz_rpy([0.0, 0.0, distance / np.cos(aside)], [np.pi, 0.0, 0.0])


def exact_corners(T_marker_camera):
    """(4, 2) pixels, of a pinhole."""
    points = np.c_[sextant.marker_corners(SIZE), np.ones(4)] @ np.linalg.inv(T_marker_camera).T
    pixels = points[:, :3] @ np.reshape(CALIBRATION.K, (3, 3)).T
    return pixels[:, :2] / pixels[:, 2:]


def noisy_corners(T_marker_camera, count, sigma, seed):
    """(count, 4, 2) pixels."""
    return exact_corners(T_marker_camera) + sigma * np.random.default_rng(seed).normal(size=(count, 4, 2))


def observations(corners, sigmas=-1.0, id=ID):
    """DriveObservations of images with these corners (N, 4, 2); sigmas: reported by each of them, pixels."""
    images = [
        ImageDetections(START + k * STEP, "/cam", [sextant.Detection(FAMILY, id, each, np.full(4, sigmas))])
        for k, each in enumerate(corners)
    ]
    return DriveObservations("still.bag", {"/cam": DriveCamera(CALIBRATION)}, images)


def write_series(path, corners, sigma=-1.0):
    """A bag of recorded markers with these corners (N, 4, 2)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with WrittenBag(path) as bag:
        for k, each in enumerate(corners):
            detection = sextant.Detection(FAMILY, ID, each)
            detection.corner_sigmas = [sigma] * 4
            bag.markers("/markers", [detection], CALIBRATION, 0.05 * k)
    return path
