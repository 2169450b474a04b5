# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Quantities of a localized image, and how well each of them predicts that the best hypothesis is correct."""

from typing import Callable, Dict, List, NamedTuple, Tuple

import numpy as np
from scipy.stats import rankdata

from sextant.places.place_evaluation import PlaceEvaluation
from sextant.places.place_localizer import Localization

NORMAL_95 = 1.96  # standard deviations; 95 % of a normal distribution are within


def _probability(found: Localization, number: int) -> float:
    """Probability of a hypothesis; 0 if there are fewer."""
    return found.hypotheses[number].probability if len(found.hypotheses) > number else 0.0


# by name, also that of the column in a table; distances are those of descriptors
QUANTITIES: Dict[str, Callable[[Localization], float]] = {
    "keypoints": lambda found: found.statistics.keypoints,  # in the image
    "matches": lambda found: found.statistics.matches,  # keypoints with a nearest neighbour in the map
    "kept_matches": lambda found: found.statistics.kept,  # their distance is at most the mean
    "photo_matches": lambda found: len(found.match.weights),  # with the best photo
    "min_distance": lambda found: found.statistics.minimum,
    "mean_distance": lambda found: found.statistics.mean,
    "max_distance": lambda found: found.statistics.maximum,
    "total_distance": lambda found: found.statistics.total,
    "probability": lambda found: _probability(found, 0),  # of the best hypothesis
    "margin": lambda found: _probability(found, 0) - _probability(found, 1),  # over the second hypothesis
    "unknown_probability": lambda found: found.unknown_probability,
}


class Predictor(NamedTuple):
    """A quantity of correct and wrong answers."""

    name: str  # key of QUANTITIES
    right: np.ndarray  # (n,) values of the images whose best hypothesis is correct
    wrong: np.ndarray  # (m,) values of the images whose best hypothesis is wrong

    @property
    def area(self) -> float:
        """Area under the ROC curve, see roc_area(): below 0.5, low values predict a correct answer."""
        return roc_area(self.right, self.wrong)

    @property
    def chance(self) -> Tuple[float, float]:
        """95 % interval of the area if the quantity predicts nothing; (0, 1) if there are too few answers.

        Normal approximation of the distribution of Mann and Whitney's U (1947).
        """
        n, m = len(self.right), len(self.wrong)
        half = NORMAL_95 * np.sqrt((n + m + 1) / (12 * n * m)) if n and m else 0.5
        return max(0.0, 0.5 - half), min(1.0, 0.5 + half)

    @property
    def direction(self) -> int:
        """1: high values predict a correct answer; -1: low values do; 0: the quantity predicts nothing."""
        low, high = self.chance
        return int(self.area > high) - int(self.area < low)


def roc_area(right: np.ndarray, wrong: np.ndarray) -> float:
    """Area under the ROC curve: probability that a right answer has a higher value than a wrong one.

    Ties count one half. nan if there is no right or no wrong answer.
    """
    n, m = len(right), len(wrong)
    if not n or not m:
        return np.nan
    ranks = rankdata(np.concatenate([right, wrong]))  # mean ranks of ties
    return float((ranks[:n].sum() - n * (n + 1) / 2) / (n * m))


def predictors(evaluation: PlaceEvaluation) -> List[Predictor]:
    """The quantities of all images with a hypothesis.

    Every hypothesis for an image that is not in the map is wrong.
    """
    answered = [each for each in evaluation.results if each.found.hypotheses]
    right = np.array([each.rank == 1 for each in answered], bool)
    result = []
    for name, quantity in QUANTITIES.items():
        values = np.array([quantity(each.found) for each in answered], float)
        result.append(Predictor(name, values[right], values[~right]))
    return result
