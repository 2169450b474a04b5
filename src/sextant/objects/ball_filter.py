# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kalman filter of a ball with three modes: resting, rolling, and kicked since the last observation.

Interacting multiple model filter (Blom and Bar-Shalom 1988, "The interacting multiple model algorithm for
systems with Markovian switching coefficients"). A rolling ball decelerates until it rests; a kicked ball may
have any velocity.
"""

from dataclasses import dataclass
from typing import NamedTuple, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within

RESTING, ROLLING, KICKED = range(3)
INITIAL_PROBABILITIES = np.array([0.6, 0.3, 0.1])  # of the modes, after the first observation
# Transition probabilities from one scan to the next, whatever the time between.
# Row: mode before, column: mode after.
TRANSITIONS = np.array([[0.985, 0.0, 0.015], [0.04, 0.95, 0.01], [0.05, 0.90, 0.05]])
REST_VARIANCE = 1e-6  # of the velocity of a resting ball, (m/s)^2
# Seconds. A kick is assumed to be no older: else the covariance of an unseen ball would grow without limit.
MAX_KICK_AGE = 0.5


@dataclass(frozen=True)
class BallMotionParams(StrictParams):
    """Deceleration and process noise of a ball on a floor."""

    deceleration: float = param(0.35, "deceleration of a rolling ball", within(0.01, 10), "m/s²")
    deceleration_sigma: float = param(0.15, "standard deviation of the deceleration", within(0, 10), "m/s²")
    kick_sigma: float = param(0.8, "standard deviation of the velocity after a kick", within(0.01, 10), "m/s")
    drift_sigma: float = param(
        0.005, "drift of a resting ball's position: standard deviation after 1 s", within(1e-6, 1), "m/√s"
    )


class BallModes(NamedTuple):
    """Position (metres) and velocity (m/s) by mode, at one time."""

    means: np.ndarray  # (3, 4)
    covariances: np.ndarray  # (3, 4, 4)
    probabilities: np.ndarray  # (3,)


def roll(speed: float, seconds: float, deceleration: float) -> Tuple[float, float]:
    """Distance (metres) that a ball rolls in a time, and its speed (m/s) then: s = v t - a t^2 / 2."""
    until = min(seconds, speed / deceleration)
    return speed * until - 0.5 * deceleration * until**2, speed - deceleration * until


def initial_modes(position: np.ndarray, covariance: np.ndarray, params: BallMotionParams) -> BallModes:
    """Initialize from the first observation.

    :param position: (2,) metres. :param covariance: (2, 2)
    """
    means, covariances = np.zeros((3, 4)), np.zeros((3, 4, 4))
    means[:, :2], covariances[:, :2, :2] = position, covariance
    for mode, variance in enumerate((REST_VARIANCE, params.kick_sigma**2, params.kick_sigma**2)):
        covariances[mode, 2:, 2:] = variance * np.eye(2)
    return BallModes(means, covariances, INITIAL_PROBABILITIES)


def predicted(modes: BallModes, seconds: float, params: BallMotionParams) -> BallModes:
    """Predict by a time without mode transitions."""
    means, covariances = modes.means.copy(), modes.covariances.copy()
    covariances[RESTING, :2, :2] += params.drift_sigma**2 * seconds * np.eye(2)
    for mode in (ROLLING, KICKED):
        means[mode], covariances[mode] = _predicted_rolling(means[mode], covariances[mode], seconds, params)
    return BallModes(means, covariances, modes.probabilities)


def predicted_with_transitions(modes: BallModes, seconds: float, params: BallMotionParams) -> BallModes:
    """Predict by a time with mode transitions (the interaction step of the filter)."""
    before = predicted(modes, max(0.0, seconds - MAX_KICK_AGE), params)
    shares = TRANSITIONS * before.probabilities[:, np.newaxis]
    probabilities = shares.sum(axis=0)
    means, covariances = np.zeros((3, 4)), np.zeros((3, 4, 4))
    for mode in (RESTING, ROLLING, KICKED):
        means[mode], covariances[mode] = _moments(before, shares[:, mode] / probabilities[mode])
    means[RESTING, 2:], covariances[RESTING, 2:], covariances[RESTING, :, 2:] = 0.0, 0.0, 0.0
    covariances[RESTING, 2:, 2:] = REST_VARIANCE * np.eye(2)
    covariances[KICKED, 2:, 2:] += params.kick_sigma**2 * np.eye(2)
    return predicted(BallModes(means, covariances, probabilities), min(seconds, MAX_KICK_AGE), params)


def squared_distance(modes: BallModes, position: np.ndarray, covariance: np.ndarray) -> float:
    """Squared Mahalanobis distance of an observation from the closest mode."""
    S = modes.covariances[:, :2, :2] + covariance
    off = position - modes.means[:, :2]
    return float(np.einsum("mi,mij,mj->m", off, np.linalg.inv(S), off).min())


def updated(modes: BallModes, position: np.ndarray, covariance: np.ndarray) -> BallModes:
    """Update each mode by a Kalman filter, and the probabilities by the likelihood of the observation.

    :param position: (2,) metres. :param covariance: (2, 2)
    """
    means, covariances, log_likelihoods = modes.means.copy(), modes.covariances.copy(), np.zeros(3)
    for mode in (RESTING, ROLLING, KICKED):
        P = covariances[mode]
        S = P[:2, :2] + covariance
        K = np.linalg.solve(S, P[:2]).T
        innovation = position - means[mode, :2]
        means[mode] = means[mode] + K @ innovation
        I_KH = np.eye(4)
        I_KH[:, :2] -= K
        covariances[mode] = I_KH @ P @ I_KH.T + K @ covariance @ K.T  # Joseph form
        log_likelihoods[mode] = -0.5 * (
            innovation @ np.linalg.solve(S, innovation) + np.log(np.linalg.det(S))
        )
    weights = modes.probabilities * np.exp(log_likelihoods - log_likelihoods.max())
    return BallModes(means, covariances, weights / weights.sum())


def combined(modes: BallModes) -> Tuple[np.ndarray, np.ndarray]:
    """Mean (4,) and covariance (4, 4) of the mixture of all modes."""
    return _moments(modes, modes.probabilities)


def _moments(modes: BallModes, weights: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    mean = weights @ modes.means
    off = modes.means - mean
    return mean, np.einsum("m,mij->ij", weights, modes.covariances) + (off.T * weights) @ off


def _predicted_rolling(mean: np.ndarray, P: np.ndarray, seconds: float, params: BallMotionParams):
    """Predict a ball that decelerates along a line. Its speed includes the variance of the velocity: with a
    mean velocity of zero, the Jacobian would remove all uncertainty."""
    speed = float(np.sqrt(mean[2:] @ mean[2:] + np.trace(P[2:, 2:])))
    if speed < 1e-9 or seconds <= 0.0:
        return mean, P
    until = min(seconds, speed / params.deceleration)
    distance, end_speed = roll(speed, until, params.deceleration)
    actual = np.hypot(*mean[2:])
    heading = mean[2:] / actual if actual > 1e-9 else np.zeros(2)
    along = np.outer(heading, heading) * min(1.0, actual / speed)
    F = np.eye(4)
    F[:2, 2:] = distance / speed * np.eye(2) + (until - distance / speed) * along
    F[2:, 2:] = end_speed / speed * np.eye(2) + (float(end_speed > 0.0) - end_speed / speed) * along
    moved = np.concatenate([mean[:2] + distance / speed * mean[2:], end_speed / speed * mean[2:]])
    G = np.vstack([0.5 * until**2 * np.eye(2), until * np.eye(2)])
    return moved, F @ P @ F.T + params.deceleration_sigma**2 * G @ G.T
