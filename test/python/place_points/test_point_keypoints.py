# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keypoints of images of known content."""

import numpy as np
import pytest

import sextant
from sextant.place_points.point_keypoints import PointKeypointExtractor
from sextant.simulation.camera import camera_calibration

CENTRES = np.array([(60.3, 50.7), (150.5, 121.25), (230.0, 180.0), (100.8, 190.4), (250.9, 60.1)])
SIZE = (320, 240)


def blobs(size=SIZE, scale=1, sigma=5.0):
    """Bright Gaussian blobs at CENTRES; 0 is the centre of the first pixel."""
    x, y = np.meshgrid(*(np.arange(side) for side in size))
    image = np.full((size[1], size[0]), 60.0)
    for u, v in (CENTRES + 0.5) * scale - 0.5:
        image += 120 * np.exp(-((x - u) ** 2 + (y - v) ** 2) / (2 * (scale * sigma) ** 2))
    return image.astype(np.uint8)


@pytest.mark.parametrize(("scale", "sigma"), [(1, 2.0), (1, 5.0), (4, 5.0)])
def test_keypoints_are_at_the_centres_of_blobs(scale, sigma):
    size = (scale * SIZE[0], scale * SIZE[1])
    camera = sextant.CameraModel(camera_calibration(*size))
    found = PointKeypointExtractor().extract(blobs(size, scale, sigma), camera)
    pixels = camera.project_points(np.c_[found.xy, np.ones(len(found.xy))])
    errors = [pixels[np.linalg.norm(pixels - c, axis=1).argmin()] - c for c in (CENTRES + 0.5) * scale - 0.5]
    assert np.abs(errors).max() < 0.15 * scale
    assert np.abs(np.mean(errors, axis=0)).max() < 0.06 * scale


def test_an_image_of_another_size_is_refused():
    camera = sextant.CameraModel(camera_calibration(640, 480))
    with pytest.raises(ValueError, match="320 x 240 pixels, its camera 640 x 480"):
        PointKeypointExtractor().extract(blobs(), camera)


def test_a_blank_image_has_no_keypoints():
    camera = sextant.CameraModel(camera_calibration(*SIZE))
    found = PointKeypointExtractor().extract(np.full(SIZE[::-1], 90, np.uint8), camera)
    assert found.xy.shape == (0, 2) and found.descriptors.shape == (0, 128) and not len(found.sigma)
