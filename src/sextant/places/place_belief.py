# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Discrete Bayes filter over the places of a map and an unknown place outside of it.

The prediction moves the belief along the photos or to neighbouring places, see place_motion.
A small part of the belief is distributed over all places, to recover from kidnapping (Thrun, Burgard, Fox:
Probabilistic Robotics, 2005, chapters 4.1 and 8.3).
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional

import numpy as np
from scipy.spatial import cKDTree

from sextant.base.strict_params import ParamError, StrictParams, param, within
from sextant.places.place_motion import PlaceMotion, layer_prior
from sextant.places.place_spacing import neighbour_radius

RETURN = 0.5  # of the belief that returns to the map: the share that goes on along the photos


@dataclass(frozen=True)
class BeliefParams(StrictParams):
    """Motion model and weight of the evidence.

    The spacing is the median distance between neighbouring places.
    """

    reach: float = param(
        4.0,
        "two standard deviations of the distance travelled between two images without odometry, other than "
        "along the photos, in spacings of places",
        within(1, 20),
    )
    persistence: float = param(
        0.95,
        "probability that the robot keeps its velocity along the photos of the map until the next image",
        within(0, 1),
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
        "exponent of the likelihood ratios; below 1, because errors of successive images are correlated",
        within(1e-6, 1),
    )
    evidence_penalty: float = param(
        0.0,
        "subtracted from the log likelihood ratios, because a wrong place may match over many images",
        within(0, 20),
    )
    confidence: float = param(
        0.5,
        "exponent of the odds of the best hypothesis when it is published; below 1, because errors of "
        "successive images are correlated",
        within(1e-6, 1),
    )
    distance_noise: float = param(
        0.1,
        "standard deviation of the distance that odometry measured, as a fraction of that distance",
        within(0.001, 1),
    )
    radius: float = param(
        2.2,
        "distance within which places are merged into one hypothesis, spacings; at most a quarter of the "
        "map's extent",
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


class Hypotheses(NamedTuple):
    """Places and their probabilities, as published."""

    peaks: List[BeliefPeak]  # most probable first
    unknown: float  # probability of a place that is not in the map


class PlaceBelief:
    """Probabilities of all places and of an unknown place; they sum to 1."""

    unknown: float  # probability of a place that is not in the map
    spacing: float  # spacing_of() the positions, in their unit

    def __init__(self, positions: np.ndarray, params: Optional[BeliefParams] = None):
        """:param positions: (n, 2) of the places, in the unit of the distances passed to predict()"""
        self._params = params or BeliefParams()
        self._positions = np.asarray(positions, float).reshape(-1, 2)
        self._tree = cKDTree(self._positions)
        motion = self._params.reach, self._params.persistence, self._params.distance_noise
        self._motion = PlaceMotion(self._positions, *motion)
        self.spacing, self._prior = self._motion.spacing, layer_prior()[:, np.newaxis]
        self._radius = neighbour_radius(self._positions, self._params.radius)
        self.reset()

    def reset(self) -> None:
        """Sets the prior: all places are equally probable."""
        count = len(self._positions)
        self.unknown = self._params.unknown_prior
        self._layers = np.repeat(self._prior * (1 - self.unknown) / count, count, axis=1)

    def predict(self, distance: Optional[float] = None) -> None:
        """Predicts the belief at the next image.

        :param distance: driven since the last image, by odometry; None if unknown
        """
        params = self._params
        moved, inside = self._motion.predict(self._layers, distance), self._layers.sum()
        anywhere = self._prior / moved.shape[1]
        ahead = moved / moved.sum() if moved.sum() else anywhere
        back = RETURN * ahead + (1 - RETURN) * anywhere
        entered = params.kidnap_probability * (inside * anywhere + self.unknown * back)
        stay = 1 - params.kidnap_probability - params.exit_probability
        self._layers = stay * moved + entered
        self.unknown = max(1 - self._layers.sum(), 0.0) if params.unknown_prior else 0.0

    def restrict(self, log_weights: np.ndarray) -> None:
        """Multiplies the places' probabilities by weights; that of an unknown place does not change.

        :param log_weights: (n,) finite
        """
        layers = self._layers * np.exp(log_weights - np.max(log_weights))
        if layers.sum() > 0:
            self._layers = layers * ((1 - self.unknown) / layers.sum())

    def update(self, log_ratios: np.ndarray, is_absolute: bool = True) -> None:
        """Updates the belief with the evidence of an image.

        :param log_ratios: (n,) log likelihood ratio of each place against an unknown place
        :param is_absolute: False: the ratios only compare places with each other, so there is no penalty
        """
        penalty = self._params.evidence_penalty if is_absolute else 0.0
        evidence = self._params.evidence_exponent * (np.asarray(log_ratios, float) - penalty)
        with np.errstate(divide="ignore"):  # log(0): a probability of 0 stays 0
            logs = np.log(self._layers) + evidence
            unknown = np.log(self.unknown)
        highest = max(logs.max(), unknown)  # finite, so the sum is never 0
        weights, unknown = np.exp(logs - highest), np.exp(unknown - highest)
        total = weights.sum() + unknown
        self._layers, self.unknown = weights / total, float(unknown / total)

    @property
    def places(self) -> np.ndarray:
        """Probabilities (n,) of the places."""
        return self._layers.sum(axis=0)

    def hypotheses(self, count: int) -> Hypotheses:
        """Up to count places, most probable first, with probabilities to be published.

        The odds of the most probable one, which may be the unknown place, are raised to `confidence` if they
        are above 1. The others share the rest.
        """
        peaks = self._peaks(count)
        probabilities = np.array([*(peak.probability for peak in peaks), self.unknown])
        best = int(probabilities.argmax())
        highest = probabilities[best]
        lower = _tempered(highest, self._params.confidence)
        if highest < 1:
            probabilities *= (1 - lower) / (1 - highest)
        probabilities[best] = lower
        published = [peak._replace(probability=float(p)) for peak, p in zip(peaks, probabilities)]
        published.sort(key=lambda peak: -peak.probability)
        return Hypotheses(published, float(probabilities[-1]))

    def _peaks(self, count: int) -> List[BeliefPeak]:
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


def _tempered(probability: float, exponent: float) -> float:
    """The probability whose odds are raised to the exponent; not for one below 0.5."""
    if not 0.5 < probability < 1:
        return probability
    odds = (probability / (1 - probability)) ** exponent
    return odds / (1 + odds)
