# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Visibility of a ball on the floor in a camera's image."""

from dataclasses import dataclass
from typing import Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class BallVisibility:
    """Predicts whether a detector should find the ball at a position."""

    camera: "sextant.CameraModel"  # lens
    radius: float  # of the ball, metres
    min_depth: float  # metres along the optical axis
    max_depth: float  # metres along the optical axis
    margin: float = 0.08  # fraction of the image's width; a ball this close to the border may be missed

    def is_visible(
        self, position: np.ndarray, T_base_camera: np.ndarray, pillars: Sequence[np.ndarray] = ()
    ) -> bool:
        """Return whether the whole ball is in the image, within range and not occluded.

        :param position: (2,) in the robot frame, metres. :param T_base_camera: (4, 4)
        :param pillars: (3,) x, y and radius of each pillar in the image, robot frame, metres
        """
        T = np.linalg.inv(T_base_camera)
        point = T[:3, :3] @ [*position, self.radius] + T[:3, 3]
        if not self.min_depth <= point[2] <= self.max_depth:
            return False
        pixel, size = self.camera.project(point), np.array(self.camera.size)
        margin = self.margin * size[0] + self.camera.focal_length * self.radius / point[2]
        if pixel is None or np.any(pixel < margin) or np.any(pixel > size - margin):
            return False
        sight = np.asarray(position) - T_base_camera[:2, 3]
        return not any(self._occludes(each[:2] - T_base_camera[:2, 3], each[2], sight) for each in pillars)

    def _occludes(self, pillar: np.ndarray, radius: float, sight: np.ndarray) -> bool:
        """Whether a pillar covers part of the ball; both are relative to the camera, on the floor."""
        share = (pillar @ sight) / (sight @ sight)
        aside = np.linalg.norm(pillar - share * sight)
        return 0.0 < share < 1.0 and aside < radius + share * self.radius
