# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which quantity predicts a right answer: areas that are known beforehand."""

import numpy as np
import pytest
from made_evaluations import evaluation_of, half_right, result_of
from scipy.stats import norm

from sextant.place_reports.place_predictors import Predictor, predictors, roc_area


def by_name(evaluation):
    return {each.name: each for each in predictors(evaluation)}


@pytest.mark.parametrize(
    "right, wrong, area",
    [
        ([3, 4], [1, 2], 1.0),
        ([1, 2], [3, 4], 0.0),
        ([5, 5], [5], 0.5),
        ([1, 3], [2], 0.5),
        ([2, 3], [2], 0.75),
    ],
)
def test_the_area_counts_pairs(right, wrong, area):
    assert roc_area(np.array(right), np.array(wrong)) == area


def test_the_area_of_two_normal_distributions():
    """Phi(difference of the means / sqrt(2)), Green and Swets 1966."""
    rng = np.random.default_rng(1)
    area = roc_area(rng.normal(0.8, 1, 20_000), rng.normal(0, 1, 20_000))
    assert area == pytest.approx(norm.cdf(0.8 / np.sqrt(2)), abs=0.006)


@pytest.mark.parametrize("right, wrong", [([], [1.0]), ([1.0], []), ([], [])])
def test_without_both_kinds_of_answers_nothing_is_known(right, wrong):
    predictor = Predictor("x", np.array(right), np.array(wrong))
    assert np.isnan(predictor.area) and predictor.direction == 0 and predictor.chance == (0, 1)


def test_chance_alone_is_inside_its_interval_19_times_in_20():
    rng = np.random.default_rng(2)
    drawn = [Predictor("x", rng.random(14), rng.random(9)) for _ in range(2000)]
    inside = np.mean([each.direction == 0 for each in drawn])
    assert 0.935 < inside < 0.965


def test_low_distances_predict_a_right_answer_and_the_number_of_keypoints_does_not():
    found = by_name(half_right())
    for name in ("min_distance", "mean_distance", "max_distance"):
        assert found[name].area < 0.2 and found[name].direction == -1
    for name in ("keypoints", "matches", "probability", "margin"):
        assert found[name].direction == 0
    assert found["probability"].area == 0.5  # the same for all


def test_only_answers_count_and_one_of_an_unmapped_place_is_wrong():
    found = by_name(
        evaluation_of(
            result_of([1], [(1, 0.9), (2, 0.05)], matches=7),
            result_of([], [(1, 0.4), (3, 0.3)], matches=2),
            result_of([1], []),
        )
    )
    assert (found["probability"].right.tolist(), found["probability"].wrong.tolist()) == ([0.9], [0.4])
    assert found["margin"].right == pytest.approx([0.85]) and found["margin"].wrong == pytest.approx([0.1])
    assert (found["photo_matches"].right, found["photo_matches"].wrong) == ([7], [2])
