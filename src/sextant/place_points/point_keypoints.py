# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Keypoints of calibrated images for triangulation and metric poses."""

from typing import NamedTuple, Optional

import numpy as np

import sextant
from sextant.geometry.registered_depth import depths_at

MAX_SIDE = 640  # longer side to which images are reduced, pixels
MAX_KEYPOINTS = 800  # per image, the strongest ones
SUPPORT = 2.0  # described region relative to SIFT's
# Standard deviation of a coordinate before its calibration: constant, and by the keypoint's diameter; pixels
SIGMA, SIGMA_BY_SIZE = 0.2, 0.1
# Shift of all keypoints: OpenCV's SIFT doubles the image without regard to the centres of pixels; pixels
SIFT_SHIFT = 0.25


class PointKeypoints(NamedTuple):
    """Keypoints of one image in normalized coordinates: x / z and y / z of rays in the optical frame."""

    xy: np.ndarray  # (n, 2)
    sigma: np.ndarray  # (n,) standard deviation of each coordinate
    size: np.ndarray  # (n,) diameter, pixels of the reduced image
    descriptors: np.ndarray  # uint8 (n, 128)
    depth: np.ndarray  # (n,) along the optical axis, metres; NaN: unknown


class PointKeypointExtractor:
    """Extracts keypoints; thread-safe."""

    def __init__(self) -> None:
        params = sextant.FeatureParams()
        params.max_side, params.max_features, params.support_scale = MAX_SIDE, MAX_KEYPOINTS, SUPPORT
        self._extractor = sextant.FeatureExtractor(params)

    def extract(
        self, image: np.ndarray, camera: "sextant.CameraModel", depth: Optional[np.ndarray] = None
    ) -> PointKeypoints:
        """Keypoints of an image, without those for which the lens model has no ray.

        :param image: uint8, (height, width) grey or (height, width, 3) BGR
        :param depth: of DepthRegistration.registered(), in the view of the image
        :raises ValueError: the image does not have the camera's size
        """
        if image.shape[1::-1] != camera.size:
            image_size, size = (f"{wide} x {high}" for wide, high in (image.shape[1::-1], camera.size))
            raise ValueError(f"the image has {image_size} pixels, its camera {size}")
        found = self._extractor.extract(image)
        scale = max(1.0, max(camera.size) / MAX_SIDE)  # pixels per pixel of the reduced image
        keypoints = found.keypoints.astype(float)
        pixels = keypoints[:, :2] - SIFT_SHIFT * scale
        rays = camera.rays(pixels)
        seen = np.isfinite(rays).all(axis=1)
        size = keypoints[seen, 2] / (SUPPORT * scale)
        sigma = (SIGMA + SIGMA_BY_SIZE * size) * scale / camera.focal_length
        descriptors = found.descriptors[seen].astype(np.uint8).reshape(-1, 128)  # RootSIFT has integers
        known = np.full(len(size), np.nan) if depth is None else depths_at(depth, pixels[seen], camera.size)
        return PointKeypoints(rays[seen, :2], sigma, size, descriptors, known)
