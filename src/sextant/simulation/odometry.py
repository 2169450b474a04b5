# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulation of wheel odometry with drift and its covariance."""

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within
from sextant.geometry.plane_poses import composed, rotation, wrapped
from sextant.simulation.motion import Motion


@dataclass(frozen=True)
class OdometryNoise(StrictParams):
    """Noise with variances proportional to distance and angle.

    Thrun, Burgard, Fox 2005, "Probabilistic robotics", 5.4. Unlike sextant.OdometryNoiseParams it changes the
    length and the angle of a circular arc; there is no lateral slip.
    """

    distance_per_metre: float = param(
        0.02,
        "standard deviation of the measured distance after 1 m, growing with the square root of the distance",
        within(0.0, 1.0),
        "m/√m",
    )
    angle_per_metre: float = param(
        0.02,
        "standard deviation of the measured angle after 1 m, growing with the square root of the distance",
        within(0.0, 1.0),
        "rad/√m",
    )
    angle_per_radian: float = param(
        0.03,
        "standard deviation of the measured angle after 1 rad, growing with the square root of the angle",
        within(0.0, 1.0),
        "rad/√rad",
    )

    def deviations(self, distance: float, turn: float) -> np.ndarray:
        """Standard deviations (2,), metres and radians, of a distance (metres) and a turn (radians)."""
        by_distance, by_turn = np.sqrt(abs(distance)), np.sqrt(abs(turn))
        angle = np.hypot(self.angle_per_metre * by_distance, self.angle_per_radian * by_turn)
        return np.array([self.distance_per_metre * by_distance, angle])


@dataclass(frozen=True)
class OdometryReading:
    """Measured pose and velocity with their covariance."""

    motion: Motion  # in the frame odom
    covariance: np.ndarray  # (3, 3) of x, y, yaw in odom (m^2, m rad, rad^2), linearized
    speed_variance: float  # (m/s)^2
    turn_rate_variance: float  # (rad/s)^2


class _Odometry:
    """Accumulated pose and covariance; the odom frame starts at the robot's first pose."""

    def __init__(self) -> None:
        self._pose = np.zeros(3)  # x, y, yaw in odom
        self._covariance = np.zeros((3, 3))

    def _reading(self, speed: float, turn_rate: float, variances: np.ndarray) -> OdometryReading:
        x, y, yaw = self._pose
        return OdometryReading(Motion(x, y, 0.0, yaw, speed, turn_rate), self._covariance.copy(), *variances)


class WheelOdometry(_Odometry):
    """Integrates the true motion with noise."""

    def __init__(self, noise: OdometryNoise, seed: int):
        super().__init__()
        self._noise = noise
        self._random = np.random.default_rng([seed, 1])
        self._last = None

    def update(self, motion: Motion, seconds: float) -> OdometryReading:
        """Returns the reading after the robot moved here in a time (seconds); the first call starts odom."""
        if self._last is None:
            self._last = motion
            return self._reading(motion.speed, motion.turn_rate, np.zeros(2))
        distance, turn = _arc(self._last, motion)
        self._last = motion
        sigmas = self._noise.deviations(distance, turn)
        self._spread(distance, turn, sigmas)
        measured = np.array([distance, turn]) + sigmas * self._random.standard_normal(2)
        heading = self._pose[2] + 0.5 * measured[1]
        self._pose = self._pose + [measured[0] * np.cos(heading), measured[0] * np.sin(heading), measured[1]]
        return self._reading(*(measured / seconds), (sigmas / seconds) ** 2)

    def carry(self, motion: Motion) -> None:
        """Moves the robot to this pose without wheel motion (kidnapping)."""
        self._last = motion

    def _spread(self, distance: float, turn: float, sigmas: np.ndarray) -> None:
        """P = F P F' + G Q G' with the Jacobians F with respect to the pose, G to distance and turn."""
        heading = self._pose[2] + 0.5 * turn  # of the chord
        c, s = np.cos(heading), np.sin(heading)
        F = np.array([[1.0, 0.0, -distance * s], [0.0, 1.0, distance * c], [0.0, 0.0, 1.0]])
        G = np.array([[c, -0.5 * distance * s], [s, 0.5 * distance * c], [0.0, 1.0]])
        self._covariance = F @ self._covariance @ F.T + G @ np.diag(sigmas**2) @ G.T


class SteppedOdometry(_Odometry):
    """Accumulates steps that already contain noise."""

    def add(self, step: np.ndarray, noise: np.ndarray, seconds: float) -> OdometryReading:
        """Returns the reading after a step that took a time (seconds).

        :param step: (3,) x, y, yaw in the robot frame at its start, metres and radians
        :param noise: (3, 3) covariance of the step, in the robot frame at its start
        """
        before, self._pose = self._pose, composed(self._pose, step)
        dx, dy = (self._pose - before)[:2]
        F = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        axes = np.eye(3)
        axes[:2, :2] = rotation(before[2])
        self._covariance = F @ (self._covariance + axes @ noise @ axes.T) @ F.T
        speed, _, turn_rate = step / seconds
        return self._reading(speed, turn_rate, np.diag(noise)[[0, 2]] / seconds**2)


def _arc(start: Motion, end: Motion) -> Tuple[float, float]:
    """Chord (metres) and turn (radians) of the circular arc from one pose to the other."""
    turn = float(wrapped(end.yaw - start.yaw))
    heading = start.yaw + 0.5 * turn
    return (end.x - start.x) * np.cos(heading) + (end.y - start.y) * np.sin(heading), turn
