# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Conversion of a depth image to a sparse point cloud in the robot frame."""

import numpy as np

import sextant


class DepthPoints:
    """Points from a depth camera mounted on a robot."""

    def __init__(
        self, camera: "sextant.CameraModel", T_base_depth: np.ndarray, depth_scale: float = 1.0, step: int = 8
    ):
        """:param T_base_depth: (4, 4). :param depth_scale: factor that corrects the depths
        :param step: pixels between used depths
        """
        self._size = camera.size
        x, y = np.meshgrid(*(np.arange(step // 2, side, step) for side in self._size))
        rays = camera.rays(np.column_stack([x.ravel(), y.ravel()]))
        self._at = y.ravel(), x.ravel()
        self._rays = depth_scale * rays @ T_base_depth[:3, :3].T
        self._has_ray = np.isfinite(rays[:, 2])
        self._origin = T_base_depth[:3, 3]

    def of(self, depth: np.ndarray) -> np.ndarray:
        """Convert a depth image to points (n, 3) in the robot frame, metres, z up.

        :param depth: (height, width) metres, 0: none
        :raises ValueError: the depth image and its camera differ in size
        """
        if depth.shape[::-1] != self._size:
            message = "the depth image is {1}×{0}, its camera_info has {2}×{3}"
            raise ValueError(message.format(*depth.shape, *self._size))
        found = depth[self._at]
        which = (found > 0.0) & self._has_ray
        return self._rays[which] * found[which, np.newaxis] + self._origin
