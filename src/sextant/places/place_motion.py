# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Motion among the places of a map between two images: along its photos at a velocity, or free.

A robot often drives as the robot that took the photos, in the same direction or back, and its velocity
changes rarely. Each velocity is a layer of the belief, and one more layer is free motion to neighbouring
places. Images that are predicted well by a layer raise its probability.
"""

from typing import Dict, List, Optional

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.spatial import cKDTree

from sextant.places.place_spacing import spacing_of

VELOCITIES = np.arange(-9, 10) / 3  # spacings per image along the photos
LAYERS = len(VELOCITIES) + 1  # the last one: free motion
USUAL_SPEED = 2.0  # spacings per image: a speed v has the prior exp(-v / USUAL_SPEED), not normalized
FREE_PRIOR = 0.12  # prior probability of free motion
STEP_SIGMA = 0.35  # standard deviation of a step along the photos, spacings
SHARE_SIGMA = 0.15  # added to it, as a fraction of the step
POSITION_SIGMA = 0.5  # spacings; with odometry: the robot may be anywhere around its place
FARTHEST = 3.0  # standard deviations
DISTANCE_STEP = 0.1  # spacings; distances are rounded to it, so that transition matrices can be cached
MAX_CACHED = 64  # maximum number of distances with cached transition matrices
MAX_ENTRIES = 16_000_000  # nonzero entries of all cached transition matrices: about 200 MB
LEAST = 1e-9  # added to each weight: no transition to a neighbour is impossible


class PlaceMotion:
    """Transitions between the places of a map, for each layer."""

    def __init__(self, positions: np.ndarray, reach: float, persistence: float, distance_noise: float):
        """:param positions: (n, 2) of the places in the order of the photos, in the unit of the distances

        :param reach: two standard deviations of a free step without odometry, spacings
        :param persistence: probability that the layer is kept; else a new one is drawn from layer_prior()
        :param distance_noise: standard deviation of a measured distance, as a fraction of it
        """
        self._tree, self.spacing = cKDTree(positions), spacing_of(positions)
        steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        self._arcs = np.concatenate([[0.0], np.cumsum(steps)])[: len(positions), np.newaxis]  # (n, 1)
        self._along = cKDTree(self._arcs)
        self._reach, self._noise = reach, distance_noise
        self._layers = persistence * np.eye(LAYERS) + (1 - persistence) * layer_prior()[:, np.newaxis]
        self._cached: Dict[Optional[int], List[Optional[csr_matrix]]] = {}

    def predict(self, layers: np.ndarray, distance: Optional[float]) -> np.ndarray:
        """Probabilities (LAYERS, n) at the next image; their sum remains the same.

        :param layers: (LAYERS, n) probabilities of places, for each layer
        :param distance: driven since the last image, by odometry; None if unknown
        """
        changed = self._layers @ layers
        count = layers.shape[1]
        moved = np.stack([
            np.full(count, each.sum() / count) if matrix is None else matrix.T @ each
            for matrix, each in zip(self._transitions(distance), changed)
        ])  # fmt: skip
        return moved * (layers.sum() / max(moved.sum(), np.finfo(float).tiny))

    def _transitions(self, distance: Optional[float]) -> List[Optional[csr_matrix]]:
        """Transition matrices (n, n) by layer: row i has the probabilities from place i; None: uniform."""
        step = None if distance is None else round(distance / (DISTANCE_STEP * self.spacing))
        if step not in self._cached:
            rounded = None if step is None else step * DISTANCE_STEP * self.spacing
            made = self._new_transitions(rounded)
            entries = sum(map(_entries, [made, *self._cached.values()]))
            if len(self._cached) >= MAX_CACHED or entries > MAX_ENTRIES:
                self._cached.clear()
            self._cached[step] = made if _entries(made) <= MAX_ENTRIES else [None] * LAYERS
        return self._cached[step]

    def _new_transitions(self, distance: Optional[float]) -> List[Optional[csr_matrix]]:
        if distance is None:
            sigmas = [self.spacing * (STEP_SIGMA + SHARE_SIGMA * abs(velocity)) for velocity in VELOCITIES]
            along = [self._step_along(v * self.spacing, sigma) for v, sigma in zip(VELOCITIES, sigmas)]
        else:
            ways = {sign: self._step_along(sign * distance, self._sigma(distance)) for sign in (-1.0, 1.0)}
            is_known = all(each is not None for each in ways.values())
            both = 0.5 * (ways[-1.0] + ways[1.0]) if is_known else None
            along = [ways[np.sign(velocity)] if velocity else both for velocity in VELOCITIES]
        return [*along, self._free(distance)]

    def _step_along(self, step: float, sigma: float) -> Optional[csr_matrix]:
        """By the difference of two arc lengths."""
        pairs = _pairs(self._along, abs(step) + FARTHEST * sigma)
        if pairs is None:
            return None
        return self._weighted(pairs, self._arcs[pairs.col, 0] - self._arcs[pairs.row, 0] - step, sigma)

    def _free(self, distance: Optional[float]) -> Optional[csr_matrix]:
        """By the distance of two places."""
        step, sigma = distance or 0.0, self.spacing * self._reach / 2
        if distance is not None:
            sigma = self._sigma(distance)
        pairs = _pairs(self._tree, step + FARTHEST * sigma)
        return None if pairs is None else self._weighted(pairs, pairs.data - step, sigma)

    def _sigma(self, distance: float) -> float:
        """Standard deviation of a step that odometry measured."""
        return float(np.hypot(POSITION_SIGMA * self.spacing, self._noise * distance))

    def _weighted(self, pairs: coo_matrix, errors: np.ndarray, sigma: float) -> csr_matrix:
        """Gaussian weights of the errors. Each row sums to 1, or to less if the step leads off the map."""
        weights = np.exp(-0.5 * (errors / sigma) ** 2) + LEAST
        matrix = csr_matrix((weights, (pairs.row, pairs.col)), pairs.shape)
        least = np.full(pairs.shape[0], np.inf)
        np.minimum.at(least, pairs.row, np.abs(errors))
        beyond = np.maximum(least - self.spacing / 2, 0.0)  # no place is nearer than that
        sums = (np.exp(-0.5 * (beyond / sigma) ** 2) + LEAST) / np.asarray(matrix.sum(axis=1))[:, 0]
        return matrix.multiply(sums[:, np.newaxis]).tocsr()


def layer_prior() -> np.ndarray:
    """Prior probabilities (LAYERS,) of the layers."""
    along = np.exp(-np.abs(VELOCITIES) / USUAL_SPEED)
    return np.append((1 - FREE_PRIOR) * along / along.sum(), FREE_PRIOR)


def _entries(matrices: List[Optional[csr_matrix]]) -> int:
    """Nonzero entries of matrices, each counted once."""
    return sum({id(each): each.nnz for each in matrices if each is not None}.values())


def _pairs(tree: cKDTree, farthest: float) -> Optional[coo_matrix]:
    """Distances between places and those up to `farthest` away, and themselves; None: too many."""
    if tree.count_neighbors(tree, farthest) > MAX_ENTRIES:  # odometry jumped on a large map
        return None
    pairs = tree.sparse_distance_matrix(tree, farthest, output_type="coo_matrix")
    others, every = pairs.row != pairs.col, np.arange(tree.n)
    rows, columns = np.concatenate([pairs.row[others], every]), np.concatenate([pairs.col[others], every])
    return coo_matrix((np.concatenate([pairs.data[others], np.zeros(tree.n)]), (rows, columns)))
