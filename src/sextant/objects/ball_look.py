# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What one picture shows of the ball, and how a tracker learns it."""

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from sextant.geometry.plane_poses import rotation
from sextant.objects.ball_tracker import BallTracker
from sextant.objects.ball_view import BallView
from sextant.objects.object_kinds import ObjectKind
from sextant.objects.object_locator import LocatedObject


class BallLook(NamedTuple):
    """All in the robot frame of the picture's time."""

    balls: List[LocatedObject]
    pillars: List[np.ndarray]  # (3,) x, y and radius
    T_base_camera: np.ndarray  # (4, 4)
    view: BallView

    @classmethod
    def of(
        cls, seen: Sequence[Tuple[ObjectKind, LocatedObject]], T_base_camera: np.ndarray, view: BallView
    ) -> "BallLook":
        """:param seen: everything that was located in the picture"""
        balls = [place for kind, place in seen if kind.shape == "ball"]
        pillars = [
            np.array([*place.position, kind.radius]) for kind, place in seen if kind.shape == "pillar"
        ]
        return cls(balls, pillars, T_base_camera, view)

    def tell(self, tracker: BallTracker, stamp: float, T_odom_base: np.ndarray) -> None:
        """Where the ball was seen, and that it was not seen where it should have been.

        :param stamp: of the picture, seconds. :param T_odom_base: (3,) x, y, heading, then
        """
        R, t = rotation(T_odom_base[2]), np.asarray(T_odom_base)[:2]
        sightings = [(R @ ball.position + t, R @ ball.covariance @ R.T) for ball in self.balls]
        tracker.look(
            stamp, sightings, lambda ball: self.view.has(R.T @ (ball - t), self.T_base_camera, self.pillars)
        )
