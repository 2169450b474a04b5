# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Discrete Bayes filter over the places of a map and an unknown place outside of it.

The prediction spreads the belief to neighbouring places, or to those at the distance that odometry measured.
A small part of the belief is distributed over all places, to recover from kidnapping (Thrun, Burgard, Fox:
Probabilistic Robotics, 2005, chapters 4.1 and 8.3).
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from sextant.base.strict_params import ParamError, StrictParams, param, within
from sextant.places.place_spacing import neighbour_radius, spacing_of

DISTANCE_STEP = 0.1  # spacings; distances are rounded to it, so that transition matrices can be cached
MAX_CACHED = 64  # maximum number of cached transition matrices
MAX_ENTRIES = 16_000_000  # nonzero entries of one transition matrix, and of all cached ones: about 200 MB


@dataclass(frozen=True)
class BeliefParams(StrictParams):
    """Motion model and weight of the evidence.

    The spacing is the median distance between neighbouring places.
    """

    reach: float = param(
        4.0,
        "two standard deviations of the distance travelled between two images without odometry, in "
        "spacings of places",
        within(1, 20),
    )
    kidnap_probability: float = param(
        0.01,
        "probability of being at a random place at the next image: kidnapped, or back in the map",
        within(0, 1),
    )
    exit_probability: float = param(
        0.01,
        "probability of leaving the map between two images; the sum with `kidnap_probability` is at "
        "most 1",
        within(0, 1),
    )
    unknown_prior: float = param(
        0.5,
        "prior probability of an unknown place; 0: the robot is always in the map, and "
        "exit_probability must be 0",
        within(0, 1),
    )
    evidence_exponent: float = param(
        0.6,
        "exponent of the likelihood ratios; below 1, because errors of successive images are " "correlated",
        within(1e-6, 1),
    )
    evidence_penalty: float = param(
        2.0,
        "subtracted from the log likelihood ratios, because a wrong place may match over many images",
        within(0, 20),
    )
    distance_noise: float = param(
        0.1,
        "standard deviation of the distance that odometry measured, as a fraction of that distance",
        within(0.001, 1),
    )
    radius: float = param(
        2.2,
        "distance within which places are merged into one hypothesis, spacings; at most a tenth of the map's "
        "extent",
        within(0, 20),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.exit_probability and not self.unknown_prior:
            raise ParamError("exit_probability", "must be 0 where unknown_prior is 0", self.exit_probability)
        if self.kidnap_probability + self.exit_probability > 1:
            total = self.kidnap_probability + self.exit_probability
            raise ParamError("kidnap_probability + exit_probability", "must be at most 1", total)


class BeliefPeak(NamedTuple):
    """A local maximum of the belief."""

    place: int  # index
    probability: float  # of the place and those merged with it
    around: np.ndarray  # int (m,) indices of the merged places, including the place itself


class PlaceBelief:
    """Probabilities of all places and of an unknown place; they sum to 1."""

    places: np.ndarray  # (n,) probabilities
    unknown: float  # probability of a place that is not in the map
    spacing: float  # spacing_of() the positions, in their unit

    def __init__(self, positions: np.ndarray, params: Optional[BeliefParams] = None):
        """:param positions: (n, 2) of the places, in the unit of the distances passed to predict()"""
        self._params = params or BeliefParams()
        self._positions = np.asarray(positions, float).reshape(-1, 2)
        self._tree = cKDTree(self._positions)
        self.spacing = spacing_of(self._positions)
        self._radius = neighbour_radius(self._positions, self._params.radius)
        self._transitions = {}
        self.reset()

    def reset(self) -> None:
        """Sets the prior: all places are equally probable."""
        count = len(self._positions)
        self.unknown = self._params.unknown_prior
        self.places = np.full(count, (1 - self.unknown) / count)

    def predict(self, distance: Optional[float] = None) -> None:
        """Predicts the belief at the next image.

        :param distance: driven since the last image, by odometry; None if unknown
        """
        params, count = self._params, len(self._positions)
        matrix = self._transition(distance)
        moved = np.full(count, self.places.sum() / count) if matrix is None else matrix.T @ self.places
        stay = 1 - params.kidnap_probability - params.exit_probability
        kidnapped = params.kidnap_probability / count
        self.places = stay * moved + kidnapped * (self.places.sum() + self.unknown)
        self.unknown = max(1 - self.places.sum(), 0.0) if params.unknown_prior else 0.0

    def update(self, log_ratios: np.ndarray, is_absolute: bool = True) -> None:
        """Updates the belief with the evidence of an image.

        :param log_ratios: (n,) log likelihood ratio of each place against an unknown place
        :param is_absolute: False: the ratios only compare places with each other, so there is no penalty
        """
        penalty = self._params.evidence_penalty if is_absolute else 0.0
        evidence = self._params.evidence_exponent * (np.asarray(log_ratios, float) - penalty)
        with np.errstate(divide="ignore"):  # log(0): a probability of 0 stays 0
            logs = np.log(np.append(self.places, self.unknown)) + np.append(evidence, 0.0)
        weights = np.exp(logs - logs.max())  # the maximum is finite, so the sum is never 0
        weights /= weights.sum()
        self.places, self.unknown = weights[:-1], float(weights[-1])

    def peaks(self, count: int) -> List[BeliefPeak]:
        """Returns up to count maxima, most probable first, each merged with the places within `radius` of it.

        A place belongs to one peak only: the most probable remaining place takes all remaining places within
        the radius.
        """
        remaining = self.places.copy()
        peaks = []
        for _ in range(min(count, len(remaining))):
            place = int(remaining.argmax())
            if remaining[place] <= 0:
                break
            near = self._tree.query_ball_point(self._positions[place], self._radius)
            around = np.array([neighbour for neighbour in sorted(near) if remaining[neighbour] > 0], int)
            peaks.append(BeliefPeak(place, float(remaining[around].sum()), around))
            remaining[around] = 0
        return sorted(peaks, key=lambda peak: -peak.probability)

    def _transition(self, distance: Optional[float]) -> Optional[csr_matrix]:
        """Transition matrix (n, n): row i has the probabilities of moving from place i; None: uniform."""
        step = None if distance is None else round(distance / (DISTANCE_STEP * self.spacing))
        if step not in self._transitions:
            matrix = self._new_transition(None if step is None else step * DISTANCE_STEP * self.spacing)
            entries = sum(each.nnz for each in (matrix, *self._transitions.values()) if each is not None)
            if len(self._transitions) >= MAX_CACHED or entries > MAX_ENTRIES:
                self._transitions.clear()
            self._transitions[step] = matrix
        return self._transitions[step]

    def _new_transition(self, distance: Optional[float]) -> Optional[csr_matrix]:
        """Normalized Gaussian of the difference between the distance of two places and the distance
        driven."""
        sigma, centre = self.spacing * self._params.reach / 2, 0.0
        if distance is not None:
            # half a spacing: the robot may be anywhere around its place
            sigma, centre = np.hypot(self.spacing / 2, self._params.distance_noise * distance), distance
        count, farthest = len(self._positions), centre + 3 * sigma
        if self._tree.count_neighbors(self._tree, farthest) > MAX_ENTRIES:  # odometry jumped on a large map
            return None
        pairs = self._tree.sparse_distance_matrix(self._tree, farthest, output_type="coo_matrix")
        others = pairs.row != pairs.col
        rows = np.concatenate([pairs.row[others], np.arange(count)])
        columns = np.concatenate([pairs.col[others], np.arange(count)])
        distances = np.concatenate([pairs.data[others], np.zeros(count)])
        weights = np.exp(-0.5 * ((distances - centre) / sigma) ** 2) + 1e-9
        matrix = csr_matrix((weights, (rows, columns)), (count, count))
        return matrix.multiply(1 / matrix.sum(axis=1)).tocsr()
