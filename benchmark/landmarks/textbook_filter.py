# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Unscented Kalman filters with sigma points of the whole state, in O(n^3), as references for the core's.

Sigma points as in Wan and van der Merwe 2000, with the core's alpha and beta; a strongly nonlinear update is
applied in parts, as in the core. Landmarks have no heading. Columns are states x, y, heading, then x, y of
each landmark.
"""

from typing import Callable, List, Tuple

import numpy as np
from scipy.linalg import block_diag, eigh

import sextant
from sextant.geometry.plane_poses import rotation

ALPHA, BETA = 0.1, 2.0
SCALED = 3 * ALPHA**2  # n + lambda
CENTRE = 2 - ALPHA**2 + BETA  # weight of the centre's covariance, less n / SCALED
MAX_NONLINEARITY = 0.05  # of one part of an update, of the noise variance


class TextbookFilter:
    """The interface of sextant.LandmarkFilter; errors are differences."""

    def __init__(self, pose: np.ndarray, covariance: np.ndarray):
        self._x, self._P = np.array(pose, dtype=float), np.array(covariance)

    @property
    def pose(self) -> np.ndarray:
        """(3,) x, y, heading."""
        return self._x[:3].copy()

    @property
    def landmarks(self) -> list:
        """sextant.Landmark2D."""
        return [sextant.Landmark2D(position) for position in self._x[3:].reshape(-1, 2)]

    @property
    def covariance(self) -> np.ndarray:
        """(n, n) of x, y, heading and all landmarks, map's axes."""
        return self._P

    def predict(self, step: np.ndarray, noise: np.ndarray) -> None:
        """As sextant.LandmarkFilter.predict()."""
        G = self._noise_input()
        self._propagate(step)
        self._P = self._P + G @ noise @ G.T

    def update(self, indices: List[int], observations: list) -> None:
        """As sextant.LandmarkFilter.update()."""
        if not indices:
            return
        z = np.concatenate([observation.position for observation in observations])
        R = block_diag(*[observation.covariance[:2, :2] for observation in observations])
        left = 1.0  # of the information
        while left > 0:
            L = np.linalg.cholesky(self._P)
            mean, covariance, slopes = _transformed(L, lambda xi: _seen(self._moved(xi), indices))
            nonlinear = eigh(covariance - slopes @ slopes.T, R, eigvals_only=True)[-1]
            part = min(MAX_NONLINEARITY / max(nonlinear, MAX_NONLINEARITY), left)
            S = covariance + R / part
            K = np.linalg.solve(S, slopes @ L.T).T
            self._P = self._P - K @ S @ K.T
            self._x = self._moved((K @ (z - mean))[:, None])[:, 0]
            left -= part

    def add(self, observation) -> int:
        """As sextant.LandmarkFilter.add()."""
        R, place = rotation(self._x[2]), self._x[:2] + rotation(self._x[2]) @ observation.position
        G = np.hstack([np.eye(2), self._arm(place)])
        cross = G @ self._P[:3]
        added = cross[:, :3] @ G.T + R @ observation.covariance[:2, :2] @ R.T
        self._P = np.block([[self._P, cross.T], [cross, added]])
        self._x = np.concatenate([self._x, place])
        return len(self._x) // 2 - 2

    def _moved(self, xi: np.ndarray) -> np.ndarray:
        return self._x[:, None] + xi

    def _arm(self, place: np.ndarray) -> np.ndarray:
        """(2, 1) error of a new landmark here by that of the heading."""
        dx, dy = place - self._x[:2]
        return np.array([[-dy], [dx]])

    def _noise_input(self) -> np.ndarray:
        G = np.zeros((len(self._x), 3))
        G[:2, :2], G[2, 2] = rotation(self._x[2]), 1
        return G

    def _propagate(self, step: np.ndarray) -> None:
        def after(xi: np.ndarray) -> np.ndarray:
            X = self._moved(xi)
            place = np.exp(1j * X[2]) * complex(*step[:2])
            X[:3] += np.array([place.real, place.imag, np.full_like(place.real, step[2])])
            return X

        self._x, self._P, _ = _transformed(np.linalg.cholesky(self._P), after)


class InvariantTextbookFilter(TextbookFilter):
    """With the error of sextant.LandmarkFilter: X = exp(xi) X^ in SE_{1+n}(2)."""

    @property
    def covariance(self) -> np.ndarray:
        """(n, n) of x, y, heading and all landmarks, map's axes."""
        T = np.eye(len(self._x))
        T[:, 2] += self._heading_jacobian()
        return T @ self._P @ T.T

    def _heading_jacobian(self) -> np.ndarray:
        jacobian = np.zeros(len(self._x))
        for at in [0, *range(3, len(jacobian), 2)]:
            jacobian[at : at + 2] = -self._x[at + 1], self._x[at]
        return jacobian

    def _moved(self, xi: np.ndarray) -> np.ndarray:
        X, half = self._x[:, None] + xi, 0.5 * xi[2]
        J = np.exp(1j * half) * np.sinc(half / np.pi)  # of the group: (exp(i a) - 1) / (i a)
        for at in [0, *range(3, len(X), 2)]:
            place = np.exp(2j * half) * complex(*self._x[at : at + 2]) + J * (xi[at] + 1j * xi[at + 1])
            X[at], X[at + 1] = place.real, place.imag
        return X

    def _arm(self, place: np.ndarray) -> np.ndarray:
        return np.zeros((2, 1))

    def _noise_input(self) -> np.ndarray:
        G = super()._noise_input()
        G[:, 2] -= self._heading_jacobian()
        return G

    def _propagate(self, step: np.ndarray) -> None:
        self._x[:3] += [*rotation(self._x[2]) @ step[:2], step[2]]  # xi stays as it is


def _seen(X: np.ndarray, landmarks: List[int]) -> np.ndarray:
    """(2 k, columns) x, y of landmarks in the robot frame."""
    rows = 3 + 2 * np.array(landmarks)
    seen = np.exp(-1j * X[2]) * (X[rows] - X[0] + 1j * (X[rows + 1] - X[1]))
    return np.stack([seen.real, seen.imag], axis=1).reshape(-1, X.shape[1])


def _transformed(
    L: np.ndarray, function: Callable[[np.ndarray], np.ndarray]
) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean, covariance and slopes along the columns of L; differences to the centre, against rounding."""
    weight, spread = 0.5 / SCALED, np.sqrt(SCALED)
    centre = function(np.zeros((len(L), 1)))
    above, below = function(spread * L) - centre, function(-spread * L) - centre
    shift = weight * (above + below).sum(axis=1, keepdims=True)
    above, below = above - shift, below - shift
    covariance = weight * (above @ above.T + below @ below.T) + (CENTRE - len(L) / SCALED) * shift @ shift.T
    return (centre + shift)[:, 0], covariance, weight * spread * (above - below)
