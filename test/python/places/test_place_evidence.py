# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scores as deviations and as likelihood ratios, against normal distributions and by hand."""

import numpy as np
import pytest
from scipy.stats import norm

from sextant.places.place_evidence import (
    UNRELATED,
    EvidenceParams,
    UnknownPlaces,
    absolute_log_ratios,
    deviations,
    relative_log_ratios,
    score_differences,
)


def test_deviations_of_normal_noise_are_its_standard_deviations():
    noise = np.random.default_rng(1).normal(5.0, 0.1, 99)
    expected = (noise - np.median(noise)) / 0.1
    assert deviations(noise) == pytest.approx(expected, rel=0.3)


def test_scale_and_origin_do_not_matter():
    scores = np.random.default_rng(2).exponential(size=200)
    assert deviations(7 + 3 * scores) == pytest.approx(deviations(scores))


@pytest.mark.parametrize("scores", [np.zeros(5), np.full(4, 0.7), np.array([3.0])])
def test_the_same_of_all_gives_no_evidence(scores):
    assert not deviations(scores).any()


def test_rounding_gives_no_evidence():
    scores = np.full(50, 0.9, np.float32) + np.random.default_rng(3).choice([0, 6e-8], 50)
    assert np.abs(deviations(np.append(scores, 0.1))).max() < 1  # and does not blow up what differs


def test_a_right_photo_stands_out_as_much_of_a_thousandfold_map():
    rng = np.random.default_rng(4)
    found = [deviations(np.append(rng.exponential(size=n), 15.0))[-1] for n in (100, 100_000)]
    assert found[0] > 10 and found[1] > 4


def test_votes_for_few_of_many_photos_are_compared_with_one_another():
    votes = np.zeros(10_000)
    votes[:60] = 1.0 + np.random.default_rng(4).uniform(-0.5, 0.5, 60)
    votes[7] = 40.0
    found = deviations(votes)
    assert found.argmax() == 7 and found[7] > 20
    assert np.delete(found, 7).max() < 3


# five photos, of which the first and the last are compared; photos 1 and 2 are near each other
SCORES = np.array([[np.nan, 2.0, 4.0, 3.0, 1.0], [1.0, 9.0, 8.0, 3.0, np.nan]])
NEAR = np.array([[1, 0, 0, 0, 0], [0, 1, 1, 0, 0], [0, 1, 1, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, 1]], bool)


def test_differences_are_to_the_best_elsewhere_and_to_the_median():
    scores, near = np.array([3.0, 9.0, 8.0, 4.0, 1.0]), np.array([0, 1, 1, 0, 0], bool)
    assert score_differences(scores, near).tolist() == [9 - 4, 9 - 4]


def test_unknown_places_are_photos_without_their_neighbours():
    scores, numbers = np.repeat(SCORES, 5, axis=0), np.repeat([0, 4], 5)
    found = UnknownPlaces.of_map(scores, numbers, lambda which: NEAR[which])
    differences = [[4 - 3, 4 - 2.5], [9 - 3, 9 - 5.5]]
    assert found.mean == pytest.approx(np.mean(differences, axis=0))
    assert found.deviation == pytest.approx(np.std(differences, axis=0))


@pytest.mark.parametrize(
    "numbers, near",
    [([0, 4], np.ones((5, 5), bool)), ([], NEAR), ([0, 4], NEAR)],
    ids=["near", "none", "few"],
)
def test_without_photos_elsewhere_there_is_no_distribution(numbers, near):
    numbers = np.array(numbers, int)
    assert UnknownPlaces.of_map(SCORES[: len(numbers)], numbers, lambda which: near[which]) is None


def test_features_grow_with_the_logarithm_of_standard_scores():
    unknown, near = UnknownPlaces((2.0, 7.0), (0.5, 1.0)), np.array([0, 1, 1, 0, 0], bool)
    found = unknown.features(np.array([3.0, 9.0, 8.0, 4.0, 1.0]), near)
    assert found == pytest.approx([np.log(1 + (5 - 2) / 0.5), -np.log(1 + (7 - 5) / 1.0)])


def test_a_map_of_one_place_is_compared_with_unrelated_photos():
    unknown = UnknownPlaces((0.0, 0.0), (1.0, 1.0))
    found = unknown.features(np.array([21.0]), np.ones(1, bool), 2)
    assert found == pytest.approx(np.log1p([21 - 2 * UNRELATED, (21 - 2 * UNRELATED) / 2]))


def test_absolute_evidence_is_the_odds_times_the_relative_likelihood():
    params = EvidenceParams(slope=0.7, margin=0.5, excess=2.0, offset=4.0, limit=12.0)
    scores, shares = np.array([0.0, 1.0, 2.0]), np.array([0.5, 0.25, 0.25])
    found = absolute_log_ratios(scores, np.array([3.0, 1.5]), shares, params)
    assert np.log(shares @ np.exp(found)) == pytest.approx(0.5 * 3 + 2 * 1.5 - 4)
    assert np.diff(found) == pytest.approx([0.7, 0.7])
    for sign in (1, -1):
        limited = absolute_log_ratios(scores, sign * np.array([1e3, 1e3]), shares, params)
        assert np.log(shares @ np.exp(limited)) == pytest.approx(12 * sign)


def equally(count):
    return np.full(count, 1 / count)


def test_relative_evidence_of_two_photos_is_that_of_two_normal_densities():
    scores, shift = np.random.default_rng(5).normal(5.0, 0.1, 99), 1.5
    ratios, z = relative_log_ratios(scores, shift, equally(99)), deviations(scores)
    right, wrong = norm.logpdf(z, shift), norm.logpdf(z)
    assert ratios - ratios[7] == pytest.approx(right - wrong - (right - wrong)[7])


@pytest.mark.parametrize("shift", [0.5, 1.0, 3.0, 100.0])
@pytest.mark.parametrize("winner", [0.0, 5.0, 1e6])
def test_relative_evidence_is_none_for_or_against_an_unknown_place(shift, winner):
    rng = np.random.default_rng(6)
    scores, shares = np.append(rng.normal(size=40), winner), rng.dirichlet(np.ones(41))
    assert shares @ np.exp(relative_log_ratios(scores, shift, shares)) == pytest.approx(1.0)


def test_the_same_of_all_is_no_relative_evidence():
    assert relative_log_ratios(np.full(9, 0.3), 1.5, equally(9)) == pytest.approx(np.zeros(9))


@pytest.mark.parametrize(
    "changed, reason", [({"limit": 0.0}, "limit: must be"), ({"slope": -1.0}, "slope: must be")]
)
def test_parameters_out_of_range_are_refused(changed, reason):
    with pytest.raises(ValueError, match=reason):
        EvidenceParams(**changed)
