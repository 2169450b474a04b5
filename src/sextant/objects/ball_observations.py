# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Observations of the ball in one image, and the tracker update with them."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.geometry.plane_poses import rotation
from sextant.objects.ball_tracker import BallTracker
from sextant.objects.ball_visibility import BallVisibility
from sextant.objects.object_kinds import ObjectKind
from sextant.objects.object_locator import LocatedObject


class BallObservations(NamedTuple):
    """Balls and pillars in one image, in the robot frame at the image's stamp."""

    balls: List[LocatedObject]  # positions and covariances
    pillars: List[np.ndarray]  # (3,) x, y and radius, metres
    T_base_camera: np.ndarray  # (4, 4) of the colour camera
    visibility: BallVisibility  # of a ball in this image

    @classmethod
    def of(
        cls,
        seen: Sequence[Tuple[ObjectKind, LocatedObject]],
        T_base_camera: np.ndarray,
        visibility: BallVisibility,
    ) -> "BallObservations":
        """Select balls and pillars from the objects located in an image.

        :param seen: kind and position of each object
        """
        balls = [place for kind, place in seen if kind.shape == "ball"]
        pillars = [np.array([*place.position, kind.radius]) for kind, place in seen if kind.shape == "pillar"]
        return cls(balls, pillars, T_base_camera, visibility)

    def update(self, tracker: BallTracker, stamp: float, T_odom_base: np.ndarray) -> None:
        """Update a tracker, also when the ball is expected in the image but not detected.

        :param stamp: of the image, seconds. :param T_odom_base: (3,) x, y, heading at that time
        """
        R, t = rotation(T_odom_base[2]), np.asarray(T_odom_base)[:2]
        observations = [(R @ ball.position + t, R @ ball.covariance @ R.T) for ball in self.balls]
        tracker.update(
            stamp,
            observations,
            lambda ball: self.visibility.is_visible(R.T @ (ball - t), self.T_base_camera, self.pillars),
        )
