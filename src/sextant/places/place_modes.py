# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Fusion of successive images: single images, a filter over all images, or a window of the last ones."""

from collections import deque
from dataclasses import replace
from typing import Callable, Deque, Dict, NamedTuple, Optional

import numpy as np

from sextant.places.place_belief import BeliefParams, PlaceBelief


class ImageEvidence(NamedTuple):
    """Evidence of one image."""

    log_ratios: Optional[np.ndarray]  # (places,) log likelihood ratios; None: the image is unusable
    distance: Optional[float]  # driven since the last image; None: unknown
    is_absolute: bool = True  # whether log_ratios also compare with an unknown place
    log_weights: Optional[np.ndarray] = None  # (places,) by a rough pose, see PlaceBelief.restrict()

    def apply(self, belief: PlaceBelief) -> None:
        """Updates a belief that is predicted for the time of the image."""
        if self.log_weights is not None:
            belief.restrict(self.log_weights)
        if self.log_ratios is not None:
            belief.update(self.log_ratios, self.is_absolute)


class Single:
    """Localizes from the last image only, with its full evidence."""

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        independent = {"evidence_exponent": 1.0, "evidence_penalty": 0.0, "confidence": 1.0}
        self.belief = PlaceBelief(positions, replace(params, **independent))

    def update(self, evidence: ImageEvidence) -> None:
        """Replaces the belief."""
        self.belief.reset()
        evidence.apply(self.belief)


class Filter:
    """Bayes filter over all images."""

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        self.belief = PlaceBelief(positions, params)
        self._is_first = True

    def update(self, evidence: ImageEvidence) -> None:
        """Predicts and updates the belief."""
        if not self._is_first:
            self.belief.predict(evidence.distance)
        evidence.apply(self.belief)
        self._is_first = False


class Sequence:
    """Bayes filter over a window of images, for a robot that is always in the map.

    Accumulates weak evidence, such as in lighting or a season that the map does not cover.
    """

    def __init__(self, positions: np.ndarray, params: BeliefParams, window: int):
        self.belief = PlaceBelief(
            positions, replace(params, unknown_prior=0.0, exit_probability=0.0, kidnap_probability=0.0)
        )
        self._window: Deque[ImageEvidence] = deque(maxlen=window)

    def update(self, evidence: ImageEvidence) -> None:
        """Recomputes the belief from all images in the window."""
        self._window.append(evidence)
        self.belief.reset()
        for number, each in enumerate(self._window):
            if number:
                self.belief.predict(each.distance)
            each.apply(self.belief)


# name: class, constructed with positions (n, 2), parameters of the belief, and number of images in the window
MODES: Dict[str, Callable[[np.ndarray, BeliefParams, int], object]] = {
    "filter": Filter,
    "sequence": Sequence,
    "single": Single,
}
