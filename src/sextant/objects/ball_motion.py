# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How a ball lies, rolls and is hit: a filter of these three modes.

Interacting multiple models (Blom and Bar-Shalom 1988, "The interacting multiple model algorithm for systems
with Markovian switching coefficients"). What lies has no speed; what rolls slows down along its way until it
lies; what was hit since it was last seen may have any speed.
"""

from dataclasses import dataclass
from typing import NamedTuple, Tuple

import numpy as np

from sextant.base.strict_params import StrictParams, param, within

LIES, ROLLS, HIT = range(3)
START = np.array([0.6, 0.3, 0.1])  # probabilities of a ball that was seen but once
# Row: mode before, column: mode after.
JUMPS = np.array([[0.985, 0.0, 0.015], [0.04, 0.95, 0.01], [0.05, 0.90, 0.05]])
AT_REST = 1e-6  # variance of a speed that is nought, (m/s)^2
LONGEST_HIT = (
    0.5  # seconds before a sighting that it was hit, at most: one that was long not seen can be anywhere
)


@dataclass(frozen=True)
class BallMotionParams(StrictParams):
    """Of a ball on a floor."""

    rolling: float = param(0.35, within(0.01, 10))  # m/s^2 by which it slows down
    rolling_sigma: float = param(0.15, within(0, 10))  # deviation of that, m/s^2
    hit_sigma: float = param(0.8, within(0.01, 10))  # deviation of the speed that a hit gives, m/s
    creep: float = param(0.005, within(1e-6, 1))  # deviation of a place where it lies, after a second, metres


class BallModes(NamedTuple):
    """x, y (metres) and their speeds (m/s) by mode, at one moment."""

    means: np.ndarray  # (3, 4)
    covariances: np.ndarray  # (3, 4, 4)
    probabilities: np.ndarray  # (3,)


def rolled(speed: float, seconds: float, deceleration: float) -> Tuple[float, float]:
    """Metres that a ball rolls in so many seconds, and how fast (m/s) it is then: s = v t - a t^2 / 2."""
    until = min(seconds, speed / deceleration)
    return speed * until - 0.5 * deceleration * until**2, speed - deceleration * until


def seen_first(position: np.ndarray, covariance: np.ndarray, params: BallMotionParams) -> BallModes:
    """:param position: (2,). :param covariance: (2, 2)"""
    means, covariances = np.zeros((3, 4)), np.zeros((3, 4, 4))
    means[:, :2], covariances[:, :2, :2] = position, covariance
    for mode, variance in enumerate((AT_REST, params.hit_sigma**2, params.hit_sigma**2)):
        covariances[mode, 2:, 2:] = variance * np.eye(2)
    return BallModes(means, covariances, START)


def moved_on(modes: BallModes, seconds: float, params: BallMotionParams) -> BallModes:
    """Later, if nothing hits it."""
    means, covariances = modes.means.copy(), modes.covariances.copy()
    covariances[LIES, :2, :2] += params.creep**2 * seconds * np.eye(2)
    for mode in (ROLLS, HIT):
        means[mode], covariances[mode] = _rolled(means[mode], covariances[mode], seconds, params)
    return BallModes(means, covariances, modes.probabilities)


def jumped(modes: BallModes, seconds: float, params: BallMotionParams) -> BallModes:
    """Later, whatever happened meanwhile."""
    before = moved_on(modes, max(0.0, seconds - LONGEST_HIT), params)
    shares = JUMPS * before.probabilities[:, np.newaxis]
    probabilities = shares.sum(axis=0)
    means, covariances = np.zeros((3, 4)), np.zeros((3, 4, 4))
    for mode in (LIES, ROLLS, HIT):
        means[mode], covariances[mode] = _mixed(before, shares[:, mode] / probabilities[mode])
    means[LIES, 2:], covariances[LIES, 2:], covariances[LIES, :, 2:] = 0.0, 0.0, 0.0
    covariances[LIES, 2:, 2:] = AT_REST * np.eye(2)
    covariances[HIT, 2:, 2:] += params.hit_sigma**2 * np.eye(2)
    return moved_on(BallModes(means, covariances, probabilities), min(seconds, LONGEST_HIT), params)


def distance(modes: BallModes, position: np.ndarray, covariance: np.ndarray) -> float:
    """Squared deviations from the mode that fits a sighting best."""
    S = modes.covariances[:, :2, :2] + covariance
    off = position - modes.means[:, :2]
    return float(np.einsum("mi,mij,mj->m", off, np.linalg.inv(S), off).min())


def seen_again(modes: BallModes, position: np.ndarray, covariance: np.ndarray) -> BallModes:
    """With one more sighting (2,), (2, 2): a Kalman filter a mode, weighed by how well it foresaw that."""
    means, covariances, logs = modes.means.copy(), modes.covariances.copy(), np.zeros(3)
    for mode in (LIES, ROLLS, HIT):
        P = covariances[mode]
        S = P[:2, :2] + covariance
        K = np.linalg.solve(S, P[:2]).T
        off = position - means[mode, :2]
        means[mode] = means[mode] + K @ off
        reduced = np.eye(4)
        reduced[:, :2] -= K
        covariances[mode] = reduced @ P @ reduced.T + K @ covariance @ K.T  # Joseph's form
        logs[mode] = -0.5 * (off @ np.linalg.solve(S, off) + np.log(np.linalg.det(S)))
    weights = modes.probabilities * np.exp(logs - logs.max())
    return BallModes(means, covariances, weights / weights.sum())


def merged(modes: BallModes) -> Tuple[np.ndarray, np.ndarray]:
    """Mean (4,) and covariance (4, 4) of all modes together."""
    return _mixed(modes, modes.probabilities)


def _mixed(modes: BallModes, weights: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    mean = weights @ modes.means
    off = modes.means - mean
    return mean, np.einsum("m,mij->ij", weights, modes.covariances) + (off.T * weights) @ off


def _rolled(mean: np.ndarray, P: np.ndarray, seconds: float, params: BallMotionParams):
    """Along a line, slower and slower. Where the speed is not known, one as large as its deviation is taken:
    of a speed of nought nothing would be left."""
    speed = float(np.sqrt(mean[2:] @ mean[2:] + np.trace(P[2:, 2:])))
    if speed < 1e-9 or seconds <= 0.0:
        return mean, P
    until = min(seconds, speed / params.rolling)
    way, slowed = rolled(speed, until, params.rolling)
    actual = np.hypot(*mean[2:])
    heading = mean[2:] / actual if actual > 1e-9 else np.zeros(2)
    along = np.outer(heading, heading) * min(1.0, actual / speed)
    F = np.eye(4)
    F[:2, 2:] = way / speed * np.eye(2) + (until - way / speed) * along
    F[2:, 2:] = slowed / speed * np.eye(2) + (float(slowed > 0.0) - slowed / speed) * along
    moved = np.concatenate([mean[:2] + way / speed * mean[2:], slowed / speed * mean[2:]])
    G = np.vstack([0.5 * until**2 * np.eye(2), until * np.eye(2)])
    return moved, F @ P @ F.T + params.rolling_sigma**2 * G @ G.T
