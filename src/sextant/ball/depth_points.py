# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Points of a depth image in the robot frame: few, but all over it."""

import numpy as np

import sextant


class DepthPoints:
    """Of a camera that is fixed to a robot."""

    def __init__(
        self, camera: "sextant.CameraModel", T_base_depth: np.ndarray, scale: float = 1.0, step: int = 8
    ):
        """:param T_base_depth: (4, 4). :param scale: that depths are multiplied by
        :param step: pixels from one that is looked at to the next
        """
        self._size = camera.size
        x, y = np.meshgrid(*(np.arange(step // 2, side, step) for side in self._size))
        rays = camera.rays(np.column_stack([x.ravel(), y.ravel()]))
        self._at = y.ravel(), x.ravel()
        self._rays = scale * rays @ T_base_depth[:3, :3].T
        self._has_ray = np.isfinite(rays[:, 2])
        self._origin = T_base_depth[:3, 3]

    def of(self, depth: np.ndarray) -> np.ndarray:
        """(n, 3) metres, z up.

        :param depth: (height, width) metres, 0: none
        :raises ValueError: it is of another size than its camera
        """
        if depth.shape[::-1] != self._size:
            told = "the depth image is {1}×{0}, its camera {2}×{3}"
            raise ValueError(told.format(*depth.shape, *self._size))
        found = depth[self._at]
        which = (found > 0.0) & self._has_ray
        return self._rays[which] * found[which, np.newaxis] + self._origin
