# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a camera should see a ball that lies on the floor somewhere."""

from dataclasses import dataclass
from typing import Sequence

import numpy as np

import sextant


@dataclass(frozen=True)
class BallView:
    """What a camera sees of the floor."""

    camera: "sextant.CameraModel"
    radius: float  # of the ball, metres
    nearest: float  # metres that it has to be away
    farthest: float
    margin: float = 0.08  # share of the picture's width, along its borders, where it may be missed

    def has(
        self, position: np.ndarray, T_base_camera: np.ndarray, pillars: Sequence[np.ndarray] = ()
    ) -> bool:
        """Whether a ball would be seen well.

        :param position: (2,) in the robot frame, metres. :param T_base_camera: (4, 4)
        :param pillars: of those that are seen, (3,) x, y and radius
        """
        T = np.linalg.inv(T_base_camera)
        point = T[:3, :3] @ [*position, self.radius] + T[:3, 3]
        if not self.nearest <= point[2] <= self.farthest:
            return False
        pixel, size = self.camera.project(point), np.array(self.camera.size)
        margin = self.margin * size[0] + self.camera.focal_length * self.radius / point[2]
        if pixel is None or np.any(pixel < margin) or np.any(pixel > size - margin):
            return False
        sight = np.asarray(position) - T_base_camera[:2, 3]
        return not any(self._hides(each[:2] - T_base_camera[:2, 3], each[2], sight) for each in pillars)

    def _hides(self, pillar: np.ndarray, radius: float, sight: np.ndarray) -> bool:
        """Whether a pillar covers some of the ball; both as the camera has them on the floor."""
        share = (pillar @ sight) / (sight @ sight)
        aside = np.linalg.norm(pillar - share * sight)
        return 0.0 < share < 1.0 and aside < radius + share * self.radius
